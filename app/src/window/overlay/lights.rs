//! Spots and point lights in the image: a lamp that is dragged in the plane that faces the camera and moved away by the wheel, and the cone
//! of a spot, which is turned and widened.

use egui::{Id, Painter, Pos2, Shape, Stroke, Ui};
use glam::Vec3;
use lovelock_base::settings::Settings;
use lovelock_render::{Light, LightKind};

use super::{View, dot, dragged_to, handle};
use crate::window::theme;

/// Length of the cone of a spot in the image, metres.
const REACH: f32 = 0.5;

/// The largest tangent of half the angle of a cone in the image.
const WIDEST: f32 = 3.0;

/// The factor on the distance from the camera for each point that the wheel scrolls, as that of the camera.
const PER_POINT: f32 = 0.002;

/// Paints the lamps that are on, moves the selected one and selects others.
pub(crate) fn edit(ui: &Ui, view: View, lights: &mut [Light], selected: &mut usize) {
    let painter = ui.painter_at(view.place);
    for (i, light) in lights.iter_mut().enumerate() {
        if !(light.enabled && light.stands()) {
            continue;
        }
        let before = light.clone();
        let chosen = *selected == i;
        if light.kind == LightKind::Spot {
            // The cone comes before the lamp, which receives clicks on both.
            cone(ui, &painter, view, light, (i, chosen));
        }
        let Some(at) = view.to_screen(light.position) else { continue };
        let lamp = handle(ui, at, id(ui, "lamp", i), &format!("Light {} in the image", i + 1));
        if lamp.clicked() || lamp.drag_started() {
            *selected = i;
        }
        if let Some(pointer) = dragged_to(ui, &lamp, at) {
            light.position = view.at_depth_of(pointer, light.position);
        }
        let scroll = ui.input(|input| input.smooth_scroll_delta.y);
        if scroll != 0.0 && (lamp.hovered() || lamp.dragged()) {
            light.position = view.eye + (light.position - view.eye) * (scroll * PER_POINT).exp();
        }
        let color = if chosen { theme::accent() } else { theme::bright() };
        rays(&painter, at, color);
        dot(&painter, lamp, at, "Drag to move the light across the view. Turn the wheel to move it away.");
        if *light != before {
            *light = if light.position.is_finite() && light.direction.is_finite() {
                light.clamped()
            } else {
                before
            };
        }
    }
}

fn id(ui: &Ui, what: &'static str, light: usize) -> Id {
    ui.scope_id().with((what, light))
}

/// Short lines around a lamp.
fn rays(painter: &Painter, at: Pos2, color: egui::Color32) {
    for i in 0..8_u8 {
        let way = egui::Vec2::angled(std::f32::consts::TAU * f32::from(i) / 8.0);
        painter.line_segment([at + 9.0 * way, at + 13.0 * way], Stroke::new(2.0, color));
    }
}

/// Paints the cone of a spot. If it is `chosen`, its end turns the spot and its rim widens it.
fn cone(ui: &Ui, painter: &Painter, view: View, light: &mut Light, (i, chosen): (usize, bool)) {
    let way = light.direction.normalize_or(Vec3::NEG_Y);
    let end = light.position + way * REACH;
    let tangent = |angle: f32| (0.5 * angle).tan().clamp(0.0, WIDEST);
    let across = way.any_orthonormal_vector();
    let color = if chosen { theme::accent() } else { theme::bright() };
    let outer = ring(end, (across, way.cross(across)), REACH * tangent(light.outer_angle));
    let inner = ring(end, (across, way.cross(across)), REACH * tangent(light.inner_angle));
    let on_screen = |points: &[Vec3]| points.iter().filter_map(|p| view.to_screen(*p)).collect::<Vec<_>>();
    painter.add(Shape::closed_line(on_screen(&outer), Stroke::new(1.5, color)));
    let dashes = on_screen(&[&inner[..], &inner[..1]].concat());
    painter.extend(Shape::dashed_line(&dashes, Stroke::new(1.0, color), 5.0, 4.0));
    let apex = view.to_screen(light.position);
    for p in outer.iter().step_by(outer.len() / 4) {
        if let (Some(from), Some(to)) = (apex, view.to_screen(*p)) {
            painter.line_segment([from, to], Stroke::new(1.0, color.gamma_multiply(0.6)));
        }
    }
    let Some(end_at) = view.to_screen(end).filter(|_| chosen) else { return };
    let rim = end + REACH * tangent(light.outer_angle) * view.right_of(end_at, end).unwrap_or(across);
    if let Some(rim_at) = view.to_screen(rim) {
        let name = format!("Width of light {} in the image", i + 1);
        let edge = handle(ui, rim_at, id(ui, "cone", i), &name);
        if let Some(pointer) = dragged_to(ui, &edge, rim_at) {
            let out = view.at_depth_of(pointer, rim).distance(end);
            light.outer_angle = 2.0 * (out / REACH).atan();
        }
        dot(painter, edge, rim_at, "Drag to widen the cone.");
    }
    let aim = handle(ui, end_at, id(ui, "aim", i), &format!("Direction of light {} in the image", i + 1));
    if let Some(pointer) = dragged_to(ui, &aim, end_at)
        && let Some(turned) = (view.at_depth_of(pointer, end) - light.position).try_normalize()
    {
        light.direction = turned;
    }
    dot(painter, aim, end_at, "Drag to turn the light.");
}

/// Points on a circle.
fn ring(centre: Vec3, (u, v): (Vec3, Vec3), radius: f32) -> Vec<Vec3> {
    let at = |i: u8| {
        let (sin, cos) = (std::f32::consts::TAU * f32::from(i) / 24.0).sin_cos();
        centre + (u * cos + v * sin) * radius
    };
    (0..24).map(at).collect()
}
