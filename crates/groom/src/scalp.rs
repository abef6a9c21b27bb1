//! The surface that hair grows on.

use glam::Vec3;

/// A triangle mesh of the head in head space, with a mask that says where hair grows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scalp {
    /// Vertices of the head (not of the whole body), head space, metres.
    pub positions: Vec<Vec3>,
    /// Outward unit normals, one a vertex.
    pub normals: Vec<Vec3>,
    /// Indices of vertices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// One a vertex: 1 where hair grows, 0 where none does (face, ears, neck).
    pub mask: Vec<f32>,
}
