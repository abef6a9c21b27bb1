//! A character: a skeleton and the meshes that it bends.

use glam::{Affine3A, Quat, Vec3};

/// One joint of a skeleton.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Its name in the file; names need not be unique.
    pub name: String,
    /// Index of its parent, always smaller than its own; `None` for a root.
    pub parent: Option<usize>,
    /// Translation relative to the parent at rest, metres.
    pub translation: Vec3,
    /// Rotation relative to the parent at rest.
    pub rotation: Quat,
    /// Scale relative to the parent at rest.
    pub scale: Vec3,
}

/// A tree of joints, parents before children.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skeleton {
    /// The joints, parents first.
    pub joints: Vec<Joint>,
    /// Transform of each joint to the world in the rest pose.
    pub world_at_rest: Vec<Affine3A>,
}

/// A triangle mesh bound to joints, in the rest pose in world space. Structure of arrays, one entry a vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Rest positions in world space, metres.
    pub positions: Vec<Vec3>,
    /// Outward unit normals at rest.
    pub normals: Vec<Vec3>,
    /// Colour, linear sRGB (base colour of the material times the vertex colour).
    pub colors: Vec<Vec3>,
    /// 1 where hair grows, from the attribute `_SCALP`; empty where the file has none.
    pub scalp: Vec<f32>,
    /// Joints (indices into the skeleton) that move each vertex.
    pub joints: Vec<[u16; 8]>,
    /// Their weights, which sum to 1; unused ones are 0.
    pub weights: Vec<[f32; 8]>,
    /// Counter-clockwise triangles.
    pub triangles: Vec<[u32; 3]>,
}

/// A character, immutable once loaded.
#[derive(Clone, Debug, Default)]
pub struct Body {
    /// What the interface calls it.
    pub name: String,
    /// Its joints.
    pub skeleton: Skeleton,
    /// Its surface, all meshes of the file together.
    pub mesh: Mesh,
    /// The joint that carries the hair; a guess that the user may change.
    pub head_joint: usize,
}
