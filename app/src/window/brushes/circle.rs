//! The circle of the brush on the hair, and the locks that it would touch.

use egui::{Color32, Painter, Stroke as Line, Ui};
use glam::Vec3;
use lovelock_brush::{BrushMirror, BrushSettings};
use lovelock_session::snapshot::FrameSnapshot;

use crate::window::overlay::View;
use crate::window::theme;

/// Points of a circle.
const CIRCLE: u8 = 48;
/// The most guides that light up.
const MAX_LIT: usize = 240;
/// Places inside the circle whose guides light up must lie within this part of the radius along the view.
const DEPTH: f32 = 1.0;

/// How the circle looks.
#[derive(Clone, Copy)]
pub(super) struct Look {
    pub(super) color: Color32,
    /// Whether locks light up.
    pub(super) lit: bool,
}

/// Paints the circle around `place` (world space), the smaller one that shows the strength, and those of the other side of the head.
pub(super) fn paint(
    ui: &Ui,
    view: View,
    snapshot: &FrameSnapshot,
    settings: &BrushSettings,
    place: Vec3,
    look: Look,
) {
    let painter = ui.painter_at(view.place);
    if look.lit {
        light_up(&painter, view, snapshot, settings, place, look.color);
    }
    let head = snapshot.guides.world_from_head;
    let outward = |p: Vec3| (p - head.transform_point3(Vec3::Y * 0.1)).normalize_or(Vec3::Y);
    // On the hair, but never seen from the edge.
    let normal = (outward(place) + (view.eye - place).normalize_or(Vec3::Z)).normalize_or(Vec3::Z);
    ring(&painter, view, place, normal, settings.radius, look.color, 1.5);
    if settings.strength > 0.02 {
        ring(
            &painter,
            view,
            place,
            normal,
            settings.radius * settings.strength,
            look.color.gamma_multiply(0.45),
            1.0,
        );
    }
    if settings.mirror != BrushMirror::Off {
        let inside = head.inverse().transform_point3(place);
        let other = head.transform_point3(Vec3::new(-inside.x, inside.y, inside.z));
        ring(&painter, view, other, outward(other), settings.radius, look.color.gamma_multiply(0.6), 1.0);
    }
}

fn ring(painter: &Painter, view: View, place: Vec3, normal: Vec3, radius: f32, color: Color32, width: f32) {
    let across = normal.any_orthonormal_vector();
    let along = normal.cross(across);
    let points: Vec<_> = (0..=CIRCLE)
        .filter_map(|i| {
            let (sin, cos) = (std::f32::consts::TAU * f32::from(i) / f32::from(CIRCLE)).sin_cos();
            view.to_screen(place + (across * cos + along * sin) * radius)
        })
        .collect();
    painter.line(points.clone(), Line::new(width + 2.0, theme::page().gamma_multiply(0.6)));
    painter.line(points, Line::new(width, color));
}

fn light_up(
    painter: &Painter,
    view: View,
    snapshot: &FrameSnapshot,
    settings: &BrushSettings,
    place: Vec3,
    color: Color32,
) {
    let guides = &snapshot.guides.guides;
    let radius = settings.radius;
    let mut lit = 0;
    for guide in 0..guides.count() {
        let inside = |i: usize| guides.point(guide, i).distance(place) < radius * DEPTH;
        let Some(first) = (1..guides.points_per_guide).find(|i| inside(*i)) else { continue };
        lit += 1;
        if lit > MAX_LIT {
            break;
        }
        let end = (first..guides.points_per_guide).take_while(|i| inside(*i)).last().unwrap_or(first);
        let points = (first - 1..=end).filter_map(|i| view.to_screen(guides.point(guide, i))).collect();
        let near = 1.0 - guides.point(guide, first).distance(place) / radius.max(1e-4);
        let weight = settings.falloff.at(1.0 - near.clamp(0.0, 1.0)) * settings.strength;
        painter.line(points, Line::new(1.0, color.gamma_multiply(0.15 + 0.5 * weight.clamp(0.0, 1.0))));
    }
}
