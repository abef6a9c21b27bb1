//! The camera at a time of the scene, and framing.

use glam::{Vec2, Vec3};
use lovelock_project::project::{CameraMode, CameraSection};
use lovelock_render::Camera;

use super::Scene;

/// The camera of a project at a time of the scene. It depends only on its arguments.
pub fn camera_at(section: &CameraSection, scene: &Scene, time_secs: f64) -> Camera {
    let section = &section.turned(time_secs);
    let target = target(section, scene, time_secs);
    Camera {
        eye: target + from_target(section) * section.distance,
        target,
        fov_y: section.fov_y,
        shear: Vec2::ZERO,
    }
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

/// Bodies whose heads differ in size by this factor or more do not share a camera.
const OTHER_SIZE: f32 = 2.0;

/// The camera for another body, if its head has another size than the one before: target and distance are those of a new project in
/// the size of the body, direction and field of view stay. Sizes are multiples of that of the shipped dancer's head
/// ([`Scene::hair_scale`]).
pub fn camera_for_size(section: &CameraSection, before: f32, scale: f32) -> Option<CameraSection> {
    let ratio = scale / before;
    if !(ratio.is_finite() && scale > 0.0) || (1.0 / OTHER_SIZE < ratio && ratio < OTHER_SIZE) {
        return None;
    }
    let new = CameraSection::default();
    let sized = CameraSection {
        mode: new.mode,
        follow_offset: new.follow_offset * scale,
        distance: new.distance * scale,
        ..*section
    };
    let [nearest, farthest] = DISTANCES;
    Some(CameraSection {
        follow_offset: sized.follow_offset.clamp(Vec3::splat(-3.0), Vec3::splat(3.0)),
        distance: sized.distance.clamp(nearest, farthest),
        ..sized
    })
}

/// The distances that framing chooses, metres.
const DISTANCES: [f32; 2] = [0.1, 30.0];

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
    framed.distance = (1.05 * radius / half_angle.sin().max(0.01)).clamp(DISTANCES[0], DISTANCES[1]);
    match section.mode {
        CameraMode::Follow => {
            let offset = center - (target(section, scene, time_secs) - section.follow_offset);
            framed.follow_offset = offset.clamp(Vec3::splat(-3.0), Vec3::splat(3.0));
        }
        CameraMode::Fixed => framed.fixed_target = center.clamp(Vec3::splat(-20.0), Vec3::splat(20.0)),
    }
    framed
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_of_another_size_has_the_camera_of_a_new_project_in_its_size() {
        let new = CameraSection::default();
        let turned = CameraSection { azimuth: 2.0, distance: 0.7, mode: CameraMode::Fixed, ..new };
        for (before, scale) in [(1.0, 8.0), (4.0, 1.0), (8.0, 0.5)] {
            let framed = camera_for_size(&turned, before, scale).expect("another size");
            assert!((framed.distance - scale * new.distance).abs() < 1e-6, "{framed:?}");
            assert!(framed.follow_offset.abs_diff_eq(scale * new.follow_offset, 1e-6), "{framed:?}");
            assert_eq!((framed.mode, framed.azimuth, framed.fov_y), (new.mode, 2.0, new.fov_y));
        }
        // The distance is one that the controls have.
        assert_eq!(camera_for_size(&new, 1.0, 40.0).expect("another size").distance, 30.0);
        // Controls: a body of about the same size, and sizes that are none.
        for (before, scale) in [(1.0, 1.0), (1.0, 1.7), (1.6, 1.0), (8.0, 8.0), (1.0, f32::NAN), (0.0, 0.0)] {
            assert_eq!(camera_for_size(&turned, before, scale), None, "{before} to {scale}");
        }
    }
}
