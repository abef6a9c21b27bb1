//! Signed distances of collider shapes.

use glam::{Affine3A, Vec3};

use crate::ColliderShape;

/// Signed distance from a shape's surface, negative inside, metres.
///
/// Exact for spheres and capsules, including tapered ones (Quilez, "round cone"). For ellipsoids it is the
/// first-order estimate `k0 (k0 - 1) / k1`, which is exact on the surface and within a few per cent of the
/// distance near it.
pub fn signed_distance(shape: &ColliderShape, p: Vec3) -> f32 {
    match *shape {
        ColliderShape::Capsule { a, b, radius_a, radius_b } => round_cone(a, b, radius_a, radius_b, p),
        ColliderShape::Ellipsoid { from_unit } => ellipsoid(&from_unit, p),
    }
}

fn round_cone(a: Vec3, b: Vec3, radius_a: f32, radius_b: f32, p: Vec3) -> f32 {
    let axis = b - a;
    let length_squared = axis.length_squared();
    let taper = radius_a - radius_b;
    let squared = length_squared - taper * taper;
    // One sphere contains the other.
    if squared <= 0.0 || length_squared < 1e-12 {
        let (centre, radius) = if radius_a >= radius_b { (a, radius_a) } else { (b, radius_b) };
        return p.distance(centre) - radius;
    }
    let inverse = 1.0 / length_squared;
    let from_a = p - a;
    let along = from_a.dot(axis);
    let x = (from_a * length_squared - axis * along).length_squared();
    let beyond = along - length_squared;
    let (y2, z2) = (along * along * length_squared, beyond * beyond * length_squared);
    let k = taper.signum() * taper * taper * x;
    if beyond.signum() * squared * z2 > k {
        (x + z2).sqrt() * inverse - radius_b
    } else if along.signum() * squared * y2 < k {
        (x + y2).sqrt() * inverse - radius_a
    } else {
        ((x * squared * inverse).sqrt() + along * taper) * inverse - radius_a
    }
}

fn ellipsoid(from_unit: &Affine3A, p: Vec3) -> f32 {
    let unit_from_world = from_unit.inverse();
    let q = unit_from_world.transform_point3a(p.into());
    let k0 = q.length();
    // Gradient of |q| with respect to p.
    let k1 = (unit_from_world.matrix3.transpose() * q).length() / k0.max(1e-6);
    if k1 < 1e-12 || k0 < 1e-3 {
        // The estimate fails near the centre, where the distance is the smallest radius.
        let m = from_unit.matrix3;
        return -m.x_axis.length().min(m.y_axis.length()).min(m.z_axis.length());
    }
    (k0 - 1.0) / k1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn capsules_and_ellipsoids_by_hand() {
        let capsule = ColliderShape::Capsule { a: Vec3::ZERO, b: Vec3::Y, radius_a: 0.5, radius_b: 0.5 };
        assert!((signed_distance(&capsule, Vec3::new(2.0, 0.5, 0.0)) - 1.5).abs() < 1e-6);
        assert!((signed_distance(&capsule, Vec3::new(0.0, 3.0, 0.0)) - 1.5).abs() < 1e-6);
        assert!((signed_distance(&capsule, Vec3::new(0.1, 0.5, 0.0)) + 0.4).abs() < 1e-6);
        // A cone of half angle 30 degrees: sin = (1 - 0) / 2.
        let cone = ColliderShape::Capsule { a: Vec3::ZERO, b: Vec3::Y * 2.0, radius_a: 1.0, radius_b: 1e-6 };
        let on_side = Vec3::new(30_f32.to_radians().cos(), 0.5, 0.0);
        assert!(signed_distance(&cone, on_side).abs() < 1e-5);
        let ball = ColliderShape::Ellipsoid { from_unit: Affine3A::from_scale(Vec3::splat(2.0)) };
        assert!((signed_distance(&ball, Vec3::X * 5.0) - 3.0).abs() < 1e-5);
        let egg = ColliderShape::Ellipsoid { from_unit: Affine3A::from_scale(Vec3::new(1.0, 2.0, 3.0)) };
        assert!(signed_distance(&egg, Vec3::Y * 2.0).abs() < 1e-6);
        assert!((signed_distance(&egg, Vec3::Z * 3.1) - 0.1).abs() < 1e-4);
        assert!(signed_distance(&egg, Vec3::ZERO) <= -1.0);
    }
}
