//! Colliders fitted to a body.

use glam::Vec3;

use crate::{Body, Collider, ColliderShape, PlacedCollider, Pose};

/// Fits colliders.
pub fn fit_colliders(_body: &Body) -> Vec<Collider> {
    Vec::new()
}

/// Places colliders.
pub fn place_colliders(_colliders: &[Collider], _body: &Body, _pose: &Pose, _placed: &mut Vec<PlacedCollider>) {}

/// Signed distance.
pub fn signed_distance(_shape: &ColliderShape, _p: Vec3) -> f32 {
    0.0
}
