//! Hair ties in the picture: rings with a handle that is dragged over the head, and arrows that are turned.

use egui::{CursorIcon, Id, Pos2, Shape, Stroke, Ui};
use glam::{Affine3A, Vec3};
use lovelock_studio::groom::{HairTie, Scalp, TieReach};

use super::head::{self, OnHead, Side};
use super::{View, handle};
use crate::window::{aim, theme};

/// Length of the arrow that shows where hair leaves a tie, metres.
const ARROW: f32 = 0.05;
/// A ring that is farther from the head than this is dragged through the air, metres.
const OFF_THE_HEAD: f32 = 0.05;

/// A tie as it was when its drag began.
#[derive(Clone, Copy)]
struct Grabbed {
    axis: Vec3,
    /// The head's normal at the tie, how far over the head the tie is, and on which side; none where it is in the air.
    over_head: Option<(Vec3, f32, Side)>,
}

/// Paints the ties and lets the chosen one be dragged, and others be chosen. A tie on the head goes over it, as `scalp` is, on the
/// side where it was taken hold of, and turns as it goes; another one moves in the plane that faces the camera. Returns whether the
/// pointer is at a handle, and not at the picture.
pub(crate) fn edit(
    ui: &Ui,
    view: View,
    (world_from_head, scalp): (&Affine3A, &Scalp),
    ties: &mut [HairTie],
    selected: &mut usize,
) -> bool {
    let painter = ui.painter_at(view.place);
    let mut held = false;
    for (i, tie) in ties.iter_mut().enumerate() {
        let centre = world_from_head.transform_point3(tie.at);
        let Some(at) = view.to_screen(centre) else { continue };
        let axis = world_from_head.transform_vector3(tie.axis.normalize_or(Vec3::NEG_Z));
        let end = view.to_screen(centre + axis * ARROW);
        // Before the ring, which has what lies on both.
        let arrow = end.filter(|_| *selected == i).map(|end| {
            let name = format!("Aim of tie {} in the picture", i + 1);
            handle(ui, end, ui.scope_id().with(("aim", i)), &name)
        });
        if let Some(arrow) = arrow {
            if let Some(pointer) = arrow.interact_pointer_pos().filter(|_| arrow.dragged()) {
                let to = view.at_depth_of(pointer, centre + axis * ARROW) - centre;
                if let Some(turned) = world_from_head.inverse().transform_vector3(to).try_normalize() {
                    tie.axis = turned;
                }
            }
            held |= arrow.hovered() || arrow.dragged();
            arrow.on_hover_cursor(CursorIcon::Grab).on_hover_text("Drag to turn the tie.");
        }
        let id = ui.scope_id().with(("tie", i));
        let ring_handle = handle(ui, at, id, &format!("Tie {} in the picture", i + 1));
        if ring_handle.clicked() || ring_handle.drag_started() {
            *selected = i;
        }
        if ring_handle.drag_started() {
            let along = (centre - view.eye).normalize_or(Vec3::NEG_Z);
            let along = world_from_head.inverse().transform_vector3(along);
            let over_head = head::nearest(scalp, tie.at).filter(|(_, height)| *height < OFF_THE_HEAD);
            let over_head = over_head
                .map(|(OnHead { normal, .. }, height)| (normal, height.max(0.0), Side::of(normal, along)));
            ui.data_mut(|data| data.insert_temp(id, Grabbed { axis: tie.axis, over_head }));
        }
        if let Some(pointer) = ring_handle.interact_pointer_pos().filter(|_| ring_handle.dragged()) {
            drag(ui, view, (world_from_head, scalp), tie, (id, pointer));
        }
        let over = ring_handle.hovered() || ring_handle.dragged();
        held |= over;
        let color = if *selected == i || over { theme::ACCENT } else { theme::BRIGHT };
        if *selected == i && tie.reach == TieReach::InSphere {
            // The patch whose hair it gathers.
            let middle = world_from_head.transform_point3(tie.sphere_middle());
            let outline = ring(view, middle, (view.eye - middle).normalize_or(Vec3::Z), tie.sphere_radius);
            painter.extend(Shape::dashed_line(&closed(outline), Stroke::new(1.5, color), 6.0, 4.0));
        }
        let ring = ring(view, centre, axis, tie.radius.max(0.012));
        painter.add(Shape::closed_line(ring.clone(), Stroke::new(4.0, theme::PAGE.gamma_multiply(0.6))));
        painter.add(Shape::closed_line(ring, Stroke::new(2.0, color)));
        if let Some(end) = end {
            painter.arrow(at, end - at, Stroke::new(2.0, color));
        }
        painter.circle_filled(at, if over { 6.0 } else { 4.5 }, color);
        ring_handle.on_hover_cursor(CursorIcon::Grab).on_hover_text("Drag to move the tie over the head.");
    }
    held
}

/// Moves a tie to where the pointer is.
fn drag(
    ui: &Ui,
    view: View,
    (world_from_head, scalp): (&Affine3A, &Scalp),
    tie: &mut HairTie,
    (id, pointer): (Id, Pos2),
) {
    let head_from_world = world_from_head.inverse();
    let in_air =
        head_from_world.transform_point3(view.at_depth_of(pointer, world_from_head.transform_point3(tie.at)));
    let (mut to, mut axis) = (in_air, None);
    let grabbed: Option<Grabbed> = ui.data(|data| data.get_temp(id));
    if let Some(Grabbed { axis: before, over_head: Some((from, height, side)) }) = grabbed {
        let eye = head_from_world.transform_point3(view.eye);
        let along = head_from_world.transform_vector3(view.ray(pointer)).normalize_or(Vec3::NEG_Z);
        // Beside the head it goes on in the plane that faces the camera.
        let beside = || head::nearest(scalp, in_air).map(|(on_head, _)| OnHead { place: in_air, ..on_head });
        if let Some(on_head) = head::under(scalp, height, (eye, along), (tie.at, side)).or_else(beside) {
            (to, axis) = (on_head.place, Some(aim::moved(before, from, on_head.normal)));
        }
    }
    if to.is_finite() {
        tie.at = to.clamp(Vec3::splat(-0.6), Vec3::splat(0.6));
        tie.axis = axis.filter(|axis| axis.is_finite()).unwrap_or(tie.axis);
    }
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

fn closed(mut line: Vec<Pos2>) -> Vec<Pos2> {
    line.extend(line.first().copied());
    line
}
