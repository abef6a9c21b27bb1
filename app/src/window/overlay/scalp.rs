//! The scalp in the image: its area and its outline, whose handles are dragged, and a brush.

use egui::epaint::{Mesh, Vertex, WHITE_UV};
use egui::{Modifiers, Painter, PointerButton, Pos2, Response, Shape, Stroke, Ui};
use glam::Vec3;
use lovelock_motion::{ScalpFit, Skull, hairline_place, raise_hairline};

use super::head::Head;
use super::{View, dot, dragged_to, handle};
use crate::window::theme;

/// How the scalp is shown and edited.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ScalpTool {
    /// Whether area, outline and handles are shown.
    pub(crate) shown: bool,
    /// Whether the other side is painted alike.
    pub(crate) mirrored: bool,
    /// Angle of the brush, seen from the middle of the skull, radians.
    pub(crate) brush: f32,
}

impl Default for ScalpTool {
    fn default() -> Self {
        Self { shown: false, mirrored: true, brush: 0.2 }
    }
}

/// The mask at the outline.
const LINE: f32 = 0.5;

/// Shows the scalp of a head and edits it; a drag paints it if `paints`. Returns whether it uses the pointer.
pub(crate) fn edit(
    ui: &Ui,
    response: &Response,
    view: View,
    head: Head<'_>,
    skull: &Skull,
    (tool, paints, fit): (ScalpTool, bool, &mut ScalpFit),
) -> bool {
    let painter = ui.painter_at(view.place);
    area(&painter, view, head);
    for side in [1.0, -1.0] {
        for (i, (name, degrees)) in ScalpFit::PLACES.into_iter().enumerate() {
            let in_middle = degrees == 0.0 || degrees == 180.0;
            if in_middle && side < 0.0 {
                continue;
            }
            let words = match (in_middle, side > 0.0) {
                (true, _) => name.to_owned(),
                (_, true) => format!("{name}, left"),
                (_, false) => format!("{name}, right"),
            };
            grip(ui, &painter, view, head, skull, fit, (i, side * degrees.to_radians(), &words));
        }
    }
    paints && paint(ui, response, view, head, skull, tool, fit)
}

/// A handle of the hairline.
fn grip(
    ui: &Ui,
    painter: &Painter,
    view: View,
    head: Head<'_>,
    skull: &Skull,
    fit: &mut ScalpFit,
    (i, azimuth, name): (usize, f32, &str),
) {
    let Some((place, normal)) = on_skin(head, skull, hairline_place(skull, fit, azimuth)) else { return };
    let world = head.world(place);
    let toward = head.world_from_head.transform_vector3(normal).dot(world - view.eye);
    let id = ui.scope_id().with(("hairline", name));
    let held: bool = ui.ctx().is_being_dragged(id);
    if toward > 0.0 && !held {
        return;
    }
    let Some(at) = view.to_screen(world) else { return };
    let grip = handle(ui, at, id, &format!("Hairline at the {name}"));
    if grip.double_clicked() {
        if let Some(raise) = fit.raise.at_mut(i) {
            *raise = 0.0;
        }
    } else if let Some(pointer) = dragged_to(ui, &grip, at) {
        let to = head.under(view, pointer, place).unwrap_or_else(|| {
            head.world_from_head.inverse().transform_point3(view.at_depth_of(pointer, world))
        });
        raise_hairline(skull, fit, i, to);
    }
    dot(painter, grip, at, "Drag to move the hairline, on both sides. Double-click to restore it.");
}

