//! Inverse kinematics of limbs with two bones, and rotations from directions.

use glam::{Mat3, Quat, Vec3};

/// The solution for a limb.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// Unit direction of the first bone.
    pub(super) first: Vec3,
    /// Unit direction of the second bone.
    pub(super) second: Vec3,
    /// Unit axis about which the limb bends: `first` turns about it toward `second`.
    pub(super) hinge: Vec3,
}

/// Bends a limb with bones of `lengths` so that it ends `offset` from its root; the middle joint lies on the side
/// of `pole`. If the target is farther than 99.9 % of the limb's length, the limb points in its direction.
pub(super) fn reach(offset: Vec3, lengths: [f32; 2], pole: Vec3) -> Reach {
    let [a, b] = lengths;
    let direction = offset.normalize_or(-Vec3::Y);
    let c = offset.length().clamp((a - b).abs() + 0.01, 0.999 * (a + b));
    let side = (pole - direction * pole.dot(direction)).normalize_or(direction.any_orthonormal_vector());
    // The law of cosines gives the angle between the first bone and the line to the target.
    let cosine = ((a * a + c * c - b * b) / (2.0 * a * c)).clamp(-1.0, 1.0);
    let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
    let first = direction * cosine + side * sine;
    let second = ((direction * c - first * a) / b).normalize_or(direction);
    Reach { first, second, hinge: side.cross(direction) }
}

/// The rotation that carries the pair of a direction and a hinge at rest to another such pair.
pub(super) fn align(rest: (Vec3, Vec3), now: (Vec3, Vec3)) -> Quat {
    let frame = |(direction, hinge): (Vec3, Vec3)| {
        let x = direction.normalize_or(Vec3::X);
        let y = (hinge - x * hinge.dot(x)).normalize_or(x.any_orthonormal_vector());
        Mat3::from_cols(x, y, x.cross(y))
    };
    Quat::from_mat3(&(frame(now) * frame(rest).transpose())).normalize()
}

/// The part of `rotation` that turns about the unit vector `axis`, radians in -π..=π (swing times twist).
pub(super) fn twist_about(rotation: Quat, axis: Vec3) -> f32 {
    let along = Vec3::new(rotation.x, rotation.y, rotation.z).dot(axis);
    let angle = 2.0 * along.atan2(rotation.w);
    (angle + std::f32::consts::PI).rem_euclid(std::f32::consts::TAU) - std::f32::consts::PI
}

/// Angle about the unit vector `axis` from the projection of `from` to that of `to`, radians in -π..=π.
pub(super) fn angle_about(axis: Vec3, from: Vec3, to: Vec3) -> f32 {
    axis.dot(from.cross(to)).atan2(from.dot(to) - from.dot(axis) * to.dot(axis))
}
