//! What hair collides with: simple shapes that follow joints.

use glam::{Affine3A, Vec3};

/// A shape in some space, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColliderShape {
    /// The hull of two spheres: a sphere where `a == b`, a capsule where the radii are equal.
    Capsule {
        /// Centre of the first sphere.
        a: Vec3,
        /// Centre of the second sphere.
        b: Vec3,
        /// Radius of the first sphere.
        radius_a: f32,
        /// Radius of the second sphere.
        radius_b: f32,
    },
    /// An ellipsoid: the unit sphere under `from_unit`, a rotation, three radii as scale and a centre.
    Ellipsoid {
        /// Carries the unit sphere to the ellipsoid.
        from_unit: Affine3A,
    },
}

/// A shape that follows one joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Collider {
    /// What the interface calls it, such as `upper arm left`.
    pub name: String,
    /// The joint that it follows.
    pub joint: usize,
    /// The shape in the world of the rest pose.
    pub shape_at_rest: ColliderShape,
}

/// A shape in the world at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedCollider {
    /// The shape in world space.
    pub shape: ColliderShape,
    /// Carries a point fixed to the collider from the rest pose's world to the world now. The simulator
    /// takes the surface's velocity from the change of this transform over a step.
    pub world_from_rest: Affine3A,
}
