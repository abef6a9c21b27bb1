//! Colliders: simple shapes that follow joints.

use glam::{Affine3A, Vec3};

/// A shape in some space, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ColliderShape {
    /// The hull of two spheres: a sphere if `a == b`, a capsule if the radii are equal.
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
    /// An ellipsoid: the unit sphere transformed by `from_unit`, which consists of a rotation, three radii
    /// and a centre.
    Ellipsoid {
        /// Carries the unit sphere to the ellipsoid.
        from_unit: Affine3A,
    },
}

impl ColliderShape {
    /// Its bounding box: the lowest and the highest corner.
    pub(crate) fn bounds(&self) -> (Vec3, Vec3) {
        match *self {
            Self::Capsule { a, b, radius_a, radius_b } => {
                let (ra, rb) = (Vec3::splat(radius_a), Vec3::splat(radius_b));
                ((a - ra).min(b - rb), (a + ra).max(b + rb))
            }
            Self::Ellipsoid { from_unit: Affine3A { matrix3: m, translation } } => {
                let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
                let half = Vec3::from(x * x + y * y + z * z).map(f32::sqrt);
                (Vec3::from(translation) - half, Vec3::from(translation) + half)
            }
        }
    }
}

/// A shape that follows one joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Collider {
    /// The name shown in the interface, such as `upper arm left`.
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
    /// Maps points fixed to the collider from the world of the rest pose to the current world. The simulator
    /// derives the surface velocity from the change of this transform over a step.
    pub world_from_rest: Affine3A,
}
