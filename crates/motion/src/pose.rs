//! A body at one instant.

use glam::{Affine3A, Mat3A, Quat, Vec3};

use crate::Body;

/// The transforms of all joints at one instant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Pose {
    /// Time on the clip's clock, seconds.
    pub time_secs: f64,
    /// World transform of each joint.
    pub world_from_joint: Vec<Affine3A>,
    /// Carries head space (see `lovelock_groom`) to the world: rigid, no scale.
    pub world_from_head: Affine3A,
    /// Weights of the morph targets; empty if the body has none.
    pub morph_weights: Vec<f32>,
}

/// The rotation nearest to a linear map (its orthogonal polar factor), by Newton's iteration
/// `Q <- (Q + Q^-T) / 2` (Higham 1986); the identity if the map is singular or mirrors.
pub(crate) fn rotation_of(linear: &Mat3A) -> Quat {
    let size = linear.determinant().abs().cbrt();
    if !(size.is_finite() && size > 1e-12 && linear.determinant() > 0.0) {
        return Quat::IDENTITY;
    }
    let mut q = *linear * (1.0 / size);
    for _ in 0..8 {
        q = (q + q.inverse().transpose()) * 0.5;
    }
    let rotation = Quat::from_mat3a(&q);
    if rotation.is_finite() { rotation.normalize() } else { Quat::IDENTITY }
}

/// Maps head space to the world: the motion of the head joint relative to the rest pose, without scale.
pub(crate) fn rigid_head(body: &Body, world_from_joint: &[Affine3A]) -> Affine3A {
    let (Some(now), Some(rest)) =
        (world_from_joint.get(body.head_joint), body.skeleton.world_at_rest.get(body.head_joint))
    else {
        return Affine3A::IDENTITY;
    };
    let turn = now.matrix3 * rest.matrix3.inverse();
    let translation = if now.translation.is_finite() { now.translation.into() } else { Vec3::ZERO };
    Affine3A::from_rotation_translation(rotation_of(&turn), translation)
}
