//! Signed distance of the resting body: exact, from the closest point of its triangles.

mod closest;
mod topology;
mod tree;

use glam::Vec3;

use crate::Body;
use closest::Feature;
use topology::Topology;
use tree::Tree;

/// Signed distance and outward normal of the resting body, in head space (see [`crate::Pose::world_from_head`]).
///
/// A bounding volume tree finds the closest point of the surface; the sign comes from the angle-weighted
/// pseudonormal of the face, edge or vertex there (Bærentzen and Aanæs 2005, "Signed distance computation using the
/// angle weighted pseudonormal"), which is right for closed surfaces and sensible near open ones.
#[derive(Clone, Debug, Default)]
pub struct RestDistance {
    topology: Topology,
    tree: Tree,
}

impl RestDistance {
    /// Prepares the whole surface of a body; some milliseconds for ten thousand triangles.
    pub fn new(body: &Body) -> Self {
        let origin =
            body.skeleton.world_at_rest.get(body.head_joint).map_or(Vec3::ZERO, |w| w.translation.into());
        let positions: Vec<Vec3> = body.mesh.positions.iter().map(|&p| p - origin).collect();
        Self::of_triangles(&positions, &body.mesh.triangles)
    }

    /// Prepares any surface of counter-clockwise triangles; distances are in the space of its positions.
    pub fn of_triangles(positions: &[Vec3], triangles: &[[u32; 3]]) -> Self {
        let topology = Topology::new(positions, triangles);
        let tree = Tree::new(&topology.corners);
        Self { topology, tree }
    }

    /// Distance in metres, negative inside, and the outward unit normal there: the direction in which the distance
    /// grows. An empty surface is infinitely far.
    pub fn distance(&self, p: Vec3) -> (f32, Vec3) {
        let Some((triangle, at, feature)) = self.tree.closest(&self.topology.corners, p) else {
            return (f32::INFINITY, Vec3::Y);
        };
        let pseudonormal = match feature {
            Feature::Face => self.topology.face_normals[triangle],
            Feature::Edge(k) => self.topology.edge_normals[triangle][k],
            Feature::Vertex(k) => self.topology.vertex_normals[triangle][k],
        };
        let away = p - at;
        let length = away.length();
        let sign = if away.dot(pseudonormal) < 0.0 { -1.0 } else { 1.0 };
        // On the surface itself the direction is lost in rounding: a tenth of a micrometre.
        let normal = if length > 1e-7 { away * (sign / length) } else { pseudonormal };
        (sign * length, normal.normalize_or(Vec3::Y))
    }
}
