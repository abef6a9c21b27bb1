//! Hair ties in the image: rings with a handle that is dragged over the head, arrows that are turned, and the patches whose hair
//! they gather.

use egui::{CursorIcon, Id, Painter, Pos2, Shape, Stroke, Ui};
use glam::Vec3;
use lovelock_groom::{HairTie, TieReach};

use super::head::{Head, Hold};
use super::{HANDLE, View, dot, dragged_to, handle};
use crate::window::control::HoverTooltip;
use crate::window::{aim, theme};

/// Length of the arrow in the direction in which hair leaves a tie, metres.
const ARROW: f32 = 0.05;

/// A tie at the start of its drag.
#[derive(Clone, Copy)]
struct Grabbed {
    axis: Vec3,
    hold: Hold,
}

/// Paints the ties, drags the selected one and selects others. A tie on the head moves over it, on the side where it was grabbed,
/// and turns with the surface; any other moves in the plane that faces the camera.
pub(crate) fn edit(ui: &Ui, view: View, head: Head<'_>, ties: &mut [HairTie], selected: &mut usize) {
    let painter = ui.painter_at(view.place);
    // The patch comes before the rings, which receive clicks on both.
    if let Some(tie) = ties.get_mut(*selected).filter(|tie| tie.reach == TieReach::InSphere) {
        patch(ui, &painter, view, head, tie);
    }
    for (i, tie) in ties.iter_mut().enumerate() {
        let centre = head.world(tie.at);
        let Some(at) = view.to_screen(centre) else { continue };
        let axis = head.world_from_head.transform_vector3(tie.axis).normalize_or(Vec3::NEG_Z);
        let end = view.to_screen(centre + axis * ARROW);
        // The arrow comes before the ring, which receives clicks on both.
        if let Some(end) = end.filter(|_| *selected == i) {
            let name = format!("Direction of tie {} in the image", i + 1);
            let arrow = handle(ui, end, ui.scope_id().with(("aim", i)), &name);
            if let Some(pointer) = dragged_to(ui, &arrow, end) {
                let to = view.at_depth_of(pointer, centre + axis * ARROW) - centre;
                if let Some(turned) = head.world_from_head.inverse().transform_vector3(to).try_normalize() {
                    tie.axis = turned;
                }
            }
            arrow.on_hover_cursor(CursorIcon::Grab).hover_tooltip("Drag to turn the tie.");
        }
        let id = ui.scope_id().with(("tie", i));
        let ring_handle = handle(ui, at, id, &format!("Tie {} in the image", i + 1));
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
        let color = if *selected == i || over { theme::accent() } else { theme::bright() };
        let ring = ring(view, centre, axis, tie.radius.max(0.012) * head.scale());
        painter.add(Shape::closed_line(ring.clone(), Stroke::new(4.0, theme::page().gamma_multiply(0.6))));
        painter.add(Shape::closed_line(ring, Stroke::new(2.0, color)));
        if let Some(end) = end {
            painter.arrow(at, end - at, Stroke::new(2.0, color));
        }
        painter.circle_filled(at, if over { 6.0 } else { 4.5 }, color);
        ring_handle.on_hover_cursor(CursorIcon::Grab).hover_tooltip("Drag to move the tie over the head.");
    }
}

/// Moves a tie to the pointer.
fn drag(ui: &Ui, view: View, head: Head<'_>, tie: &mut HairTie, (id, pointer): (Id, Pos2)) {
    let Some(Grabbed { axis, hold }) = ui.data(|data| data.get_temp(id)) else { return };
    let Some((to, normals)) = hold.drag(view, head, (tie.at, pointer)) else { return };
    tie.at = to;
    if let Some(turned) = normals.map(|[from, to]| aim::moved(axis, from, to)).filter(|axis| axis.is_finite())
    {
        tie.axis = turned;
    }
}

/// Depth of the middle of a patch below the surface while it is dragged over the head, metres.
const INSIDE: f32 = 0.03;

/// Paints the patch whose hair a tie gathers and edits it: its rim is dragged toward and away from its middle, and unless it follows
/// the ring its middle is dragged over the head like a ring.
fn patch(ui: &Ui, painter: &Painter, view: View, head: Head<'_>, tie: &mut HairTie) {
    let middle = head.world(tie.sphere_middle());
    let Some(at) = view.to_screen(middle) else { return };
    let Some(right) = view.right_of(at, middle) else { return };
    let Some(rim_at) = view.to_screen(middle + right * (tie.sphere_radius * head.scale())) else { return };
    let rim = handle(ui, rim_at, ui.scope_id().with("patch's rim"), "Radius of the patch in the image");
    if let Some(pointer) = dragged_to(ui, &rim, rim_at) {
        let out = (view.at_depth_of(pointer, middle) - middle).dot(right);
        if out.is_finite() {
            tie.sphere_radius = (out / head.scale()).clamp(0.005, 0.6);
        }
    }
    let outline =
        ring(view, middle, (view.eye - middle).normalize_or(Vec3::Z), tie.sphere_radius * head.scale());
    painter.extend(Shape::dashed_line(&closed(outline), Stroke::new(1.5, theme::accent()), 6.0, 4.0));
    dot(painter, rim, rim_at, "Drag to gather more or less hair.");
    if !tie.sphere_at_ring {
        let id = ui.scope_id().with("patch");
        let handle_at = beside_ring(at, view.to_screen(head.world(tie.at)));
        let place = handle(ui, handle_at, id, "Patch in the image");
        if place.drag_started() {
            ui.data_mut(|data| data.insert_temp(id, Hold::new(view, head, tie.sphere_centre, -INSIDE)));
        }
        let hold: Option<Hold> = ui.data(|data| data.get_temp(id));
        if let Some((pointer, hold)) = dragged_to(ui, &place, at).zip(hold)
            && let Some((to, _)) = hold.drag(view, head, (tie.sphere_centre, pointer))
        {
            tie.sphere_centre = to;
        }
        painter.line_segment([at, handle_at], Stroke::new(1.0, theme::accent().gamma_multiply(0.6)));
        dot(painter, place, handle_at, "Drag to move the patch over the head.");
    }
}

/// The position of the handle of a patch with its middle at `at`: below the middle if it would be hidden by that of the ring.
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
