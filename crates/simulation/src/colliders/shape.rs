//! Nearest points on colliders, for a row of points at once.
//!
//! Every query returns a sphere that touches the surface at the nearest point, so one push-out serves all
//! shapes.

use glam::Vec3;
use lovelock_motion::ColliderShape;

use crate::lanes::{LANES, Lane, Lane3, ZERO, ZERO3, at, fold, greater, lesser, put};

/// A collider prepared for queries.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Shape {
    /// The hull of two spheres.
    Capsule {
        a: Vec3,
        axis: Vec3,
        inv_axis_squared: f32,
        /// Tangent of the cone's half angle divided by the axis' length: how far the surface normal leans.
        lean: f32,
        radius_a: f32,
        radius_change: f32,
    },
    /// An ellipsoid with its unit axes and radii.
    Ellipsoid {
        centre: Vec3,
        axes: [Vec3; 3],
        radii: Vec3,
        /// The axes divided by their radii: the map to the unit sphere.
        to_unit: [Vec3; 3],
        inv_least_radius: f32,
    },
}

/// The nearest surface for a row of points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    /// Centre of the touching sphere.
    pub(crate) centre: Lane3,
    /// Its radius.
    pub(crate) radius: Lane,
    /// Signed distance to the surface, negative inside.
    pub(crate) distance: Lane,
}

/// Newton iterations for the nearest point of an ellipsoid. They converge quadratically near the surface,
/// where hair is; far outside and deep inside, a bound on the first step leaves an error of at most 2 % of
/// the radius or the distance.
const ELLIPSOID_ROUNDS: usize = 4;

/// Tolerance of the conservative tests, metres, so that points on a surface never count as beyond it.
const ROUNDING: f32 = 1e-5;

/// The constants of shapes by name, for other devices.
pub(super) const CONSTANTS: [(&str, f64); 1] = [("ELLIPSOID_ROUNDS", ELLIPSOID_ROUNDS as f64)];

impl Shape {
    /// Prepares `shape`. A shape that is not finite or has no size gives `None`, and nothing collides with
    /// it.
    pub(crate) fn new(shape: &ColliderShape) -> Option<Self> {
        match *shape {
            ColliderShape::Capsule { a, b, radius_a, radius_b } => {
                if !(a.is_finite() && b.is_finite() && radius_a >= 0.0 && radius_b >= 0.0) {
                    return None;
                }
                if !(radius_a + radius_b).is_finite() || greater(radius_a, radius_b) <= 0.0 {
                    return None;
                }
                let length = (b - a).length();
                let change = radius_b - radius_a;
                if length <= change.abs() * 1.0001 + 1e-6 {
                    // One sphere contains the other.
                    let (a, radius_a) = if change > 0.0 { (b, radius_b) } else { (a, radius_a) };
                    return Some(Self::Capsule {
                        a,
                        axis: Vec3::ZERO,
                        inv_axis_squared: 0.0,
                        lean: 0.0,
                        radius_a,
                        radius_change: 0.0,
                    });
                }
                let sine = -change / length;
                Some(Self::Capsule {
                    a,
                    axis: b - a,
                    inv_axis_squared: 1.0 / (length * length),
                    lean: sine / (1.0 - sine * sine).sqrt() / length,
                    radius_a,
                    radius_change: change,
                })
            }
            ColliderShape::Ellipsoid { from_unit } => {
                let columns = [from_unit.x_axis, from_unit.y_axis, from_unit.z_axis].map(Vec3::from);
                let radii = Vec3::from(columns.map(Vec3::length));
                if !(from_unit.is_finite() && radii.is_finite() && radii.min_element() > 1e-5) {
                    return None;
                }
                let axes = [columns[0] / radii.x, columns[1] / radii.y, columns[2] / radii.z];
                let to_unit = [axes[0] / radii.x, axes[1] / radii.y, axes[2] / radii.z];
                let inv_least_radius = 1.0 / radii.min_element();
                let centre = from_unit.translation.into();
                Some(Self::Ellipsoid { centre, axes, radii, to_unit, inv_least_radius })
            }
        }
    }

