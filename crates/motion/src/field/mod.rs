//! A signed distance field of head, neck, shoulders and upper back at rest, which the joints carry along.
//!
//! The field itself never changes: distances of the resting skin on a lattice of about 64^3 points, and on one half
//! as fine the joints that move the skin near by, with their weights. In a pose a point near the body is taken back
//! to where it is at rest, `X = (sum_j w_j(X) M_j)^-1 x`, the inverse of what skinning does, and the distance is read
//! there. Where one joint moves all (the skull), that is the inverse of its transform alone; between joints the
//! weights pass smoothly from one to the other, as those of the skin do, so the surface has no seams.

mod build;
mod lines;
#[cfg(test)]
mod tests;

use glam::{Affine3A, UVec3, Vec3};

use crate::{Body, ColliderShape, Pose, RestDistance};

/// Most joints that move a field.
pub const FIELD_JOINTS: usize = 16;

/// A lattice of points in head space at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FieldLattice {
    /// The first point, metres.
    pub low: Vec3,
    /// From point to point, metres.
    pub spacing: f32,
    /// Points along each axis; a point's index is `(z * size.y + y) * size.x + x`.
    pub size: UVec3,
}

impl FieldLattice {
    /// Index of a point.
    #[inline]
    pub fn index(&self, at: UVec3) -> usize {
        ((at.z * self.size.y + at.y) * self.size.x + at.x) as usize
    }

    /// How many points there are.
    pub fn count(&self) -> usize {
        self.size.as_usizevec3().element_product()
    }

    /// Place of a point, metres.
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

/// Signed distances around head and shoulders at rest; see the head of this module. Immutable, shared by `Arc`.
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

/// Where a field is at one instant.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FieldPose {
    /// Carries each joint's part from the rest pose's world to the world now, in the order of
    /// [`BodyField::joints`].
    pub world_from_rest: Vec<Affine3A>,
    /// By how much the surface is moved outward, metres; see [`crate::FieldEdit`].
    pub lift: f32,
}

impl BodyField {
    /// Measures the field of a body, whose distance at rest is `rest`; `None` where nothing of it can be measured.
    pub fn new(body: &Body, rest: &RestDistance) -> Option<Self> {
        build::build(body, rest)
    }

    /// The joints that move it, the head first.
    pub fn joints(&self) -> &[usize] {
        &self.joints
    }

    /// From head space at rest to the world at rest.
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

    /// For each node the entry of [`BodyField::slots`] that it has.
    #[inline]
    pub fn slot_of_node(&self) -> &[u16] {
        &self.slot_of_node
    }

    /// Weights of the joints, which sum to 1. The first entries are those of one joint alone, in order.
    pub fn slots(&self) -> &[FieldWeights] {
        &self.slots
    }

    /// Distance at a point of head space at rest, metres, and its gradient; `None` outside of the lattice.
    pub fn sample(&self, p: Vec3) -> Option<(f32, Vec3)> {
        let lattice = &self.distances;
        let at = (p - lattice.low) / lattice.spacing;
        let last = (lattice.size - 1).as_vec3();
        // Not a number is not within.
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

    /// Whether all of a shape at rest lies where the field tells more than the shape does.
    pub fn covers(&self, shape_at_rest: &ColliderShape) -> bool {
        let (low, high) = shape_at_rest.bounds();
        let inner = Vec3::splat(self.distances.spacing);
        let (low, high) = (low - self.rest_from_head, high - self.rest_from_head);
        low.cmpge(self.distances.low + inner).all() && high.cmple(self.distances.high() - inner).all()
    }

    /// Carries the field along with its joints. Nothing is allocated where `placed` was used with it before.
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
