//! The camera at a time of the scene, and framing.

use glam::Vec3;
use lovelock_project::project::{CameraMode, CameraSection};
use lovelock_render::Camera;

use super::Scene;

/// The camera of a project at a time of the scene. It depends only on its arguments.
pub fn camera_at(section: &CameraSection, scene: &Scene, time_secs: f64) -> Camera {
    let target = target(section, scene, time_secs);
    Camera { eye: target + from_target(section) * section.distance, target, fov_y: section.fov_y }
}

fn target(section: &CameraSection, scene: &Scene, time_secs: f64) -> Vec3 {
    match section.mode {
        CameraMode::Follow => {
            let window = f64::from(section.follow_secs) * scene.speed;
            scene.head_path.smoothed(scene.clip_secs(time_secs), window) + section.follow_offset
        }
        CameraMode::Fixed => section.fixed_target,
    }
}

/// Unit vector from the target to the camera.
fn from_target(section: &CameraSection) -> Vec3 {
    let (sin_a, cos_a) = section.azimuth.sin_cos();
    let (sin_e, cos_e) = section.elevation.sin_cos();
    Vec3::new(sin_a * cos_e, sin_e, cos_a * cos_e)
}

/// Changes target and distance so that `points` (world space, at a time of the scene) fill the image.
///
/// Direction and field of view stay. `aspect` is width divided by height.
pub fn frame_points(
    section: &CameraSection,
    scene: &Scene,
    time_secs: f64,
    points: impl Iterator<Item = Vec3>,
    aspect: f32,
) -> CameraSection {
    let (low, high) = points
        .filter(|p| p.is_finite())
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
    if low.cmpgt(high).any() {
        return *section;
    }
    let center = 0.5 * (low + high);
    let radius = (0.5 * (high - low).length()).max(0.02);
    let half_angle = 0.5 * section.fov_y * aspect.clamp(0.1, 1.0);
    let mut framed = *section;
    // The distance at which the bounding sphere touches the edges of the image, plus a small margin.
    framed.distance = (1.05 * radius / half_angle.sin().max(0.01)).clamp(0.1, 30.0);
    match section.mode {
        CameraMode::Follow => {
            let offset = center - (target(section, scene, time_secs) - section.follow_offset);
            framed.follow_offset = offset.clamp(Vec3::splat(-3.0), Vec3::splat(3.0));
        }
        CameraMode::Fixed => framed.fixed_target = center.clamp(Vec3::splat(-20.0), Vec3::splat(20.0)),
    }
    framed
}
