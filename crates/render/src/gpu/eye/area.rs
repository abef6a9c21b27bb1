//! The area of a picture that may contain hair.

use glam::Vec3;
use lovelock_shadow::LightFrame;

use crate::Camera;

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::gpu) struct Area {
    pub left: u32,
    pub top: u32,
    pub columns: u32,
    pub rows: u32,
}

impl Area {
    pub fn pixels(self) -> u64 {
        u64::from(self.columns) * u64::from(self.rows)
    }

    /// Left, top, right and bottom.
    pub fn edges(self) -> [f32; 4] {
        [self.left, self.top, self.left + self.columns, self.top + self.rows].map(|edge| edge as f32)
    }

    /// The bounding rectangle of both.
    pub fn with(self, other: Self) -> Self {
        if self.is_empty() || other.is_empty() {
            return if self.is_empty() { other } else { self };
        }
        let (left, top) = (self.left.min(other.left), self.top.min(other.top));
        let right = (self.left + self.columns).max(other.left + other.columns);
        let bottom = (self.top + self.rows).max(other.top + other.rows);
        Self { left, top, columns: right - left, rows: bottom - top }
    }

    /// It with the rest of the cells of so many pixels along each edge that it touches, within a picture.
    pub fn widened(self, cell: u32, [width, height]: [u32; 2]) -> Self {
        let (left, top) = (self.left / cell * cell, self.top / cell * cell);
        let right = (self.left + self.columns).next_multiple_of(cell).min(width);
        let bottom = (self.top + self.rows).next_multiple_of(cell).min(height);
        Self { left, top, columns: right.saturating_sub(left), rows: bottom.saturating_sub(top) }
    }

    pub fn is_empty(self) -> bool {
        self.pixels() == 0
    }

    /// The axes of the bounds for [`Area::of`]: forward, and two perpendicular ones.
    pub fn axes(camera: &Camera) -> LightFrame {
        LightFrame::new(camera.target - camera.eye)
    }

    /// The area of a picture that contains points (world space). The whole picture if one is NaN or close to the eye.
    pub fn of_points(camera: &Camera, size: [u32; 2], points: &[Vec3]) -> Self {
        let axes = Self::axes(camera);
        let empty = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        let bounds = points.iter().try_fold(empty, |(low, high), &p| {
            let along = axes.light_from_world(p - camera.eye);
            along.is_finite().then(|| (low.min(along), high.max(along)))
        });
        Self::of(camera, size, bounds.unwrap_or((Vec3::NAN, Vec3::NAN)), 0.0)
    }

