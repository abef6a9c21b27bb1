//! A signed distance field of head, neck, shoulders and upper back at rest, which moves with the joints.
//!
//! The field itself never changes. It consists of the distances of the resting skin on a lattice of about
//! 64^3 points and, on a lattice half as fine, the weights of the joints that move the nearby skin. In a
//! pose, a point near the body is mapped back to its rest position, `X = (sum_j w_j(X) M_j)^-1 x`, the
//! inverse of skinning, and the distance is read there. Where one joint moves everything (the skull), that is
//! the inverse of its transform alone. Between joints the weights change smoothly, as those of the skin do,
//! so the surface has no seams.

mod build;
mod lines;
#[cfg(test)]
mod tests;

use glam::{Affine3A, UVec3, Vec3};

use crate::{Body, ColliderShape, Pose, RestDistance};

/// Largest number of joints that move a field.
pub const FIELD_JOINTS: usize = 16;

/// A lattice of points in head space at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FieldLattice {
    /// The first point, metres.
    pub low: Vec3,
    /// Distance between neighbouring points, metres.
    pub spacing: f32,
    /// Points along each axis; the index of a point is `(z * size.y + y) * size.x + x`.
    pub size: UVec3,
}

impl FieldLattice {
    /// Index of a point.
    #[inline]
    pub fn index(&self, at: UVec3) -> usize {
        ((at.z * self.size.y + at.y) * self.size.x + at.x) as usize
    }

    /// Number of points.
    pub fn count(&self) -> usize {
        self.size.as_usizevec3().element_product()
    }

    /// Position of a point, metres.
    pub fn place(&self, index: usize) -> Vec3 {
        let (x, y) = (self.size.x as usize, self.size.y as usize);
        let at = UVec3::new((index % x) as u32, (index / x % y) as u32, (index / x / y) as u32);
        self.low + at.as_vec3() * self.spacing
    }

    /// The last point, metres.
    pub fn high(&self) -> Vec3 {
        self.low + (self.size.as_vec3() - 1.0) * self.spacing
    }
}

/// A weighting of the field's joints.
pub type FieldWeights = [f32; FIELD_JOINTS];

/// Signed distances around head and shoulders at rest; see the module documentation. Immutable, shared by
/// `Arc`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyField {
    joints: Vec<usize>,
    rest_from_head: Vec3,
    distances: FieldLattice,
    distance: Vec<f32>,
    nodes: FieldLattice,
    slot_of_node: Vec<u16>,
    slots: Vec<FieldWeights>,
    outline: Vec<[lines::End; 2]>,
}

/// A field at one instant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FieldPose {
    /// For each joint the map from the world of the rest pose to the current world, in the order of
    /// [`BodyField::joints`].
    pub world_from_rest: Vec<Affine3A>,
    /// Outward displacement of the surface, metres; see [`crate::FieldEdit`].
    pub lift: f32,
}

impl BodyField {
    /// Builds the field of a body from its rest distance `rest`; `None` if nothing can be measured.
    pub fn new(body: &Body, rest: &RestDistance) -> Option<Self> {
        build::build(body, rest)
    }

    /// The joints that move it, the head first.
    pub fn joints(&self) -> &[usize] {
        &self.joints
    }

    /// Translation from head space at rest to the world at rest.
    pub fn rest_from_head(&self) -> Vec3 {
        self.rest_from_head
    }

    /// The lattice of the distances.
    #[inline]
    pub fn distance_lattice(&self) -> &FieldLattice {
        &self.distances
    }

    /// Signed distance at each point of that lattice, metres, negative inside.
    #[inline]
    pub fn distances(&self) -> &[f32] {
        &self.distance
    }

    /// The lattice of the weights, which spans the same box.
    #[inline]
    pub fn node_lattice(&self) -> &FieldLattice {
        &self.nodes
    }

    /// For each node the index of its weights in [`BodyField::slots`].
    #[inline]
    pub fn slot_of_node(&self) -> &[u16] {
        &self.slot_of_node
    }

    /// Weights of the joints, which sum to 1. The first entries belong to single joints, in order.
    pub fn slots(&self) -> &[FieldWeights] {
        &self.slots
    }

    /// Distance at a point of head space at rest, metres, and its gradient; `None` outside the lattice.
    pub fn sample(&self, p: Vec3) -> Option<(f32, Vec3)> {
        let lattice = &self.distances;
        let at = (p - lattice.low) / lattice.spacing;
        let last = (lattice.size - 1).as_vec3();
        // NaN is outside.
        if !(at.cmpge(Vec3::ZERO) & at.cmplt(last)).all() {
            return None;
        }
        let cell = at.as_uvec3();
        let first = lattice.index(cell);
        let (row, layer) = (lattice.size.x as usize, lattice.index(UVec3::Z));
        let corners = [0, 1, row, row + 1, layer, layer + 1, layer + row, layer + row + 1]
            .map(|offset| self.distance[first + offset]);
        let (distance, slope) = crate::distance::interpolate(&corners, at - cell.as_vec3());
        Some((distance, slope / lattice.spacing))
    }

    /// Whether the field covers the whole shape, so that it can replace it.
    pub fn covers(&self, shape_at_rest: &ColliderShape) -> bool {
        let (low, high) = shape_at_rest.bounds();
        let inner = Vec3::splat(self.distances.spacing);
        let (low, high) = (low - self.rest_from_head, high - self.rest_from_head);
        low.cmpge(self.distances.low + inner).all() && high.cmple(self.distances.high() - inner).all()
    }

    /// Moves the field with its joints. Nothing is allocated if `placed` was used with it before.
    pub fn place(&self, body: &Body, pose: &Pose, lift: f32, placed: &mut FieldPose) {
        placed.lift = lift;
        placed.world_from_rest.clear();
        placed.world_from_rest.extend(self.joints.iter().map(|&joint| {
            let now = pose.world_from_joint.get(joint).copied().unwrap_or(Affine3A::IDENTITY);
            let rest = body.skeleton.world_at_rest.get(joint).copied().unwrap_or(Affine3A::IDENTITY);
            let map = now * rest.inverse();
            if map.is_finite() { map } else { Affine3A::IDENTITY }
        }));
    }
}
