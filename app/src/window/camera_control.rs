//! Camera control by the pointer.

use egui::{PointerButton, Response};
use glam::Vec3;
use lovelock_project::project::{CameraMode, CameraSection};

use super::keymap::{Keymap, Navigation};

/// Angle by which a drag across the whole viewport turns the camera, radians.
const TURN: f32 = 3.6;
/// Logarithm of the factor by which a drag across the whole viewport changes the distance.
const ZOOM: f32 = 3.0;

/// Applies the pointer's input over the viewport, which shows the time `secs` of the scene. Returns whether the camera changed.
pub(crate) fn apply(camera: &mut CameraSection, secs: f64, response: &Response) -> bool {
    let before = *camera;
    steer(camera, secs, response);
    if response.hovered() {
        zoom(camera, 1.0 / response.ctx.input(egui::InputState::zoom_delta));
    }
    *camera != before
}

/// Like [`apply`], without pinching and without the wheel with Ctrl.
pub(crate) fn steer(camera: &mut CameraSection, secs: f64, response: &Response) {
    let size = response.rect.height().max(1.0);
    let drag = response.drag_delta() / size;
    let held = response.ctx.input(|input| input.modifiers);
    let preset = Keymap::of(&response.ctx).preset();
    let buttons = [PointerButton::Middle, PointerButton::Secondary, PointerButton::Primary];
    let dragged = buttons.into_iter().find(|button| response.dragged_by(*button));
    match dragged.and_then(|button| preset.navigation(button, held)) {
        Some(Navigation::Pan) => pan(camera, secs, drag.x, drag.y),
        Some(Navigation::Orbit) => orbit(camera, drag.x, drag.y),
        Some(Navigation::Zoom) => zoom(camera, (ZOOM * (drag.y - drag.x)).exp()),
        None => {}
    }
    if response.hovered() {
        let scroll = response.ctx.input(|input| input.smooth_scroll_delta.y);
        zoom(camera, (-scroll * 0.002).exp());
    }
}

/// Turns the camera about its target; `dx` and `dy` are in heights of the viewport.
fn orbit(camera: &mut CameraSection, dx: f32, dy: f32) {
    let pi = std::f32::consts::PI;
    camera.azimuth = (camera.azimuth - dx * TURN + pi).rem_euclid(2.0 * pi) - pi;
    camera.elevation = (camera.elevation + dy * TURN).clamp(-1.5, 1.5);
}

/// Moves the target so that the point under the pointer stays under it.
fn pan(camera: &mut CameraSection, secs: f64, dx: f32, dy: f32) {
    let [right, up, _] = axes(&camera.turned(secs));
    let height = 2.0 * camera.distance * (camera.fov_y * 0.5).tan();
    let shift = (up * dy - right * dx) * height;
    let (target, limit) = match camera.mode {
        CameraMode::Follow => (&mut camera.follow_offset, 3.0),
        CameraMode::Fixed => (&mut camera.fixed_target, 20.0),
    };
    *target = (*target + shift).clamp(Vec3::splat(-limit), Vec3::splat(limit));
}

fn zoom(camera: &mut CameraSection, factor: f32) {
    if factor.is_finite() {
        camera.distance = (camera.distance * factor).clamp(0.1, 30.0);
    }
}

/// The camera's axes in the world: right, up and back (toward the eye).
pub(crate) fn axes(camera: &CameraSection) -> [Vec3; 3] {
    let (sin_a, cos_a) = camera.azimuth.sin_cos();
    let (sin_e, cos_e) = camera.elevation.sin_cos();
    let back = Vec3::new(sin_a * cos_e, sin_e, cos_a * cos_e);
    let right = Vec3::new(cos_a, 0.0, -sin_a);
    [right, back.cross(right), back]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_are_orthonormal_and_right_handed() {
        let camera = CameraSection { azimuth: 0.7, elevation: -0.4, ..CameraSection::default() };
        let [right, up, back] = axes(&camera);
        assert!((right.cross(up) - back).length() < 1e-6);
        assert!((up.length() - 1.0).abs() < 1e-6 && up.y > 0.0);
    }

    #[test]
    fn a_pan_moves_by_what_the_picture_shows() {
        let mut camera = CameraSection { mode: CameraMode::Fixed, azimuth: 0.0, ..CameraSection::default() };
        camera.elevation = 0.0;
        let before = camera.fixed_target;
        pan(&mut camera, 0.0, 0.5, 0.0);
        let shown = 2.0 * camera.distance * (camera.fov_y * 0.5).tan();
        assert!((before.x - camera.fixed_target.x - 0.5 * shown).abs() < 1e-5);
    }

    #[test]
    fn a_turntable_turns_what_a_pan_moves_along() {
        let mut camera = CameraSection { mode: CameraMode::Fixed, azimuth: 0.0, ..CameraSection::default() };
        (camera.elevation, camera.turntable, camera.turn_secs) = (0.0, true, 8.0);
        let before = camera.fixed_target;
        pan(&mut camera, 2.0, 0.5, 0.0);
        let moved = camera.fixed_target - before;
        assert!(moved.x.abs() < 1e-4 && moved.z.abs() > 0.1, "a quarter of a turn: {moved}");
    }

    #[test]
    fn nothing_leaves_its_range() {
        let mut camera = CameraSection::default();
        for _ in 0..100 {
            orbit(&mut camera, 3.7, 9.0);
            zoom(&mut camera, 0.2);
            pan(&mut camera, 3.0, 50.0, -50.0);
        }
        zoom(&mut camera, f32::NAN);
        assert!(camera.azimuth.abs() <= std::f32::consts::PI + 1e-5);
        assert_eq!((camera.elevation, camera.distance), (1.5, 0.1));
        assert!(camera.follow_offset.abs().max_element() <= 3.0);
    }
}
