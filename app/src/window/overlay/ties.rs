//! Hair ties in the picture: rings with a handle that is dragged.

use egui::{CursorIcon, Pos2, Rect, Sense, Shape, Stroke, Ui, Vec2};
use glam::{Affine3A, Vec3};
use lovelock_studio::groom::HairTie;

use super::View;
use crate::window::theme;

/// Paints the ties and lets the chosen one be dragged in the plane that faces the camera, and others be chosen. Returns
/// whether the pointer is at a handle, and not at the picture.
pub(crate) fn edit(
    ui: &Ui,
    view: View,
    world_from_head: &Affine3A,
    ties: &mut [HairTie],
    selected: &mut usize,
) -> bool {
    let painter = ui.painter_at(view.place);
    let mut held = false;
    for (i, tie) in ties.iter_mut().enumerate() {
        let centre = world_from_head.transform_point3(tie.at);
        let Some(at) = view.to_screen(centre) else { continue };
        let handle = ui.interact(
            Rect::from_center_size(at, Vec2::splat(22.0)),
            ui.scope_id().with(("tie", i)),
            Sense::click_and_drag(),
        );
        let name = format!("Tie {} in the picture", i + 1);
        handle.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name.as_str()));
        if handle.clicked() || handle.drag_started() {
            *selected = i;
        }
        if let Some(pointer) = handle.interact_pointer_pos().filter(|_| handle.dragged()) {
            let to = view.at_depth_of(pointer, centre);
            let in_head = world_from_head.inverse().transform_point3(to);
            if in_head.is_finite() {
                tie.at = in_head.clamp(Vec3::splat(-0.6), Vec3::splat(0.6));
            }
        }
        let over = handle.hovered() || handle.dragged();
        held |= over;
        let color = if *selected == i || over { theme::ACCENT } else { theme::BRIGHT };
        let axis = world_from_head.transform_vector3(tie.axis.normalize_or(Vec3::NEG_Z));
        let ring = ring(view, centre, axis, tie.radius.max(0.012));
        painter.add(Shape::closed_line(ring.clone(), Stroke::new(4.0, theme::PAGE.gamma_multiply(0.6))));
        painter.add(Shape::closed_line(ring, Stroke::new(2.0, color)));
        if let Some(end) = view.to_screen(centre + axis * 0.05) {
            painter.arrow(at, end - at, Stroke::new(2.0, color));
        }
        painter.circle_filled(at, if over { 6.0 } else { 4.5 }, color);
        handle.on_hover_cursor(CursorIcon::Grab).on_hover_text("Drag to move the tie.");
    }
    held
}

/// A circle around an axis, on the screen.
fn ring(view: View, centre: Vec3, axis: Vec3, radius: f32) -> Vec<Pos2> {
    let u = axis.any_orthonormal_vector() * radius;
    let v = axis.cross(u).normalize_or_zero() * radius;
    (0..24_u8)
        .filter_map(|i| {
            let (sin, cos) = (std::f32::consts::TAU * f32::from(i) / 24.0).sin_cos();
            view.to_screen(centre + u * cos + v * sin)
        })
        .collect()
}