    /// The bounding box.
    pub(crate) fn bounds(&self) -> (Vec3, Vec3) {
        match *self {
            Self::Capsule { a, axis, radius_a, radius_change, .. } => {
                let (b, radius_b) = (a + axis, radius_a + radius_change);
                let (ra, rb) = (Vec3::splat(radius_a), Vec3::splat(radius_b));
                ((a - ra).min(b - rb), (a + ra).max(b + rb))
            }
            Self::Ellipsoid { centre, axes, radii, .. } => {
                let [x, y, z] = axes;
                let (x, y, z) = (x * radii.x, y * radii.y, z * radii.z);
                let half = (x * x + y * y + z * z).map(f32::sqrt);
                (centre - half, centre + half)
            }
        }
    }

    /// Whether every lane of `points` is certainly further away than `reach`; cheaper than computing the
    /// distance.
    #[inline(always)]
    pub(crate) fn surely_beyond(&self, points: &Lane3, reach: f32) -> bool {
        // NaN counts as far.
        let mut squared = ZERO;
        let within = match *self {
            // As if the whole capsule were as wide as its wider end.
            Self::Capsule { a, axis, inv_axis_squared, radius_a, radius_change, .. } => {
                for k in 0..LANES {
                    let q = at(points, k) - a;
                    let t = lesser(greater(q.dot(axis) * inv_axis_squared, 0.0), 1.0);
                    squared[k] = lesser(f32::MAX, (q - t * axis).length_squared());
                }
                radius_a + greater(radius_change, 0.0) + reach + ROUNDING
            }
            // For points outside, the ellipsoid scaled by 1 + reach / (smallest radius) contains everything
            // within reach, up to 2e-8 m of rounding.
            Self::Ellipsoid { centre, to_unit, inv_least_radius, .. } => {
                for k in 0..LANES {
                    let q = in_units(at(points, k) - centre, &to_unit);
                    squared[k] = lesser(f32::MAX, q.length_squared());
                }
                1.0 + reach * inv_least_radius
            }
        };
        fold(squared, lesser) > within * within
    }

    /// The same with a reach per lane. Only ellipsoids have a cheap test; for capsules it returns false.
    #[inline(always)]
    pub(crate) fn each_surely_beyond(&self, points: &Lane3, reach: &Lane) -> bool {
        let Self::Ellipsoid { centre, to_unit, inv_least_radius, .. } = *self else { return false };
        let mut beyond = true;
        for k in 0..LANES {
            let within = 1.0 + (greater(reach[k], 0.0) + ROUNDING) * inv_least_radius;
            let squared = in_units(at(points, k) - centre, &to_unit).length_squared();
            // NaN counts as far.
            beyond &= (squared > within * within) | squared.is_nan();
        }
        beyond
    }

