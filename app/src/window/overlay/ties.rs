//! Hair ties in the picture: rings with a handle that is dragged over the head, arrows that are turned, and the patches whose
//! hair they gather.

use egui::{CursorIcon, Id, Painter, Pos2, Shape, Stroke, Ui};
use glam::Vec3;
use lovelock_groom::{HairTie, TieReach};

use super::head::{Head, Hold};
use super::{HANDLE, View, dot, dragged_to, handle};
use crate::window::{aim, theme};

/// Length of the arrow that shows where hair leaves a tie, metres.
const ARROW: f32 = 0.05;

/// A tie as it was when its drag began.
#[derive(Clone, Copy)]
struct Grabbed {
    axis: Vec3,
    hold: Hold,
}

/// Paints the ties and lets the chosen one be dragged, and others be chosen. A tie on the head goes over it, on the
/// side where it was taken hold of, and turns as it goes; another one moves in the plane that faces the camera.
pub(crate) fn edit(ui: &Ui, view: View, head: Head<'_>, ties: &mut [HairTie], selected: &mut usize) {
    let painter = ui.painter_at(view.place);
    // Before the rings, which have what lies on both.
    if let Some(tie) = ties.get_mut(*selected).filter(|tie| tie.reach == TieReach::InSphere) {
        patch(ui, &painter, view, head, tie);
    }
    for (i, tie) in ties.iter_mut().enumerate() {
        let centre = head.world(tie.at);
        let Some(at) = view.to_screen(centre) else { continue };
        let axis = head.world_from_head.transform_vector3(tie.axis.normalize_or(Vec3::NEG_Z));
        let end = view.to_screen(centre + axis * ARROW);
        // Before the ring, which has what lies on both.
        if let Some(end) = end.filter(|_| *selected == i) {
            let name = format!("Aim of tie {} in the picture", i + 1);
            let arrow = handle(ui, end, ui.scope_id().with(("aim", i)), &name);
            if let Some(pointer) = dragged_to(ui, &arrow, end) {
                let to = view.at_depth_of(pointer, centre + axis * ARROW) - centre;
                if let Some(turned) = head.world_from_head.inverse().transform_vector3(to).try_normalize() {
                    tie.axis = turned;
                }
            }
            arrow.on_hover_cursor(CursorIcon::Grab).on_hover_text("Drag to turn the tie.");
        }
        let id = ui.scope_id().with(("tie", i));
        let ring_handle = handle(ui, at, id, &format!("Tie {} in the picture", i + 1));
        if ring_handle.clicked() || ring_handle.drag_started() {
            *selected = i;
        }
        if ring_handle.drag_started() {
            let grabbed = Grabbed { axis: tie.axis, hold: Hold::new(view, head, tie.at, 0.0) };
            ui.data_mut(|data| data.insert_temp(id, grabbed));
        }
        if let Some(pointer) = dragged_to(ui, &ring_handle, at) {
            drag(ui, view, head, tie, (id, pointer));
        }
        let over = ring_handle.hovered() || ring_handle.dragged();
        let color = if *selected == i || over { theme::ACCENT } else { theme::BRIGHT };
        let ring = ring(view, centre, axis, tie.radius.max(0.012));
        painter.add(Shape::closed_line(ring.clone(), Stroke::new(4.0, theme::PAGE.gamma_multiply(0.6))));
        painter.add(Shape::closed_line(ring, Stroke::new(2.0, color)));
        if let Some(end) = end {
            painter.arrow(at, end - at, Stroke::new(2.0, color));
        }
        painter.circle_filled(at, if over { 6.0 } else { 4.5 }, color);
        ring_handle.on_hover_cursor(CursorIcon::Grab).on_hover_text("Drag to move the tie over the head.");
    }
}

/// Moves a tie to where the pointer is.
fn drag(ui: &Ui, view: View, head: Head<'_>, tie: &mut HairTie, (id, pointer): (Id, Pos2)) {
    let Some(Grabbed { axis, hold }) = ui.data(|data| data.get_temp(id)) else { return };
    let Some((to, normals)) = hold.drag(view, head, (tie.at, pointer)) else { return };
    tie.at = to;
    if let Some(turned) = normals.map(|[from, to]| aim::moved(axis, from, to)).filter(|axis| axis.is_finite())
    {
        tie.axis = turned;
    }
}

/// How far inside the head the middle of a patch stays as it is dragged over it, metres: it gathers roots on both sides.
const INSIDE: f32 = 0.03;

/// Paints the patch whose hair a tie gathers and lets it be changed: its rim is dragged to and from its middle, and where it is not
/// around the ring its middle goes over the head as a ring does.
fn patch(ui: &Ui, painter: &Painter, view: View, head: Head<'_>, tie: &mut HairTie) {
    let middle = head.world(tie.sphere_middle());
    let Some(at) = view.to_screen(middle) else { return };
    let Some(right) = view.right_of(at, middle) else { return };
    let Some(rim_at) = view.to_screen(middle + right * tie.sphere_radius) else { return };
    let rim = handle(ui, rim_at, ui.scope_id().with("patch's rim"), "Radius of the patch in the picture");
    if let Some(pointer) = dragged_to(ui, &rim, rim_at) {
        let out = (view.at_depth_of(pointer, middle) - middle).dot(right);
        if out.is_finite() {
            tie.sphere_radius = out.clamp(0.005, 0.6);
        }
    }
    let outline = ring(view, middle, (view.eye - middle).normalize_or(Vec3::Z), tie.sphere_radius);
    painter.extend(Shape::dashed_line(&closed(outline), Stroke::new(1.5, theme::ACCENT), 6.0, 4.0));
    dot(painter, rim, rim_at, "Drag to gather more or less hair.");
    if !tie.sphere_at_ring {
        let id = ui.scope_id().with("patch");
        let handle_at = beside_ring(at, view.to_screen(head.world(tie.at)));
        let place = handle(ui, handle_at, id, "Patch in the picture");
        if place.drag_started() {
            ui.data_mut(|data| data.insert_temp(id, Hold::new(view, head, tie.sphere_centre, -INSIDE)));
        }
        let hold: Option<Hold> = ui.data(|data| data.get_temp(id));
        if let Some((pointer, hold)) = dragged_to(ui, &place, at).zip(hold)
            && let Some((to, _)) = hold.drag(view, head, (tie.sphere_centre, pointer))
        {
            tie.sphere_centre = to;
        }
        painter.line_segment([at, handle_at], Stroke::new(1.0, theme::ACCENT.gamma_multiply(0.6)));
        dot(painter, place, handle_at, "Drag to move the patch over the head.");
    }
}

/// Where the handle of a patch is whose middle is at `at`: below it where it would lie under that of the ring.
fn beside_ring(at: Pos2, ring: Option<Pos2>) -> Pos2 {
    let Some(ring) = ring.filter(|ring| (at - *ring).abs().max_elem() < HANDLE) else { return at };
    Pos2::new(at.x, ring.y + 1.25 * HANDLE)
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
