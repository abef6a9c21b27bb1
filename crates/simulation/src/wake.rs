//! Shelter from the wind: hair downwind of the body is in its wake.
//!
//! A ray is traced upwind from each point. Where it passes through a collider, the point is in that
//! collider's wake: fully sheltered directly behind it, less so further away, and not at all beside it or in
//! front. Let `x` be the smallest distance between the ray and the collider's axis in radii, reached `s`
//! metres upwind, and `r` the radius. The collider then lets through `1 - w(x) b(s / r) f(s / r)`: `w` falls
//! from 1 to 0 between 0.7 and 1.2 radii, `b` rises from 0 in front and beside to 1 behind, and `f` is the
//! recovery of the wake over [`LENGTH`] radii. The factors of all colliders are multiplied.

use glam::{Affine3A, Vec3};
use lovelock_groom::Scalp;
use lovelock_motion::ColliderShape;

use crate::colliders::boxes::bounds;
use crate::colliders::shape::Shape;
use crate::lanes::{LANES, Lane, Lane3, at, greater, lesser};

/// Length of a wake, in radii of the collider.
const LENGTH: f32 = 10.0;

/// The constants of wakes by name, for other devices.
pub(crate) const CONSTANTS: [(&str, f64); 1] = [("WAKE_LENGTH", LENGTH as f64)];

/// The wakes of all colliders at one instant, in working space.
#[derive(Clone, Debug, Default)]
pub(crate) struct Wakes {
    /// Unit vector against the wind.
    upwind: Vec3,
    /// Fraction of the wind that a wake removes, 0 to 1.
    strength: f32,
    solids: Vec<Solid>,
}

/// A collider as an obstacle to the wind.
#[derive(Clone, Copy, Debug)]
struct Solid {
    shape: Shape,
    centre: Vec3,
    /// Radius of its bounding sphere, metres.
    reach: f32,
}

/// The head as an obstacle to the wind when it is part of a distance field and not a collider: the ellipsoid
/// in the bounding box of its surface, at the transform `head`. `None` if it has no surface.
pub(crate) fn head_of(scalp: &Scalp, head: &Affine3A) -> Option<Shape> {
    let low = scalp.positions.iter().fold(Vec3::INFINITY, |low, p| low.min(*p));
    let high = scalp.positions.iter().fold(Vec3::NEG_INFINITY, |high, p| high.max(*p));
    let box_of = Affine3A::from_translation(0.5 * (low + high)) * Affine3A::from_scale(0.5 * (high - low));
    Shape::new(&ColliderShape::Ellipsoid { from_unit: *head * box_of })
}

impl Wakes {
    /// Prepares the wakes of `shapes` in a wind along `along`; a `strength` of 0 gives none.
    pub(crate) fn new(shapes: impl Iterator<Item = Shape>, along: Vec3, strength: f32) -> Self {
        let Some(along) = along.try_normalize().filter(|_| strength > 0.0) else { return Self::default() };
        let solid = |shape: Shape| {
            let (min, max) = shape.bounds();
            Solid { shape, centre: 0.5 * (min + max), reach: 0.5 * (max - min).length() }
        };
        Self { upwind: -along, strength, solids: shapes.map(solid).collect() }
    }

    /// Appends the direction against the wind and the strength, then each solid by `put` with its centre and reach. Returns the
    /// number of solids.
    pub(crate) fn write(&self, out: &mut Vec<f32>, put: impl Fn(&mut Vec<f32>, Vec3, f32, &Shape)) -> u32 {
        out.extend(self.upwind.to_array());
        out.push(self.strength);
        for solid in &self.solids {
            put(out, solid.centre, solid.reach, &solid.shape);
        }
        self.solids.len() as u32
    }

    /// The fraction of the wind that reaches each lane of a row of points.
    #[inline(always)]
    pub(crate) fn exposure(&self, points: &Lane3) -> Lane {
        let mut open = Lane::splat(1.0);
        if self.solids.is_empty() {
            return open;
        }
        let (min, max) = bounds(points);
        let (middle, reach) = (0.5 * (min + max), 0.5 * (max - min).length());
        for solid in &self.solids {
            let ahead = solid.centre - middle;
            let s = ahead.dot(self.upwind);
            let (aside, near) = ((ahead - self.upwind * s).length(), 1.2 * solid.reach + reach);
            if s < -near || s > near + LENGTH * solid.reach || aside > near {
                continue;
            }
            for k in 0..LANES {
                let (x, s, radius) = solid.ray_distance(at(points, k), self.upwind);
                let within = smooth((1.2 - x) * 2.0);
                let behind = smooth(s / (0.6 * radius));
                let fades = greater(1.0 - s / (LENGTH * radius), 0.0);
                open[k] *= 1.0 - within * behind * fades;
            }
        }
        for share in open.iter_mut() {
            *share = 1.0 - self.strength * (1.0 - *share);
        }
        open
    }
}