/// Paints hair under the pointer, or removes it.
fn paint(
    ui: &Ui,
    response: &Response,
    view: View,
    head: Head<'_>,
    skull: &Skull,
    tool: ScalpTool,
    fit: &mut ScalpFit,
) -> bool {
    let Some(pointer) = response.hover_pos().or_else(|| response.interact_pointer_pos()) else {
        return false;
    };
    let Some(place) = head.under(view, pointer, head.eye(view)) else {
        return response.dragged_by(PointerButton::Primary)
            && ui.data(|data| data.get_temp(response.id) == Some(true));
    };
    let removes = ui.input(|input| input.modifiers.matches_logically(Modifiers::COMMAND));
    let direction = skull.relative(place);
    let size = tool.brush * skull.half.min_element();
    let (world, edge) = (head.world(place), head.world_from_head.transform_vector3(Vec3::X).length() * size);
    if let (Some(at), Some(right)) =
        (view.to_screen(world), view.to_screen(world).and_then(|at| view.right_of(at, world)))
        && let Some(rim) = view.to_screen(world + right * edge)
    {
        let color = if removes { theme::wrong() } else { theme::good() };
        ui.painter_at(view.place).circle_stroke(at, at.distance(rim).max(2.0), Stroke::new(1.5, color));
    }
    let presses = response.drag_started_by(PointerButton::Primary) || response.clicked();
    let goes_on = response.dragged_by(PointerButton::Primary);
    if response.drag_started_by(PointerButton::Primary) {
        ui.data_mut(|data| data.insert_temp(response.id, true));
    } else if !goes_on {
        ui.data_mut(|data| data.insert_temp(response.id, false));
    }
    // A drag that began beside the head moves the camera.
    let began_here = ui.data(|data| data.get_temp(response.id) == Some(true));
    if presses || (goes_on && began_here) {
        fit.paint(direction, tool.brush, 1.0, removes);
        if tool.mirrored {
            fit.paint(direction * Vec3::new(-1.0, 1.0, 1.0), tool.brush, 1.0, removes);
        }
    }
    presses || (goes_on && began_here)
}

/// The vertex of the scalp's surface in the direction of a place, with its normal.
fn on_skin(head: Head<'_>, skull: &Skull, place: Vec3) -> Option<(Vec3, Vec3)> {
    let toward = skull.relative(place).normalize_or(Vec3::Y);
    let along = |p: &Vec3| skull.relative(*p).normalize_or_zero().dot(toward);
    let vertices = head.scalp.positions.iter().zip(&head.scalp.normals).filter(|(p, _)| p.is_finite());
    vertices.max_by(|a, b| along(a.0).total_cmp(&along(b.0))).map(|(p, n)| (*p, *n))
}

/// Fills where hair grows, and draws the outline.
fn area(painter: &Painter, view: View, head: Head<'_>) {
    let scalp = head.scalp;
    let screen: Vec<Option<Pos2>> = scalp.positions.iter().map(|p| view.to_screen(head.world(*p))).collect();
    let mut mesh = Mesh::default();
    let fill = theme::accent().gamma_multiply(0.35);
    let mut lines = Vec::new();
    for t in &scalp.triangles {
        let corners = t.map(|v| v as usize);
        let [Some(a), Some(b), Some(c)] = corners.map(|v| screen.get(v).copied().flatten()) else { continue };
        // Counter-clockwise in the world is clockwise on the screen, where y points down; others face away.
        if (b - a).x * (c - a).y - (b - a).y * (c - a).x >= 0.0 {
            continue;
        }
        let masks = corners.map(|v| scalp.mask.get(v).copied().unwrap_or(0.0));
        if masks.iter().all(|mask| *mask < 0.02) {
            continue;
        }
        let first = mesh.vertices.len() as u32;
        for (pos, mask) in [a, b, c].into_iter().zip(masks) {
            mesh.vertices.push(Vertex { pos, uv: WHITE_UV, color: fill.gamma_multiply(mask) });
        }
        mesh.indices.extend([first, first + 1, first + 2]);
        let edges = [(a, b, masks[0], masks[1]), (b, c, masks[1], masks[2]), (c, a, masks[2], masks[0])];
        let cuts: Vec<Pos2> = edges
            .into_iter()
            .filter(|(.., from, to)| (*from >= LINE) != (*to >= LINE))
            .map(|(p, q, from, to)| p + (q - p) * ((LINE - from) / (to - from)))
            .collect();
        if let [from, to] = cuts[..] {
            lines.push([from, to]);
        }
    }
    painter.add(Shape::mesh(mesh));
    for line in lines {
        painter.line_segment(line, Stroke::new(2.0, theme::accent()));
    }
}