    /// The nearest point for every lane of `points`. `along` is the direction in which a push-out may move
    /// each point; the touching sphere of an ellipsoid has the curvature of its surface in that direction.
    #[inline(always)]
    pub(crate) fn nearest(&self, points: &Lane3, along: &Lane3) -> Nearest {
        let mut out = Nearest { centre: ZERO3, radius: ZERO, distance: ZERO };
        match *self {
            Self::Capsule { a, axis, inv_axis_squared, lean, radius_a, radius_change } => {
                for k in 0..LANES {
                    let q = at(points, k) - a;
                    let t = q.dot(axis) * inv_axis_squared;
                    let across = (q - t * axis).length_squared().sqrt();
                    let t = lesser(greater(t - across * lean, 0.0), 1.0);
                    let centre = t * axis;
                    let radius = radius_a + t * radius_change;
                    out.distance[k] = (q - centre).length_squared().sqrt() - radius;
                    out.radius[k] = radius;
                    put(&mut out.centre, k, centre + a);
                }
            }
            Self::Ellipsoid { centre, axes: [ax, ay, az], radii, .. } => {
                let squared = radii * radii;
                let inv_squared = 1.0 / squared;
                let edge = -0.98 * lesser(squared.x, lesser(squared.y, squared.z));
                for k in 0..LANES {
                    let world = at(points, k) - centre;
                    let q = Vec3::new(world.dot(ax), world.dot(ay), world.dot(az));
                    // The nearest point is s = r^2 q / (r^2 + t) with sum (s / r)^2 = 1. No term of the sum may
                    // exceed 1, which bounds t from below; without the bound deep points leave the range in which
                    // Newton's steps are of use.
                    let least = q.abs() * radii - squared;
                    let least = greater(edge, greater(least.x, greater(least.y, least.z)));
                    let mut t = greater(least, 0.0);
                    for _ in 0..ELLIPSOID_ROUNDS {
                        let g = 1.0 / (squared + t);
                        let s = q * g;
                        let terms = s * s * squared;
                        let value = terms.x + terms.y + terms.z - 1.0;
                        let slope = 2.0 * terms.dot(g);
                        t = greater(t + value / (slope + 1e-12), least);
                    }
                    let s = q * squared * (1.0 / (squared + t));
                    let gradient = s * inv_squared;
                    let steepness = gradient.length_squared().sqrt();
                    let normal = gradient * (1.0 / (steepness + 1e-20));
                    let distance = (q - s).dot(normal);
                    // Curvature of the surface in the direction of motion (Euler's formula).
                    let d = at(along, k);
                    let d = Vec3::new(d.dot(ax), d.dot(ay), d.dot(az));
                    let tangent = d - normal * d.dot(normal);
                    let size = tangent.length_squared();
                    let bend = (tangent * tangent).dot(inv_squared);
                    let sure = size > 1e-8;
                    let curvature = if sure { bend } else { inv_squared.x }
                        / (steepness * if sure { size } else { 1.0 } + 1e-20);
                    let radius = lesser(1.0 / (curvature + 1e-6), 10.0);
                    let c = q - normal * (distance + radius);
                    out.distance[k] = distance;
                    out.radius[k] = radius;
                    put(&mut out.centre, k, centre + c.x * ax + c.y * ay + c.z * az);
                }
            }
        }
        out
    }

    #[cfg(test)]
    /// Signed distance of one point.
    pub(crate) fn distance(&self, p: Vec3) -> f32 {
        let row = crate::lanes::splat3(p);
        self.nearest(&row, &ZERO3).distance[0]
    }
}

/// `q` in the units of an ellipsoid's axes.
#[inline(always)]
fn in_units(q: Vec3, [x, y, z]: &[Vec3; 3]) -> Vec3 {
    Vec3::new(q.dot(*x), q.dot(*y), q.dot(*z))
}

#[cfg(test)]
mod tests {
    use glam::{Affine3A, Quat};

    use super::*;

    fn capsule(radius_a: f32, radius_b: f32) -> Shape {
        let (a, b) = (Vec3::new(0.1, 0.0, 0.0), Vec3::new(0.1, 0.5, 0.0));
        Shape::new(&ColliderShape::Capsule { a, b, radius_a, radius_b }).expect("a capsule")
    }

    #[test]
    fn a_capsule_measures_from_its_axis() {
        let c = capsule(0.1, 0.1);
        assert!((c.distance(Vec3::new(0.4, 0.25, 0.0)) - 0.2).abs() < 1e-6);
        assert!((c.distance(Vec3::new(0.1, 0.8, 0.0)) - 0.2).abs() < 1e-6);
        assert!((c.distance(Vec3::new(0.13, 0.25, 0.0)) + 0.07).abs() < 1e-6);
    }

    #[test]
    fn a_tapered_capsule_is_the_hull_of_its_spheres() {
        // The distance to the hull is the smallest distance to any sphere between its ends.
        let c = capsule(0.15, 0.05);
        for p in [Vec3::new(0.5, 0.2, 0.1), Vec3::new(0.2, 0.45, 0.0), Vec3::new(0.0, -0.3, 0.2)] {
            let brute = (0..=10_000)
                .map(|i| {
                    let t = i as f32 / 10_000.0;
                    (p - Vec3::new(0.1, 0.5 * t, 0.0)).length() - (0.15 - 0.1 * t)
                })
                .fold(f32::INFINITY, f32::min);
            assert!((c.distance(p) - brute).abs() < 1e-6, "{} against {brute}", c.distance(p));
        }
    }

