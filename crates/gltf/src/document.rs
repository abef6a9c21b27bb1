//! The part of a glTF 2.0 document that hair and moving bodies need.
//!
//! Everything else in a file (cameras, lights) is not parsed, so errors there are harmless. What is wrong in a material, a texture or
//! an image is read as if it were not there. Names are those of the specification. Indices are not
//! checked here.
#![expect(missing_docs, reason = "the specification describes the fields, whose names these are")]

use std::collections::BTreeMap;

use glam::{Mat4, Quat, Vec3};
use serde::Deserialize;
use serde_json::Value;

mod look;

pub use look::{Image, Material, Pbr, Sampler as TextureSampler, Texture, TextureInfo};

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Document {
    pub extensions_required: Vec<String>,
    pub extensions: BTreeMap<String, Value>,
    pub scene: Option<usize>,
    pub scenes: Vec<Scene>,
    pub nodes: Vec<Node>,
    pub meshes: Vec<Mesh>,
    pub skins: Vec<Skin>,
    pub animations: Vec<Animation>,
    pub accessors: Vec<Accessor>,
    pub buffer_views: Vec<BufferView>,
    pub buffers: Vec<Buffer>,
    #[serde(deserialize_with = "look::lenient_list")]
    pub materials: Vec<Material>,
    #[serde(deserialize_with = "look::lenient_list")]
    pub textures: Vec<Texture>,
    #[serde(deserialize_with = "look::lenient_list")]
    pub images: Vec<Image>,
    #[serde(deserialize_with = "look::lenient_list")]
    pub samplers: Vec<TextureSampler>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Scene {
    pub nodes: Vec<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Node {
    pub name: Option<String>,
    pub children: Vec<usize>,
    pub mesh: Option<usize>,
    pub skin: Option<usize>,
    pub matrix: Option<[f32; 16]>,
    pub translation: Option<[f32; 3]>,
    pub rotation: Option<[f32; 4]>,
    pub scale: Option<[f32; 3]>,
    pub weights: Option<Vec<f32>>,
    pub extensions: BTreeMap<String, Value>,
}

impl Node {
    /// Whether the node is not hidden by `KHR_node_visibility`. A hidden node also hides those below it.
    pub fn is_visible(&self) -> bool {
        let visibility = self.extensions.get("KHR_node_visibility");
        visibility.and_then(|of| of.get("visible")).and_then(Value::as_bool).unwrap_or(true)
    }

    /// Scale, rotation as stored, and translation of a node without a matrix.
    fn parts(&self) -> (Vec3, Quat, Vec3) {
        (
            self.scale.map_or(Vec3::ONE, Vec3::from),
            self.rotation.map_or(Quat::IDENTITY, Quat::from_array),
            self.translation.map_or(Vec3::ZERO, Vec3::from),
        )
    }

    /// Translation, rotation of unit length and scale; `None` if they are not finite.
    pub fn local(&self) -> Option<(Vec3, Quat, Vec3)> {
        let (scale, rotation, translation) = match &self.matrix {
            Some(matrix) => {
                let matrix = Mat4::from_cols_array(matrix);
                if !matrix.is_finite() || matrix.determinant().abs() < 1e-30 {
                    return None;
                }
                matrix.to_scale_rotation_translation()
            }
            None => self.parts(),
        };
        let length = rotation.length();
        let finite = scale.is_finite() && rotation.is_finite() && translation.is_finite() && length > 1e-6;
        finite.then(|| (translation, rotation * (1.0 / length), scale))
    }

    /// The transform to the space of the parent, with the shear that a matrix may have.
    pub fn transform(&self) -> Mat4 {
        if let Some(matrix) = &self.matrix {
            return Mat4::from_cols_array(matrix);
        }
        let (scale, rotation, translation) = self.parts();
        let length = rotation.length();
        let rotation = if length > 1e-6 { rotation * length.recip() } else { Quat::IDENTITY };
        Mat4::from_scale_rotation_translation(scale, rotation, translation)
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Mesh {
    pub name: Option<String>,
    pub primitives: Vec<Primitive>,
    pub weights: Option<Vec<f32>>,
    pub extras: Option<Value>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Primitive {
    pub attributes: BTreeMap<String, usize>,
    pub indices: Option<usize>,
    pub material: Option<usize>,
    pub mode: Option<u32>,
    pub targets: Vec<BTreeMap<String, usize>>,
    pub extensions: BTreeMap<String, Value>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub struct Skin {
    pub inverse_bind_matrices: Option<usize>,
    pub joints: Vec<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub struct Animation {
    pub name: Option<String>,
    pub channels: Vec<Channel>,
    pub samplers: Vec<Sampler>,
}

#[derive(Debug, Deserialize)]
pub struct Channel {
    pub sampler: usize,
    pub target: Target,
}

#[derive(Debug, Deserialize)]
pub struct Target {
    pub node: Option<usize>,
    pub path: String,
}

#[derive(Debug, Deserialize)]
pub struct Sampler {
    pub input: usize,
    pub output: usize,
    pub interpolation: Option<String>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Accessor {
    pub buffer_view: Option<usize>,
    #[serde(default)]
    pub byte_offset: u64,
    pub component_type: u32,
    #[serde(default)]
    pub normalized: bool,
    pub count: u64,
    #[serde(rename = "type")]
    pub kind: String,
    pub sparse: Option<Sparse>,
}

#[derive(Debug, Deserialize)]
pub struct Sparse {
    pub count: u64,
    pub indices: SparseIndices,
    pub values: SparseValues,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct SparseIndices {
    pub buffer_view: usize,
    #[serde(default)]
    pub byte_offset: u64,
    pub component_type: u32,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct SparseValues {
    pub buffer_view: usize,
    #[serde(default)]
    pub byte_offset: u64,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct BufferView {
    pub buffer: usize,
    #[serde(default)]
    pub byte_offset: u64,
    pub byte_length: u64,
    pub byte_stride: Option<u64>,
}

#[derive(Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Buffer {
    pub byte_length: u64,
    pub uri: Option<String>,
}