    /// The area of a picture that contains hair with the bounds `min` and `max` relative to the eye along the axes of [`Area::axes`],
    /// and with strands `width` wide; metres. The whole picture if hair is close to the eye.
    pub fn of(
        camera: &Camera,
        [width, height]: [u32; 2],
        (min, max): (Vec3, Vec3),
        strand_width: f32,
    ) -> Self {
        let whole = Self { left: 0, top: 0, columns: width, rows: height };
        if min.x > max.x {
            return Self::default();
        }
        // Nearer than this the width of a strand on the screen is unbounded.
        let nearest = min.x;
        if !(nearest > 0.05 && (max - min).is_finite()) {
            return whole;
        }
        let axes = Self::axes(camera);
        let clip = camera.clip_from_world(width as f32 / height as f32);
        let (mut low, mut high) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
        for corner in 0..8 {
            let pick = |bit: u32, low: f32, high: f32| if corner >> bit & 1 == 0 { low } else { high };
            let along = Vec3::new(pick(0, min.x, max.x), pick(1, min.y, max.y), pick(2, min.z, max.z));
            let ndc = clip.project_point3(camera.eye + axes.world_from_light(along));
            let pixel = [(ndc.x * 0.5 + 0.5) * width as f32, (0.5 - ndc.y * 0.5) * height as f32];
            for axis in 0..2 {
                low[axis] = low[axis].min(pixel[axis]);
                high[axis] = high[axis].max(pixel[axis]);
            }
        }
        // Half a strand, its soft edge, and rounding.
        let margin = 0.5 * strand_width * camera.pixels_per_metre_at_one_metre(height) / nearest + 3.0;
        if !(low.iter().chain(&high).all(|at| at.is_finite()) && margin.is_finite()) {
            return whole;
        }
        let clamped = |at: f32, most: u32| at.clamp(0.0, most as f32) as u32;
        let left = clamped((low[0] - margin).floor(), width);
        let top = clamped((low[1] - margin).floor(), height);
        let right = clamped((high[0] + margin).ceil(), width);
        let bottom = clamped((high[1] + margin).ceil(), height);
        Self { left, top, columns: right.saturating_sub(left), rows: bottom.saturating_sub(top) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera {
            eye: Vec3::new(0.3, 1.2, 2.0),
            target: Vec3::new(0.0, 1.0, 0.0),
            fov_y: 0.6,
            shear: glam::Vec2::ZERO,
        }
    }

    #[test]
    fn areas_are_put_together_and_widened_to_whole_cells() {
        let a = Area { left: 5, top: 9, columns: 10, rows: 3 };
        let b = Area { left: 12, top: 2, columns: 20, rows: 4 };
        let both = Area { left: 5, top: 2, columns: 27, rows: 10 };
        assert_eq!((a.with(b), b.with(a)), (both, both));
        assert_eq!((a.with(Area::default()), Area::default().with(a)), (a, a));
        assert_eq!(both.widened(4, [64, 48]), Area { left: 4, top: 0, columns: 28, rows: 12 });
        assert_eq!(both.widened(4, [31, 11]), Area { left: 4, top: 0, columns: 27, rows: 11 });
        assert!(Area::default().widened(4, [64, 48]).is_empty());
    }

    #[test]
    fn the_area_of_points_holds_them_and_is_the_picture_where_one_is_no_number() {
        let camera = camera();
        let points = [camera.target, camera.target + Vec3::new(0.1, 0.05, 0.02)];
        let area = Area::of_points(&camera, [640, 360], &points);
        assert_eq!(area, Area::of(&camera, [640, 360], bounds(&camera, &points), 0.0));
        assert!(!area.is_empty() && area.columns < 100, "{area:?}");
        let whole = Area { left: 0, top: 0, columns: 640, rows: 360 };
        let broken = [points[0], Vec3::new(f32::NAN, 0.0, 0.0), points[1]];
        assert_eq!(Area::of_points(&camera, [640, 360], &broken), whole);
        assert!(Area::of_points(&camera, [640, 360], &[]).is_empty());
    }

    /// Bounds of points for `Area::of`.
    fn bounds(camera: &Camera, points: &[Vec3]) -> (Vec3, Vec3) {
        let axes = Area::axes(camera);
        let along = points.iter().map(|&p| axes.light_from_world(p - camera.eye));
        along.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
    }

    #[test]
    fn every_point_lies_inside_and_the_area_is_no_larger_than_need_be() {
        let camera = camera();
        let points: Vec<Vec3> = (0..500)
            .map(|i| {
                let i = i as f32;
                Vec3::new(0.1 * (1.3 * i).sin(), 1.0 + 0.12 * (0.7 * i).cos(), 0.1 * (2.1 * i).sin())
            })
            .collect();
        let area = Area::of(&camera, [640, 360], bounds(&camera, &points), 1e-4);
        let clip = camera.clip_from_world(640.0 / 360.0);
        for &p in &points {
            let ndc = clip.project_point3(p);
            let (x, y) = ((ndc.x * 0.5 + 0.5) * 640.0, (0.5 - ndc.y * 0.5) * 360.0);
            assert!(x >= area.left as f32 && x <= (area.left + area.columns) as f32, "{x} {area:?}");
            assert!(y >= area.top as f32 && y <= (area.top + area.rows) as f32, "{y} {area:?}");
        }
        // 0.24 m of the 1.3 m that the picture shows at that distance, plus the depth of the box.
        assert!(area.rows < 130 && area.columns < 150, "{area:?}");
    }

    #[test]
    fn hair_near_the_eye_fills_the_picture_and_no_hair_none_of_it() {
        let camera = camera();
        let whole = Area { left: 0, top: 0, columns: 64, rows: 48 };
        let near = bounds(&camera, &[camera.eye + Vec3::splat(0.01), Vec3::ZERO]);
        assert_eq!(Area::of(&camera, [64, 48], near, 1e-4), whole);
        assert_eq!(Area::of(&camera, [64, 48], (Vec3::NAN, Vec3::NAN), 1e-4), whole);
        assert!(Area::of(&camera, [64, 48], bounds(&camera, &[]), 1e-4).is_empty());
        let beside = bounds(&camera, &[Vec3::new(50.0, 1.0, -10.0)]);
        assert!(Area::of(&camera, [64, 48], beside, 1e-4).is_empty());
    }
}