    #[test]
    fn one_sphere_inside_the_other_is_a_sphere() {
        let (a, b) = (Vec3::ZERO, Vec3::new(0.01, 0.0, 0.0));
        let c =
            Shape::new(&ColliderShape::Capsule { a, b, radius_a: 0.2, radius_b: 0.05 }).expect("a sphere");
        assert!((c.distance(Vec3::new(0.0, 0.5, 0.0)) - 0.3).abs() < 1e-6);
    }

    fn ellipsoid() -> Shape {
        let from_unit = Affine3A::from_scale_rotation_translation(
            Vec3::new(0.078, 0.115, 0.098),
            Quat::from_rotation_z(0.4),
            Vec3::new(0.0, 0.1, 0.02),
        );
        Shape::new(&ColliderShape::Ellipsoid { from_unit }).expect("an ellipsoid")
    }

    #[test]
    fn ellipsoid_distances_are_along_the_normal() {
        // Points at a known distance from the surface, along its normal.
        let Shape::Ellipsoid { centre, axes, radii, .. } = ellipsoid() else { unreachable!() };
        for i in 0..200 {
            let (u, v) = (i as f32 * 0.37, i as f32 * 0.73);
            let unit = Vec3::new(u.sin() * v.cos(), u.sin() * v.sin(), u.cos());
            let normal = (unit / radii).normalize_or_zero();
            for distance in [-0.01, 0.0, 0.003, 0.02] {
                let q = unit * radii + normal * distance;
                let p = centre + axes[0] * q.x + axes[1] * q.y + axes[2] * q.z;
                let found = ellipsoid().distance(p);
                assert!((found - distance).abs() < 1e-5, "found {found}, expected {distance}");
            }
        }
    }

    /// The `i`-th of many directions.
    fn direction(i: usize) -> Vec3 {
        let (u, v) = (i as f32 * 0.37, i as f32 * 0.73);
        Vec3::new(u.sin() * v.cos(), u.sin() * v.sin(), u.cos())
    }

    /// A row with lane `i` (modulo the number of lanes) at `p`; the other lanes are far away or NaN.
    fn alone(p: Vec3, i: usize) -> Lane3 {
        let mut row = crate::lanes::splat3(if i.is_multiple_of(2) { Vec3::splat(9.0) } else { Vec3::NAN });
        put(&mut row, i % LANES, p);
        row
    }

    #[test]
    fn the_conservative_test_never_misses_a_point_within_reach() {
        let middle = [Vec3::new(0.0, 0.1, 0.02), Vec3::new(0.1, 0.25, 0.0), Vec3::new(0.1, 0.25, 0.0)];
        let shapes = [(ellipsoid(), 0.012), (capsule(0.1, 0.07), 0.003), (capsule(0.07, 0.1), 0.003)];
        for ((shape, reach), middle) in shapes.into_iter().zip(middle) {
            let (mut sure, mut near, mut in_vain) = (0, 0, 0);
            for i in 0..3000 {
                let p = middle + direction(i) * (0.07 + 0.000_06 * i as f32);
                let (beyond, within) = (shape.surely_beyond(&alone(p, i), reach), shape.distance(p) < reach);
                assert!(!(beyond && within), "{p} is beyond {shape:?}");
                (sure, near) = (sure + usize::from(beyond), near + usize::from(within));
                in_vain += usize::from(!beyond && !within);
            }
            assert!(sure > 500 && near > 500, "{sure} beyond, {near} within: too few to show anything");
            // Measured: 31, and 291 and 276 because of the taper of the capsules.
            assert!(in_vain < 320, "{in_vain} of 3000 are tested in vain");
        }
        // Points on the surface, where contacts leave them, are not beyond it.
        let on = Vec3::new(0.1 + 0.1 + 0.003 + 1e-6, 0.0, 0.0);
        assert!(!capsule(0.1, 0.07).surely_beyond(&alone(on, 3), 0.003));
    }

