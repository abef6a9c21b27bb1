//! Which changes belong together: one drag, one number while it is typed, one turn of the wheel is one step of undo.

use egui::{Id, Pos2, Vec2};
use lovelock_project::history::GestureId;

/// Seconds between the two clicks of a double-click, at most.
const DOUBLE_CLICK_SECS: f64 = 0.3;
/// Points that the pointer may move between them.
const DOUBLE_CLICK_REACH: f32 = 6.0;

/// Numbers the gestures of the user.
#[derive(Clone, Debug)]
pub(crate) struct Gestures {
    id: GestureId,
    /// What had the keyboard in the last pass.
    focused: Option<Id>,
    /// Whether the wheel turned in the last pass.
    scrolled: bool,
    /// When and where the pointer was pressed last.
    pressed: Option<(f64, Pos2)>,
}

impl Default for Gestures {
    fn default() -> Self {
        Self { id: 1, focused: None, scrolled: false, pressed: None }
    }
}

impl Gestures {
    /// The gesture that changes belong to now.
    pub(crate) fn id(&self) -> GestureId {
        self.id
    }

    /// What comes next belongs to no gesture before it.
    pub(crate) fn next(&mut self) {
        self.id += 1;
    }

    /// Call at the start of each pass, before anything changes: goes on to the next gesture unless the one of the
    /// last pass lasts. `riding`: what was moved is still being written to its track.
    pub(crate) fn begin_pass(&mut self, ctx: &egui::Context, riding: bool) {
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
            // The second click of a double-click, which takes back what the first one did to a slider.
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
        if !lasts {
            self.next();
        }
        self.focused = focused;
        self.scrolled = scrolled;
        self.pressed = pressed.or(self.pressed);
    }
}
