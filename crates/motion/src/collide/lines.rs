//! Outlines of colliders for drawing.

use std::f32::consts::TAU;

use glam::{Affine3A, Quat, Vec3};

use crate::ColliderShape;

/// Segments per circle.
const PIECES: usize = 32;

/// Appends the outline of a shape, circles and the sides of a capsule, as the ends of straight lines in the
/// space of the shape, metres.
pub fn collider_lines(shape: &ColliderShape, lines: &mut Vec<[Vec3; 2]>) {
    match *shape {
        ColliderShape::Ellipsoid { from_unit } => {
            for (u, v) in [(Vec3::X, Vec3::Y), (Vec3::Y, Vec3::Z), (Vec3::Z, Vec3::X)] {
                arc(&from_unit, u, v, TAU, lines);
            }
        }
        ColliderShape::Capsule { a, b, radius_a, radius_b } => {
            let along = (b - a).try_normalize();
            let turn = along.map_or(Quat::IDENTITY, |along| Quat::from_rotation_arc(Vec3::Z, along));
            let end = |centre: Vec3, radius: f32| {
                Affine3A::from_scale_rotation_translation(Vec3::splat(radius), turn, centre)
            };
            let (from, to) = (end(a, radius_a), end(b, radius_b));
            for (map, out) in [(&from, Vec3::NEG_Z), (&to, Vec3::Z)] {
                arc(map, Vec3::X, Vec3::Y, TAU, lines);
                for side in [Vec3::X, Vec3::Y] {
                    arc(map, side, out, 0.5 * TAU, lines);
                }
            }
            for side in [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y] {
                lines.push([from.transform_point3(side), to.transform_point3(side)]);
            }
        }
    }
}

/// An arc of the unit circle from `u` toward `v`, transformed by `map`.
fn arc(map: &Affine3A, u: Vec3, v: Vec3, angle: f32, lines: &mut Vec<[Vec3; 2]>) {
    let at = |i: usize| {
        let (sin, cos) = (angle * i as f32 / PIECES as f32).sin_cos();
        map.transform_point3(u * cos + v * sin)
    };
    lines.extend((0..PIECES).map(|i| [at(i), at(i + 1)]));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signed_distance;

    #[test]
    fn lines_lie_on_their_shapes() {
        let from_unit = Affine3A::from_scale_rotation_translation(
            Vec3::new(0.1, 0.2, 0.15),
            Quat::from_rotation_x(0.4),
            Vec3::new(0.3, 1.0, 0.0),
        );
        let capsule =
            ColliderShape::Capsule { a: Vec3::X, b: Vec3::new(1.0, 0.3, 0.2), radius_a: 0.1, radius_b: 0.1 };
        for shape in [ColliderShape::Ellipsoid { from_unit }, capsule] {
            let mut lines = Vec::new();
            collider_lines(&shape, &mut lines);
            assert!(lines.len() > 90);
            // The ends of the chords are on the surface.
            assert!(lines.iter().flatten().all(|&p| signed_distance(&shape, p).abs() < 1e-5));
        }
        let mut lines = Vec::new();
        let ball = ColliderShape::Capsule { a: Vec3::X, b: Vec3::X, radius_a: 0.1, radius_b: 0.1 };
        collider_lines(&ball, &mut lines);
        assert!(lines.iter().flatten().all(|p| p.is_finite()));
    }
}
