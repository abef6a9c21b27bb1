//! The colliders as wireframes over the image.

use egui::{Align2, Color32, FontId, Pos2, Shape, Stroke, Ui};
use glam::Vec3;
use lovelock_base::settings::Settings;
use lovelock_motion::{ColliderEdit, ColliderShape, PlacedCollider};

use super::{View, dot, dragged_to, handle};
use crate::window::theme;

/// Distance from a line within which a click selects its shape, points.
const NEAR: f32 = 7.0;

/// Remaining opacity of a line on the far side of its shape.
const FAR_SIDE: f32 = 0.2;

/// The wireframe of a shape.
pub(crate) struct Wires {
    /// Its index in the list of the panel.
    pub(crate) index: Option<usize>,
    /// Its name.
    pub(crate) name: String,
    /// Ends of straight lines, world space.
    pub(crate) lines: Vec<[Vec3; 2]>,
    /// Whether hair collides with it.
    pub(crate) met: bool,
}

/// Paints the shapes. The selected one is brighter and labelled.
pub(crate) fn paint(ui: &Ui, view: View, shapes: &[Wires], chosen: Option<usize>) {
    let painter = ui.painter_at(view.place);
    for shape in shapes {
        let is_chosen = shape.index.is_some() && shape.index == chosen;
        let (width, color) = (if is_chosen { 1.8 } else { 1.0 }, color(shape, is_chosen));
        let range = distances(view, &shape.lines);
        let lines = shape.lines.iter().filter_map(|line| {
            let ends = ends_on_screen(view, line)?;
            let color = color.gamma_multiply(nearness(view, line, range));
            Some(Shape::line_segment(ends, Stroke::new(width, color)))
        });
        painter.extend(lines);
    }
    let Some(shape) = shapes.iter().find(|shape| chosen.is_some() && shape.index == chosen) else { return };
    let ends: Vec<Pos2> = on_screen(view, &shape.lines).flatten().collect();
    if ends.is_empty() {
        return;
    }
    let middle = ends.iter().fold(egui::Vec2::ZERO, |sum, end| sum + end.to_vec2()) / ends.len() as f32;
    let galley = painter.layout_no_wrap(shape.name.clone(), FontId::proportional(12.0), theme::accent());
    // Below the handle of the middle.
    let under = middle.to_pos2() + egui::vec2(0.0, 18.0);
    let rect = Align2::CENTER_CENTER.anchor_size(under, galley.size());
    painter.rect_filled(rect.expand(3.0), 3.0, theme::page().gamma_multiply(0.7));
    painter.galley(rect.min, galley, theme::accent());
}

fn color(shape: &Wires, chosen: bool) -> Color32 {
    match (chosen, shape.met, shape.index) {
        (true, ..) => theme::accent(),
        (_, false, _) => theme::quiet().gamma_multiply(0.45),
        (_, _, None) => theme::PLOT[2].gamma_multiply(0.7),
        _ => theme::PLOT[1].gamma_multiply(0.85),
    }
}

/// Distances of the nearest and the farthest line of a shape from the camera, metres.
fn distances(view: View, lines: &[[Vec3; 2]]) -> [f32; 2] {
    let distances = lines.iter().map(|[a, _]| a.distance(view.eye));
    distances.fold([f32::INFINITY, 0.0], |[low, high], d| [low.min(d), high.max(d)])
}

/// Opacity of a line: the far side of a shape is visible through its near side.
fn nearness(view: View, [a, b]: &[Vec3; 2], [low, high]: [f32; 2]) -> f32 {
    let far = ((a.midpoint(*b).distance(view.eye) - low) / (high - low).max(1e-4)).clamp(0.0, 1.0);
    let behind = ((far - 0.3) / 0.35).clamp(0.0, 1.0);
    1.0 - (1.0 - FAR_SIDE) * behind * behind * (3.0 - 2.0 * behind)
}