impl Solid {
    /// Smallest distance between the ray from `p` along the unit vector `u` and the axis, in radii; the
    /// distance along the ray; and the radius there.
    #[inline(always)]
    fn ray_distance(&self, p: Vec3, u: Vec3) -> (f32, f32, f32) {
        match self.shape {
            Shape::Capsule { a, axis, inv_axis_squared, radius_a, radius_change, .. } => {
                // Closest points of a ray and a segment (Ericson, Real-Time Collision Detection, 5.1.9).
                let r = p - a;
                let (b, c, f, e) = (u.dot(axis), u.dot(r), axis.dot(r), axis.dot(axis));
                let cross = e - b * b;
                let s = greater((b * f - c * e) / (cross + 1e-9), 0.0);
                let t = lesser(greater((b * s + f) * inv_axis_squared, 0.0), 1.0);
                let s = greater(b * t - c, 0.0);
                let radius = radius_a + t * radius_change;
                ((r + u * s - axis * t).length_squared().sqrt() / (radius + 1e-6), s, radius + 1e-6)
            }
            Shape::Ellipsoid { centre, axes: [ax, ay, az], radii, .. } => {
                let (r, inv) = (p - centre, 1.0 / radii);
                let q = Vec3::new(r.dot(ax), r.dot(ay), r.dot(az)) * inv;
                let v = Vec3::new(u.dot(ax), u.dot(ay), u.dot(az)) * inv;
                let s = greater(-q.dot(v) / v.length_squared(), 0.0);
                let radius = 1.0 / v.length_squared().sqrt();
                ((q + v * s).length_squared().sqrt(), s, radius)
            }
        }
    }
}

/// Smoothstep from 0 at 0 to 1 at 1.
#[inline(always)]
fn smooth(t: f32) -> f32 {
    let t = lesser(greater(t, 0.0), 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn solid(shape: &ColliderShape) -> Shape {
        Shape::new(shape).expect("a shape")
    }

    /// A head, as an ellipsoid and as a capsule.
    fn heads() -> [Shape; 2] {
        let round = Affine3A::from_scale(Vec3::new(0.08, 0.11, 0.1));
        let (a, b) = (Vec3::Y * 0.03, Vec3::Y * -0.03);
        [
            solid(&ColliderShape::Ellipsoid { from_unit: round }),
            solid(&ColliderShape::Capsule { a, b, radius_a: 0.08, radius_b: 0.08 }),
        ]
    }

    fn open(wakes: &Wakes, p: Vec3) -> f32 {
        wakes.exposure(&crate::lanes::splat3(p))[0]
    }

    #[test]
    fn the_head_shelters_points_behind_it_only() {
        for head in heads() {
            let wakes = Wakes::new([head].into_iter(), Vec3::X * 5.0, 1.0);
            assert!(open(&wakes, Vec3::X * 0.1) < 0.2, "right behind: {}", open(&wakes, Vec3::X * 0.1));
            let further = open(&wakes, Vec3::X * 0.5);
            assert!(further > 0.4 && further < 0.9, "further behind: {further}");
            for p in [Vec3::X * -0.1, Vec3::X * -0.5, Vec3::Z * 0.15, Vec3::Y * 0.2, Vec3::X * 2.0] {
                assert_eq!(open(&wakes, p), 1.0, "at {p}");
            }
            // The wind direction decides which side is sheltered.
            let other = Wakes::new([head].into_iter(), Vec3::NEG_X, 1.0);
            assert!(open(&other, Vec3::X * -0.1) < 0.2 && open(&other, Vec3::X * 0.1) == 1.0);
        }
    }

    #[test]
    fn shelter_fades_smoothly_and_scales_with_its_strength() {
        let [head, _] = heads();
        let wakes = Wakes::new([head].into_iter(), Vec3::X, 1.0);
        let mut last = open(&wakes, Vec3::new(0.12, 0.0, -0.2));
        for i in 0..400 {
            let now = open(&wakes, Vec3::new(0.12, 0.0, -0.2 + 0.001 * i as f32));
            assert!((now - last).abs() < 0.04, "a jump of {} in a millimetre", now - last);
            last = now;
        }
        let (full, half) = (open(&wakes, Vec3::X * 0.15), Vec3::X * 0.15);
        let half = open(&Wakes::new([head].into_iter(), Vec3::X, 0.5), half);
        assert!((1.0 - half - 0.5 * (1.0 - full)).abs() < 1e-6);
        assert_eq!(open(&Wakes::new([head].into_iter(), Vec3::X, 0.0), Vec3::X * 0.15), 1.0);
        assert_eq!(open(&Wakes::new([head].into_iter(), Vec3::ZERO, 1.0), Vec3::X * 0.15), 1.0);
    }
}
