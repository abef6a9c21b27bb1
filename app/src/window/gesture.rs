//! Groups changes into undo steps: a drag, a number that is typed, or a turn of the wheel is one step.

use egui::{Id, Pos2, Vec2};

/// The longest time between the two clicks of a double-click, seconds.
const DOUBLE_CLICK_SECS: f64 = 0.3;
/// The largest distance that the pointer may move between them, points.
const DOUBLE_CLICK_REACH: f32 = 6.0;

/// What the user did in the last pass.
#[derive(Clone, Debug, Default)]
pub(crate) struct Gestures {
    /// The control that had the keyboard focus in the last pass.
    focused: Option<Id>,
    /// Whether the wheel turned in the last pass.
    scrolled: bool,
    /// When and where the pointer was pressed last.
    pressed: Option<(f64, Pos2)>,
}

impl Gestures {
    /// Whether the gesture of the last pass continues. Must be called at the start of each pass, before anything changes. `riding` says that
    /// a control is still being written to its track.
    pub(crate) fn continues(&mut self, ctx: &egui::Context, riding: bool) -> bool {
        let focused = ctx.memory(egui::Memory::focused);
        let (pressed, held, scrolled) = ctx.input(|input| {
            let pointer = &input.pointer;
            let pressed =
                pointer.any_pressed().then(|| (input.time, pointer.interact_pos().unwrap_or_default()));
            // The pass in which the pointer is released still belongs to its drag.
            let held = pointer.any_down() || pointer.any_released();
            (pressed, held, input.smooth_scroll_delta != Vec2::ZERO || input.zoom_delta() != 1.0)
        });
        let lasts = match (pressed, self.pressed) {
            // The second click of a double-click, which undoes the effect of the first one on a slider.
            (Some((now, at)), Some((before, there))) => {
                now - before <= DOUBLE_CLICK_SECS && at.distance(there) <= DOUBLE_CLICK_REACH
            }
            (Some(_), None) => false,
            (None, _) => {
                held || riding
                    || (scrolled && self.scrolled)
                    || (focused.is_some() && focused == self.focused)
            }
        };
        self.focused = focused;
        self.scrolled = scrolled;
        self.pressed = pressed.or(self.pressed);
        lasts
    }
}
