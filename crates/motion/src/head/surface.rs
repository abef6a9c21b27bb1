//! The part of the surface that is head and neck.

use glam::Vec3;

use crate::Body;

/// Head and neck at rest in head space (see [`crate::Pose::world_from_head`]), for hair to grow on.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HeadMesh {
    /// Vertices, metres.
    pub positions: Vec<Vec3>,
    /// Outward unit normals.
    pub normals: Vec<Vec3>,
    /// Counter-clockwise triangles.
    pub triangles: Vec<[u32; 3]>,
    /// 1 where hair grows, fading to 0 at the hairline.
    pub scalp: Vec<f32>,
    /// The vertex of the body's mesh that each vertex is.
    pub vertex: Vec<u32>,
    /// True where the file had no mask and the hairline is a guess.
    pub scalp_is_guessed: bool,
}

/// Cuts head and neck out of the resting body.
pub fn head_mesh(_body: &Body) -> HeadMesh {
    HeadMesh::default()
}
