//! A mark at a point in the hair.

use egui::{Align2, Color32, FontId, Stroke, Ui, vec2};
use glam::Vec3;

use super::View;
use crate::window::theme;

/// Draws a ring around a point of the world, with a label.
pub(crate) fn paint(ui: &Ui, view: View, world: Vec3, text: &str, color: Color32) {
    let Some(at) = view.to_screen(world) else { return };
    let painter = ui.painter_at(view.place);
    // A dark line below the ring keeps it visible on hair of any colour.
    painter.circle_stroke(at, 11.0, Stroke::new(4.0, theme::page().gamma_multiply(0.7)));
    painter.circle_stroke(at, 11.0, Stroke::new(2.0, color));
    painter.circle_filled(at, 2.5, color);
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(12.0), color);
    // The label is on the side with more room.
    let left = at.x > view.place.center().x;
    let (anchor, side) = if left { (Align2::RIGHT_CENTER, -18.0) } else { (Align2::LEFT_CENTER, 18.0) };
    let rect = anchor.anchor_size(at + vec2(side, 0.0), galley.size());
    painter.rect_filled(rect.expand(4.0), 4.0, theme::page().gamma_multiply(0.7));
    painter.galley(rect.min, galley, color);
}
