//! A sphere with a handle that shows and sets where a light or the wind comes from.

use egui::{Color32, Pos2, Response, Sense, Stroke, Ui, Vec2};
use glam::Vec3;

use super::theme;
use crate::window::control::{HoverTooltip, spoken_value};

/// The labels of a sphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sphere {
    /// The name of the control.
    pub(crate) name: &'static str,
    /// What has the direction, such as `the light`.
    pub(crate) what: &'static str,
}

/// Shows the sphere for a light.
pub(crate) fn light_sphere(ui: &mut Ui, direction: &mut Vec3, axes: [Vec3; 3]) -> Response {
    sphere(ui, Sphere { name: "Light direction", what: "the light" }, direction, axes)
}

/// Shows the sphere from the camera's view and edits `direction`, in which the light or the wind travels. `right`, `up` and `back`
/// are the camera's axes in the world. The handle is at the side from which the light comes; it is hollow behind the sphere.
pub(crate) fn sphere(
    ui: &mut Ui,
    of: Sphere,
    direction: &mut Vec3,
    [right, up, back]: [Vec3; 3],
) -> Response {
    let (rect, mut response) = ui.allocate_exact_size(Vec2::splat(104.0), Sense::click_and_drag());
    let center = rect.center();
    let radius = 46.0;
    let from = -direction.normalize_or(Vec3::NEG_Y);
    let seen = Vec3::new(from.dot(right), from.dot(up), from.dot(back));
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged() || response.clicked()) {
        let p = (at - center) / radius;
        let on_sphere = point_on_sphere(p.x, -p.y, seen.z < 0.0 && !response.drag_started());
        let from = right * on_sphere.x + up * on_sphere.y + back * on_sphere.z;
        *direction = -from.normalize_or(Vec3::Y);
        response.mark_changed();
    }
    let painter = ui.painter_at(rect);
    // Rings that shade a ball lit from the handle.
    for ring in (1..=12_u8).rev() {
        let share = f32::from(ring) / 12.0;
        let shift = Vec2::new(seen.x, -seen.y) * (1.0 - share) * radius * 0.9;
        let light = if seen.z > 0.0 { 1.0 - share } else { 0.25 * (1.0 - share) };
        painter.circle_filled(center + shift, radius * share, Color32::from_gray(34 + (light * 120.0) as u8));
    }
    painter.circle_stroke(center, radius, Stroke::new(1.0, theme::quiet()));
    let handle: Pos2 = center + Vec2::new(seen.x, -seen.y) * radius;
    if seen.z >= 0.0 {
        painter.circle_filled(handle, 6.0, theme::accent());
    } else {
        painter.circle_stroke(handle, 6.0, Stroke::new(2.0, theme::accent()));
    }
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Slider, true, of.name));
    let [across, rise] =
        [seen.x.atan2(seen.z), seen.y.clamp(-1.0, 1.0).asin()].map(|angle| f64::from(angle.to_degrees()));
    spoken_value(&response, across, [-180.0, 180.0], || {
        let side = if across < 0.0 { "left" } else { "right" };
        let height = if rise < 0.0 { "below" } else { "above" };
        format!("{:.0}° from the {side}, {:.0}° from {height}", across.abs(), rise.abs())
    });
    response.hover_tooltip(format!(
        "Drag to set where {} comes from, as seen by the camera. A hollow handle is behind the sphere.",
        of.what
    ))
}

/// The point of the unit sphere under `x`, `y`: on its front, or on its back if `behind`. Points outside are moved to the rim.
fn point_on_sphere(x: f32, y: f32, behind: bool) -> Vec3 {
    let squared = x * x + y * y;
    if squared >= 1.0 {
        return Vec3::new(x, y, 0.0).normalize_or(Vec3::Y);
    }
    let depth = (1.0 - squared).sqrt();
    Vec3::new(x, y, if behind { -depth } else { depth })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_lie_on_the_sphere() {
        for (x, y, behind) in [(0.0, 0.0, false), (0.3, -0.4, true), (2.0, 1.0, false)] {
            let p = point_on_sphere(x, y, behind);
            assert!((p.length() - 1.0).abs() < 1e-6);
            assert!(if behind { p.z <= 0.0 } else { p.z >= 0.0 });
        }
    }
}