fn ends_on_screen(view: View, [a, b]: &[Vec3; 2]) -> Option<[Pos2; 2]> {
    let ends = [view.to_screen(*a)?, view.to_screen(*b)?];
    egui::Rect::from_two_pos(ends[0], ends[1]).intersects(view.place.expand(4.0)).then_some(ends)
}

fn on_screen(view: View, lines: &[[Vec3; 2]]) -> impl Iterator<Item = [Pos2; 2]> + '_ {
    lines.iter().filter_map(move |line| ends_on_screen(view, line))
}

/// The shape whose lines pass nearest to a position on the screen, if any is near.
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

/// The selected shape with its changes, and its handles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chosen {
    /// Its position, world space.
    pub(crate) placed: PlacedCollider,
    pub(crate) edit: ColliderEdit,
}

impl Chosen {
    /// Its middle, world space, metres.
    fn middle(&self) -> Vec3 {
        match self.placed.shape {
            ColliderShape::Capsule { a, b, .. } => a.midpoint(b),
            ColliderShape::Ellipsoid { from_unit } => from_unit.translation.into(),
        }
    }

    /// A direction across the view, and the distance of the surface from the middle in that direction, metres.
    fn rim(&self, view: View) -> Option<(Vec3, f32)> {
        let middle = self.middle();
        let at = view.to_screen(middle)?;
        let right = view.right_of(at, middle)?;
        let (along, radius): (Vec3, f32) = match self.placed.shape {
            ColliderShape::Capsule { a, b, radius_a, radius_b } => {
                // At the side of the capsule and not at its end.
                let aside = (b - a).cross(middle - view.eye);
                let aside = if aside.dot(right) < 0.0 { -aside } else { aside };
                let aside = aside.normalize_or(right);
                (aside, 0.5 * (radius_a + radius_b))
            }
            ColliderShape::Ellipsoid { from_unit } => {
                (right, 1.0 / from_unit.matrix3.inverse().mul_vec3(right).length())
            }
        };
        (along.is_finite() && radius.is_finite() && radius > 0.0).then_some((along, radius))
    }
}

/// Paints the handles of the selected shape and drags them: the middle in the plane that faces the camera, the rim toward and away
/// from the middle.
pub(crate) fn edit(ui: &Ui, view: View, chosen: &mut Chosen) {
    let middle = chosen.middle();
    let (Some(at), Some((along, radius))) = (view.to_screen(middle), chosen.rim(view)) else { return };
    let Some(rim) = view.to_screen(middle + along * radius) else { return };
    let painter = ui.painter_at(view.place);
    let before = chosen.edit;
    // The middle comes after the rim, so that it receives clicks on both.
    let size = handle(ui, rim, ui.scope_id().with("radius"), "Radius of the collider in the image");
    if let Some(pointer) = dragged_to(ui, &size, rim) {
        let out = (view.at_depth_of(pointer, middle + along * radius) - middle).dot(along);
        chosen.edit.scale *= (out / radius).max(1e-3);
    }
    let place = handle(ui, at, ui.scope_id().with("collider"), "Collider in the image");
    if let Some(pointer) = dragged_to(ui, &place, at) {
        let moved = view.at_depth_of(pointer, middle) - middle;
        let at_rest = chosen.placed.world_from_rest.matrix3.inverse().mul_vec3(moved);
        if at_rest.is_finite() {
            chosen.edit.offset = (Vec3::from(before.offset) + at_rest).to_array();
        }
    }
    if chosen.edit != before {
        chosen.edit = chosen.edit.clamped();
    }
    painter.line_segment([at, rim], Stroke::new(1.0, theme::accent().gamma_multiply(0.6)));
    dot(&painter, size, rim, "Drag to scale the shape.");
    dot(&painter, place, at, "Drag to move the shape.");
}

pub(crate) fn distance_to_segment(p: Pos2, a: Pos2, b: Pos2) -> f32 {
    let along = b - a;
    let t = ((p - a).dot(along) / along.length_sq().max(1e-6)).clamp(0.0, 1.0);
    (p - (a + along * t)).length()
}
