//! Colliders: fitted to the resting body once, then placed in every pose.

mod edits;
mod fit;
mod groups;
mod lines;
mod refine;
mod shape;

use glam::{Affine3A, Vec3};

use crate::{Body, Collider, ColliderShape, PlacedCollider, Pose};

pub use edits::{ColliderEdit, ColliderEdits, FieldEdit};
pub use fit::fit_colliders;
pub use lines::collider_lines;
pub use shape::signed_distance;

/// Moves colliders with their joints into a pose. Nothing is allocated if `placed` was used with them before.
pub fn place_colliders(colliders: &[Collider], body: &Body, pose: &Pose, placed: &mut Vec<PlacedCollider>) {
    placed.clear();
    placed.extend(colliders.iter().map(|collider| {
        let now = pose.world_from_joint.get(collider.joint).copied().unwrap_or(Affine3A::IDENTITY);
        let rest = body.skeleton.world_at_rest.get(collider.joint).copied().unwrap_or(Affine3A::IDENTITY);
        let world_from_rest = now * rest.inverse();
        let world_from_rest = if world_from_rest.is_finite() { world_from_rest } else { Affine3A::IDENTITY };
        PlacedCollider { shape: transformed(&collider.shape_at_rest, &world_from_rest), world_from_rest }
    }));
}

/// A transformed shape. Capsules keep round ends: non-uniform scale changes their radii uniformly.
fn transformed(shape: &ColliderShape, transform: &Affine3A) -> ColliderShape {
    match *shape {
        ColliderShape::Capsule { a, b, radius_a, radius_b } => {
            let scale = transform.matrix3.determinant().abs().cbrt();
            let at = |p: Vec3| transform.transform_point3(p);
            ColliderShape::Capsule {
                a: at(a),
                b: at(b),
                radius_a: radius_a * scale,
                radius_b: radius_b * scale,
            }
        }
        ColliderShape::Ellipsoid { from_unit } => {
            ColliderShape::Ellipsoid { from_unit: *transform * from_unit }
        }
    }
}
