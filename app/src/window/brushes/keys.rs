//! The radius and the strength of the brush by B and the pointer.

use egui::{Key, Pos2, Ui};
use lovelock_base::settings::Settings as _;
use lovelock_brush::BrushSettings;

use super::Brushes;

/// How far the pointer moves to double the radius, points.
const DOUBLES: f32 = 90.0;
/// How far the pointer moves from no strength to all of it, points.
const WHOLE: f32 = 220.0;

/// The brush as it was when B was pressed, and where the pointer was.
#[derive(Clone, Debug)]
pub(super) struct Resize {
    pub(super) at: Pos2,
    from: BrushSettings,
}

impl Brushes {
    /// While B is held, the pointer changes the radius, and with Shift the strength. Returns where the circle stays meanwhile.
    pub(super) fn resize(&mut self, ui: &Ui) -> Option<Pos2> {
        let typing = ui.ctx().egui_wants_keyboard_input() || crate::window::key_press::are_held(ui.ctx());
        let (held, shift, pointer) = ui.input(|input| {
            let others = input.modifiers.command || input.modifiers.ctrl || input.modifiers.alt;
            (input.key_down(Key::B) && !others, input.modifiers.shift, input.pointer.latest_pos())
        });
        let Some(pointer) = pointer.filter(|_| held && !typing && self.held.is_none()) else {
            self.resize = None;
            return None;
        };
        let start = self.resize.get_or_insert_with(|| Resize { at: pointer, from: self.kept.of(self.tool) });
        let moved = pointer.x - start.at.x;
        let from = start.from.clone();
        let at = start.at;
        let changed = if shift {
            BrushSettings { strength: from.strength + moved / WHOLE, ..from }
        } else {
            BrushSettings { radius: from.radius * (moved / DOUBLES).exp2(), ..from }
        };
        self.kept.set(self.tool, changed.clamped());
        Some(at)
    }
}
