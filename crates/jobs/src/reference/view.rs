//! Where the camera stands.

use glam::{Affine3A, Vec3, Vec4};
use lovelock_render::Camera;

/// Vertical field of view, radians.
const FOV_Y: f32 = 0.35;

/// From the hair to the camera, head space: from behind and the left, where hair covers the whole head and none of its inside shows.
const TOWARD_CAMERA: Vec3 = Vec3::new(0.75, 0.12, -0.65);

/// Part of the image's half width that the hair may take.
const FILL: f32 = 0.97;

/// The camera of a square image that `points` (world space, metres) fill.
pub(super) fn camera_for(points: &[Vec3], world_from_head: &Affine3A) -> Camera {
    let back = world_from_head.transform_vector3(TOWARD_CAMERA).normalize_or(Vec3::Z);
    let [right, up, back] =
        axes(&Camera { eye: back, target: Vec3::ZERO, fov_y: FOV_Y, shear: glam::Vec2::ZERO });
    let along = |axis: Vec3| {
        let [low, high] = points.iter().fold([f32::MAX, f32::MIN], |[low, high], p| {
            let at = p.dot(axis);
            [low.min(at), high.max(at)]
        });
        if low <= high { 0.5 * (low + high) } else { 0.0 }
    };
    let target = right * along(right) + up * along(up) + back * along(back);
    let slope = FILL * (0.5 * FOV_Y).tan();
    let distance = points.iter().fold(0.1, |distance: f32, p| {
        let d = *p - target;
        distance.max(d.dot(right).abs().max(d.dot(up).abs()) / slope + d.dot(back))
    });
    Camera { eye: target + back * distance, target, fov_y: FOV_Y, shear: glam::Vec2::ZERO }
}

/// The camera's axes in world space: right, up, and from the target to the camera.
pub(super) fn axes(camera: &Camera) -> [Vec3; 3] {
    let rows = camera.view_from_world().transpose();
    [rows.x_axis, rows.y_axis, rows.z_axis].map(Vec4::truncate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hair_fills_the_image_and_none_is_outside() {
        let points: Vec<Vec3> = (0..100)
            .map(|i| {
                Vec3::new(
                    (i as f32).sin() * 0.1,
                    1.6 + (i as f32 * 0.7).cos() * 0.2,
                    (i as f32 * 1.3).sin() * 0.1,
                )
            })
            .collect();
        let camera = camera_for(&points, &Affine3A::from_translation(Vec3::Y));
        let clip = camera.clip_from_world(1.0);
        let largest = points.iter().fold(0.0, |largest: f32, p| {
            let p = clip * p.extend(1.0);
            largest.max((p.x / p.w).abs()).max((p.y / p.w).abs())
        });
        assert!((0.9..=1.0).contains(&largest), "{largest}");
        let [right, up, back] = axes(&camera);
        assert!(right.cross(up).distance(back) < 1e-5 && up.y > 0.9);
    }
}
