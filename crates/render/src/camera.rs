//! The camera.

use glam::{Mat4, Vec2, Vec3, Vec4, camera::rh};

/// Distance of the near plane, metres: closer than any view of a head needs.
pub(crate) const NEAR_METRES: f32 = 0.02;

/// A pinhole camera. Many of them, at places of an aperture, make a lens: see [`Camera::through`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The position, world space, metres.
    pub eye: Vec3,
    /// The point that the camera looks at, world space, metres. Must differ from `eye`.
    pub target: Vec3,
    /// Vertical field of view, radians, between 0 and π.
    pub fov_y: f32,
    /// Shear of the view: rightward and upward shift of the image of a point per metre of its distance along the axis, metres. 0 for a camera
    /// in the middle of its lens.
    pub shear: Vec2,
}

impl Camera {
    /// The transform from world space to view space, which is right-handed and looks along -Z.
    pub fn view_from_world(&self) -> Mat4 {
        let forward = (self.target - self.eye).normalize_or(Vec3::NEG_Z);
        let up = if forward.y.abs() > 0.999 { Vec3::Z } else { Vec3::Y };
        rh::view::look_at_mat4(self.eye, self.eye + forward, up)
    }

    /// The transform from world space to clip space. Depth is 1 at the near plane and falls to 0 at infinity.
    pub fn clip_from_world(&self, aspect: f32) -> Mat4 {
        let fov_y = self.fov_y.clamp(0.01, 3.0);
        let perspective =
            rh::proj::directx::perspective_infinite_reverse(fov_y, aspect.max(1e-3), NEAR_METRES);
        if self.shear == Vec2::ZERO {
            return perspective * self.view_from_world();
        }
        // The view looks along -Z.
        let sheared =
            Mat4::from_cols(Vec4::X, Vec4::Y, Vec4::new(-self.shear.x, -self.shear.y, 1.0, 0.0), Vec4::W);
        perspective * sheared * self.view_from_world()
    }

    /// The camera at a place of its aperture, `offset` metres to the right and upward of the middle of the lens.
    ///
    /// The image is sheared so that everything at the distance `focus` along the axis, metres, stays where it is. A point at the distance z
    /// moves by offset · (1/focus − 1/z) at the distance 1: the circle of confusion of a thin lens.
    #[must_use]
    pub fn through(&self, offset: Vec2, focus: f32) -> Self {
        let rows = self.view_from_world().transpose();
        let moved = offset.x * rows.x_axis.truncate() + offset.y * rows.y_axis.truncate();
        let shear = self.shear + offset / focus.max(NEAR_METRES);
        Self { eye: self.eye + moved, target: self.target + moved, shear, ..*self }
    }

    /// The camera turned so that everything moves by `pixels` to the left and up in an image `height` pixels high: exactly in the middle,
    /// and by a little more toward the edges. For fractions of a pixel.
    #[must_use]
    pub fn moved_by_pixels(&self, pixels: Vec2, height: u32) -> Self {
        let rows = self.view_from_world().transpose();
        let (right, up) = (rows.x_axis.truncate(), rows.y_axis.truncate());
        let distance = self.eye.distance(self.target);
        let metres = pixels * distance / self.pixels_per_metre_at_one_metre(height);
        Self { target: self.target + metres.x * right - metres.y * up, ..*self }
    }

    /// Pixels per metre at a distance of one metre, for an image `height` pixels high.
    pub fn pixels_per_metre_at_one_metre(&self, height: u32) -> f32 {
        height as f32 * 0.5 / (self.fov_y.clamp(0.01, 3.0) * 0.5).tan()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_is_one_at_the_near_plane_and_falls() {
        let camera = Camera {
            eye: Vec3::new(0.0, 1.0, 2.0),
            target: Vec3::new(0.0, 1.0, 0.0),
            fov_y: 0.6,
            shear: glam::Vec2::ZERO,
        };
        let clip = camera.clip_from_world(1.5);
        let depth = |z: f32| {
            let p = clip * Vec3::new(0.0, 1.0, 2.0 - z).extend(1.0);
            p.z / p.w
        };
        assert!((depth(NEAR_METRES) - 1.0).abs() < 1e-4);
        assert!(depth(1.0) > depth(2.0) && depth(2.0) > 0.0);
    }

    #[test]
    fn the_target_is_in_the_middle_and_the_fov_is_vertical() {
        let camera =
            Camera { eye: Vec3::new(1.0, 1.0, 2.0), target: Vec3::ZERO, fov_y: 0.5, shear: glam::Vec2::ZERO };
        let clip = camera.clip_from_world(2.0) * Vec3::ZERO.extend(1.0);
        assert!(clip.x.abs() < 1e-5 && clip.y.abs() < 1e-5);
        let level = Camera { eye: Vec3::Z, target: Vec3::ZERO, fov_y: 0.5, shear: glam::Vec2::ZERO };
        let top = level.clip_from_world(2.0) * Vec3::new(0.0, 0.25_f32.tan(), 0.0).extend(1.0);
        assert!((top.y / top.w - 1.0).abs() < 1e-5, "half the angle reaches the upper edge");
    }

    #[test]
    fn a_point_in_focus_stays_and_others_move_by_the_circle_of_confusion() {
        let camera = Camera {
            eye: Vec3::new(0.2, 1.5, 2.0),
            target: Vec3::new(0.1, 1.4, 0.0),
            fov_y: 0.37,
            shear: Vec2::ZERO,
        };
        let (height, focus, radius) = (720, 2.0, 0.02);
        let view = camera.view_from_world().inverse();
        let pixel = |camera: &Camera, depth: f32, beside: f32| {
            let p = view.transform_point3(Vec3::new(beside, -0.5 * beside, -depth));
            let clip = camera.clip_from_world(1.5).project_point3(p);
            Vec2::new(clip.x * 1.5, clip.y) * 0.5 * height as f32
        };
        for angle in [0.0, 1.0, 2.5, 4.0_f32] {
            let offset = radius * Vec2::from_angle(angle);
            let moved = camera.through(offset, focus);
            for beside in [0.0, 0.3] {
                let still = pixel(&moved, focus, beside) - pixel(&camera, focus, beside);
                assert!(still.length() < 0.01, "in focus: {still}");
                for depth in [1.0, 1.7, 2.4, 5.0] {
                    let by = pixel(&moved, depth, beside) - pixel(&camera, depth, beside);
                    let truth =
                        radius * (1.0 / focus - 1.0 / depth) * camera.pixels_per_metre_at_one_metre(height);
                    assert!((by - truth * Vec2::from_angle(angle)).length() < 0.02, "{depth}: {by} {truth}");
                }
            }
            // The control: a camera that only moves takes the point in focus along.
            let shifted = Camera { shear: Vec2::ZERO, ..moved };
            assert!((pixel(&shifted, focus, 0.0) - pixel(&camera, focus, 0.0)).length() > 10.0);
        }
    }

    #[test]
    fn a_camera_moves_by_pixels() {
        let camera =
            Camera { eye: Vec3::new(1.0, 1.0, 2.0), target: Vec3::ZERO, fov_y: 0.5, shear: glam::Vec2::ZERO };
        let moved = camera.moved_by_pixels(Vec2::new(0.5, -0.25), 100).clip_from_world(2.0) * Vec4::W;
        let pixels = Vec2::new(moved.x, -moved.y) / moved.w * Vec2::new(100.0, 50.0);
        assert!((pixels - Vec2::new(-0.5, 0.25)).length() < 1e-3, "{pixels}");
    }
}