    #[test]
    fn the_test_per_lane_never_misses_a_point_within_reach() {
        let e = ellipsoid();
        let (mut sure, mut near) = (0, 0);
        for i in 0..3000 {
            let p = Vec3::new(0.0, 0.1, 0.02) + direction(i) * (0.07 + 0.000_03 * i as f32);
            // All lanes are at the same place; all but one have a negative reach.
            let (odd, reach) = (i % LANES, 0.000_01 * (i % 2000) as f32 - 0.002);
            let mut reaches = Lane::splat(-1.0);
            reaches[odd] = reach;
            let (beyond, distance) =
                (e.each_surely_beyond(&crate::lanes::splat3(p), &reaches), e.distance(p));
            assert!(!(beyond && distance < reach), "{p} is {distance} off, not {reach}");
            (sure, near) = (sure + usize::from(beyond), near + usize::from(distance < reach));
        }
        assert!(sure > 500 && near > 500, "{sure} beyond, {near} within: too few to show anything");
        // Points within reach up to rounding, at the end of the shortest axis, where the bound is tight.
        let Shape::Ellipsoid { centre, axes, radii, .. } = e else { unreachable!() };
        let at_end = |further: f32| centre + axes[0] * (radii.x + 0.004 + further);
        assert!(!e.each_surely_beyond(&alone(at_end(1e-6), 5), &Lane::splat(0.004)));
        assert!(e.each_surely_beyond(&alone(at_end(1e-4), 5), &Lane::splat(0.004)));
        assert!(!capsule(0.1, 0.1).each_surely_beyond(&crate::lanes::splat3(Vec3::ONE), &ZERO));
        assert!(e.each_surely_beyond(&crate::lanes::splat3(Vec3::NAN), &ZERO), "NaN counts as far");
    }

    #[test]
    fn ellipsoids_measure_deep_and_far_points() {
        let sphere = Affine3A::from_scale(Vec3::splat(0.1));
        let sphere = Shape::new(&ColliderShape::Ellipsoid { from_unit: sphere }).expect("a sphere");
        for i in 0..200 {
            for radius in [0.01_f32, 0.03, 0.05, 0.09, 0.3, 1.2, 40.0] {
                let found = sphere.distance(direction(i) * radius);
                let tolerance = if radius == 0.09 { 1e-5 } else { 0.01 * radius.max(0.1) };
                assert!(
                    (found - (radius - 0.1)).abs() < tolerance,
                    "found {found} at {radius} from the centre"
                );
            }
        }
        // A flat one as fitted to an animal: points a metre away, and points as deep as half of its width.
        let radii = Vec3::new(0.085, 0.43, 0.5);
        let flat = Shape::new(&ColliderShape::Ellipsoid { from_unit: Affine3A::from_scale(radii) });
        let flat = flat.expect("a flat ellipsoid");
        for i in 0..200 {
            let unit = direction(i);
            let normal = (unit / radii).normalize_or_zero();
            for distance in [0.2, 1.0, 2.0] {
                let found = flat.distance(unit * radii + normal * distance);
                assert!((found - distance).abs() < 0.02 * distance, "found {found}, expected {distance}");
            }
            let inside = flat.distance(unit * radii * 0.5);
            assert!((-0.085..0.0).contains(&inside), "{inside} at half of the way to {unit}");
        }
    }

    #[test]
    fn the_centre_of_an_ellipsoid_is_inside() {
        assert!(
            ellipsoid().distance(Vec3::new(0.0, 0.1, 0.02)) < 0.0 || {
                // At the exact centre every direction is equally near; only NaN would be wrong.
                ellipsoid().distance(Vec3::new(0.0, 0.1, 0.02)).is_finite()
            }
        );
        assert!(ellipsoid().distance(Vec3::new(0.01, 0.1, 0.03)) < -0.03);
    }

    #[test]
    fn shapes_without_size_or_with_nan_are_refused() {
        let nan = Vec3::new(f32::NAN, 0.0, 0.0);
        assert!(
            Shape::new(&ColliderShape::Capsule { a: nan, b: Vec3::X, radius_a: 0.1, radius_b: 0.1 })
                .is_none()
        );
        assert!(Shape::new(&ColliderShape::Ellipsoid { from_unit: Affine3A::ZERO }).is_none());
    }
}
