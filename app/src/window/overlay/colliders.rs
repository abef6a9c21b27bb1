//! What hair collides with, as wires over the picture.

use egui::{Align2, Color32, FontId, Pos2, Shape, Stroke, Ui};
use glam::Vec3;

use super::View;
use crate::window::theme;

/// How near to a wire a click chooses its shape, points.
const NEAR: f32 = 7.0;

/// A shape of wires.
pub(crate) struct Wires {
    /// Its place in the list of the panel.
    pub(crate) index: Option<usize>,
    /// What it is called.
    pub(crate) name: String,
    /// Ends of straight lines, world space.
    pub(crate) lines: Vec<[Vec3; 2]>,
    /// Whether hair meets it.
    pub(crate) met: bool,
}

/// Paints the shapes; the chosen one is brighter and bears its name.
pub(crate) fn paint(ui: &Ui, view: View, shapes: &[Wires], chosen: Option<usize>) {
    let painter = ui.painter_at(view.place);
    for shape in shapes {
        let is_chosen = shape.index.is_some() && shape.index == chosen;
        let stroke = Stroke::new(if is_chosen { 1.8 } else { 1.0 }, color(shape, is_chosen));
        let lines = on_screen(view, &shape.lines);
        painter.extend(lines.map(|ends| Shape::line_segment(ends, stroke)));
    }
    let Some(shape) = shapes.iter().find(|shape| chosen.is_some() && shape.index == chosen) else { return };
    let ends: Vec<Pos2> = on_screen(view, &shape.lines).flatten().collect();
    if ends.is_empty() {
        return;
    }
    let middle = ends.iter().fold(egui::Vec2::ZERO, |sum, end| sum + end.to_vec2()) / ends.len() as f32;
    let galley = painter.layout_no_wrap(shape.name.clone(), FontId::proportional(12.0), theme::ACCENT);
    let rect = Align2::CENTER_CENTER.anchor_size(middle.to_pos2(), galley.size());
    painter.rect_filled(rect.expand(3.0), 3.0, theme::PAGE.gamma_multiply(0.7));
    painter.galley(rect.min, galley, theme::ACCENT);
}

fn color(shape: &Wires, chosen: bool) -> Color32 {
    match (chosen, shape.met, shape.index) {
        (true, ..) => theme::ACCENT,
        (_, false, _) => theme::QUIET.gamma_multiply(0.45),
        (_, _, None) => theme::PLOT[2].gamma_multiply(0.7),
        _ => theme::PLOT[1].gamma_multiply(0.85),
    }
}

fn on_screen(view: View, lines: &[[Vec3; 2]]) -> impl Iterator<Item = [Pos2; 2]> + '_ {
    let shown = view.place.expand(4.0);
    lines.iter().filter_map(move |[a, b]| {
        let ends = [view.to_screen(*a)?, view.to_screen(*b)?];
        egui::Rect::from_two_pos(ends[0], ends[1]).intersects(shown).then_some(ends)
    })
}

/// The shape of the list whose wires pass nearest to a place, where any is near.
pub(crate) fn at(view: View, shapes: &[Wires], pointer: Pos2) -> Option<usize> {
    let mut nearest = (NEAR, None);
    for shape in shapes {
        for [a, b] in on_screen(view, &shape.lines) {
            let distance = distance_to_segment(pointer, a, b);
            if shape.index.is_some() && distance < nearest.0 {
                nearest = (distance, shape.index);
            }
        }
    }
    nearest.1
}

pub(crate) fn distance_to_segment(p: Pos2, a: Pos2, b: Pos2) -> f32 {
    let along = b - a;
    let t = ((p - a).dot(along) / along.length_sq().max(1e-6)).clamp(0.0, 1.0);
    (p - (a + along * t)).length()
}
