//! A character: a skeleton and the meshes that it deforms.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{Affine3A, Quat, Vec2, Vec3};

use crate::expression::Expression;
use crate::material::{Image, Material};

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
    /// World transform of each joint in the rest pose.
    pub world_at_rest: Vec<Affine3A>,
    /// The bones of a person that the file itself assigns to joints, by their names in VRM, such as `leftUpperArm`. Where this is not
    /// empty, names of joints say nothing.
    pub named: BTreeMap<usize, String>,
}

impl Skeleton {
    /// Local transform of a joint at rest.
    pub fn local_at_rest(&self, joint: usize) -> Affine3A {
        let j = &self.joints[joint];
        Affine3A::from_scale_rotation_translation(j.scale, j.rotation, j.translation)
    }

    /// Fills `world_at_rest` from the joints.
    pub fn update_rest(&mut self) {
        self.world_at_rest.clear();
        for j in 0..self.joints.len() {
            let local = self.local_at_rest(j);
            let world = self.joints[j].parent.map_or(local, |p| self.world_at_rest[p] * local);
            self.world_at_rest.push(world);
        }
    }

    /// Position of a joint at rest, world space, metres.
    pub fn rest_position(&self, joint: usize) -> Vec3 {
        self.world_at_rest[joint].translation.into()
    }

    /// Whether `joint` is `ancestor` or one of its descendants.
    pub fn is_below(&self, joint: usize, ancestor: usize) -> bool {
        let mut at = Some(joint);
        while let Some(j) = at {
            if j == ancestor {
                return true;
            }
            at = self.joints[j].parent;
        }
        false
    }
}

/// A triangle mesh bound to joints, in the rest pose in world space. Structure of arrays with one entry per
/// vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Rest positions in world space, metres.
    pub positions: Vec<Vec3>,
    /// Outward unit normals at rest.
    pub normals: Vec<Vec3>,
    /// Colour, linear sRGB (base colour of the material times the vertex colour); textures multiply it.
    pub colors: Vec<Vec3>,
    /// Opacity (of the material times that of the vertex); empty if all are 1.
    pub opacity: Vec<f32>,
    /// Two sets of texture coordinates, each empty or with one entry per vertex, all finite.
    pub coordinates: [Vec<Vec2>; 2],
    /// The share of light from all directions that creases let in, from the attribute `_OCCLUSION`; empty if all are 1.
    pub occlusion: Vec<f32>,
    /// 1 where hair grows, from the attribute `_SCALP`; empty if the file has none.
    pub scalp: Vec<f32>,
    /// Further masks from vertex attributes whose names begin with an underscore, such as `_BROW`, where other hair grows: one entry per
    /// vertex, 0 to 1.
    pub masks: BTreeMap<String, Vec<f32>>,
    /// Joints (indices into the skeleton) that move each vertex.
    pub joints: Vec<[u16; 8]>,
    /// Their weights, which sum to 1; unused ones are 0.
    pub weights: Vec<[f32; 8]>,
    /// Counter-clockwise triangles.
    pub triangles: Vec<[u32; 3]>,
    /// Index into [`Body::materials`] for each triangle; empty if all have the default material.
    pub materials: Vec<u16>,
}

/// A joint together with the transform from bind space to the joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bind {
    /// Index of the joint in the skeleton.
    pub joint: u16,
    /// Carries bind space to the joint's space (glTF: the inverse bind matrix).
    pub joint_from_bind: Affine3A,
}

/// A shape that the surface is blended toward, in bind space. Only the vertices that it moves are stored.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MorphTarget {
    /// Its name in the file, otherwise its number.
    pub name: String,
    /// Vertices that it moves.
    pub vertices: Vec<u32>,
    /// Displacements at weight 1, metres; one entry per vertex.
    pub positions: Vec<Vec3>,
    /// Change of the normal at weight 1; one entry per vertex.
    pub normals: Vec<Vec3>,
    /// Weight at rest.
    pub rest_weight: f32,
}

/// The data for skinning: the surface as its meshes were bound, which may differ from the rest pose.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SkinData {
    /// Positions in bind space, one per vertex of the mesh, metres.
    pub positions: Vec<Vec3>,
    /// Unit normals in bind space.
    pub normals: Vec<Vec3>,
    /// The joints with their bind transforms; different skins may bind one joint differently.
    pub palette: Vec<Bind>,
    /// Palette entries that move each vertex, heaviest first; the weights are those of the mesh.
    pub binds: Vec<[u16; 8]>,
    /// The morph targets.
    pub morphs: Vec<MorphTarget>,
}

/// A character, immutable once loaded.
#[derive(Clone, Debug, Default)]
pub struct Body {
    /// The name shown in the interface.
    pub name: String,
    /// Its joints.
    pub skeleton: Skeleton,
    /// Its surface: all meshes of the file together.
    pub mesh: Mesh,
    /// The surface in bind space.
    pub skin: SkinData,
    /// How parts of the surface look.
    pub materials: Vec<Material>,
    /// The images that materials use.
    pub images: Arc<[Image]>,
    /// The expressions that the file names, of its morph targets.
    pub expressions: Vec<Expression>,
    /// The joint that carries the hair; guessed, and the user may change it.
    pub head_joint: usize,
    /// Whether the file says nothing of a head and none was found by the shape, so that the figure is taken for a head alone.
    pub is_without_head: bool,
}

impl Body {
    /// Extent of the rest pose along Y, metres.
    pub fn height(&self) -> f32 {
        let (low, high) = self
            .mesh
            .positions
            .iter()
            .fold((f32::MAX, f32::MIN), |(low, high), p| (low.min(p.y), high.max(p.y)));
        (high - low).max(0.0)
    }

    /// The joint with the largest weight at a vertex.
    pub fn dominant_joint(&self, vertex: usize) -> usize {
        let weights = &self.mesh.weights[vertex];
        let heaviest = (1..8).fold(0, |best, k| if weights[k] > weights[best] { k } else { best });
        usize::from(self.mesh.joints[vertex][heaviest])
    }
}
