//! Writes glTF 2.0 in its binary form: a skinned mesh with its materials, images and morph targets, a skeleton and clips.

use glam::{Quat, Vec2, Vec3};
use lovelock_gltf::glb::{
    self, ARRAY_BUFFER, Buffer, ELEMENT_ARRAY_BUFFER, FLOAT, UNSIGNED_BYTE, UNSIGNED_SHORT,
};
use serde_json::{Value, json};

use super::rig::RigJoint;

/// Joints and weights of a vertex, largest first; the weights are 65535ths that sum to 65535.
pub(super) type Influences = [(u8, u16); 4];

/// A clip: poses at equal time steps, with the last one equal to the first.
pub(super) struct SampledClip {
    /// Its name in the file.
    pub(super) name: &'static str,
    /// Time of each key, seconds.
    pub(super) times: Vec<f32>,
    /// Rotation of each joint relative to its parent, by joint, then by key.
    pub(super) rotations: Vec<Vec<Quat>>,
    /// Position of the hips in metres, by key.
    pub(super) hips: Vec<Vec3>,
    /// Weights of the morph targets, by key; empty if the clip moves none.
    pub(super) weights: Vec<Vec<f32>>,
}

/// What a part is made of.
pub(super) struct Material {
    /// Its name in the file.
    pub(super) name: String,
    /// Linear sRGB; multiplies the image.
    pub(super) colour: Vec3,
    /// Perceptual roughness, 0 to 1; multiplies the image of it.
    pub(super) roughness: f32,
    /// Index of the image of its roughness, which is in green.
    pub(super) rough_image: Option<usize>,
    /// Index of the image of its colour.
    pub(super) image: Option<usize>,
    /// What Lovelock shades it as: skin, eye, cloth or other.
    pub(super) region: Option<String>,
}

/// An image.
pub(super) struct Image {
    /// Its name in the file.
    pub(super) name: &'static str,
    /// A JPEG file.
    pub(super) bytes: Vec<u8>,
}

/// A part of the surface with one material. Lists with one entry per vertex, unless they are empty.
pub(super) struct Part {
    /// Index of its material.
    pub(super) material: usize,
    /// Rest positions, metres.
    pub(super) positions: Vec<Vec3>,
    /// Unit normals.
    pub(super) normals: Vec<Vec3>,
    /// Linear sRGB; may be empty.
    pub(super) colours: Vec<Vec3>,
    /// Texture coordinates; may be empty.
    pub(super) uv: Vec<Vec2>,
    /// Further attributes: names and values.
    pub(super) masks: Vec<(&'static str, Vec<f32>)>,
    /// Joints and weights.
    pub(super) influences: Vec<Influences>,
    /// Counter-clockwise triangles.
    pub(super) triangles: Vec<[u32; 3]>,
    /// By morph target, the vertices that it moves and how far, metres.
    pub(super) moves: Vec<Vec<(u32, Vec3)>>,
}

/// The contents of the file.
pub(super) struct Model {
    /// Its name in the file.
    pub(super) name: &'static str,
    /// The surface.
    pub(super) parts: Vec<Part>,
    /// What it is made of.
    pub(super) materials: Vec<Material>,
    /// The images of the materials.
    pub(super) images: Vec<Image>,
    /// Names of the morph targets.
    pub(super) morphs: Vec<&'static str>,
    /// The skeleton.
    pub(super) joints: Vec<RigJoint>,
    /// The clips.
    pub(super) clips: Vec<SampledClip>,
}

fn floats<const N: usize>(
    buffer: &mut Buffer,
    values: &[[f32; N]],
    kind: &str,
    target: Option<u32>,
) -> usize {
    let bytes: Vec<u8> = values.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    buffer.add(&bytes, kind, FLOAT, values.len(), target)
}

/// Writes the smallest and largest values into an accessor, as glTF requires for positions and times.
fn bound<const N: usize>(accessor: &mut Value, values: &[[f32; N]]) {
    let fold = |f: fn(f32, f32) -> f32| -> Vec<f32> {
        (0..N).map(|c| values.iter().map(|v| v[c]).reduce(f).unwrap_or(0.0)).collect()
    };
    accessor["min"] = json!(fold(f32::min));
    accessor["max"] = json!(fold(f32::max));
}

/// The bytes of the `.glb` file.
pub(super) fn write(model: &Model) -> anyhow::Result<Vec<u8>> {
    let mut buffer = Buffer::default();
    let primitives: Vec<Value> = model.parts.iter().map(|part| primitive(part, &mut buffer)).collect();

    let bind: Vec<[f32; 16]> = model
        .joints
        .iter()
        .map(|joint| {
            let t = -joint.rest;
            [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, t.x, t.y, t.z, 1.0]
        })
        .collect();
    let bind = floats(&mut buffer, &bind, "MAT4", None);

    // Node 0 is the mesh, the joints follow.
    let mut nodes = vec![json!({"name": model.name, "mesh": 0, "skin": 0})];
    for (index, joint) in model.joints.iter().enumerate() {
        let parent = joint.parent.map_or(Vec3::ZERO, |p| model.joints[p].rest);
        let mut node = json!({"name": joint.name, "translation": (joint.rest - parent).to_array()});
        let children: Vec<usize> = (0..model.joints.len())
            .filter(|other| model.joints[*other].parent == Some(index))
            .map(|other| other + 1)
            .collect();
        if !children.is_empty() {
            node["children"] = json!(children);
        }
        nodes.push(node);
    }
    let animations: Vec<Value> = model.clips.iter().map(|clip| animation(clip, &mut buffer)).collect();
    let images: Vec<Value> = model.images.iter().map(|image| embedded(image, &mut buffer)).collect();

    let mut mesh = json!({"name": model.name, "primitives": primitives});
    if !model.morphs.is_empty() {
        mesh["weights"] = json!(vec![0.0; model.morphs.len()]);
        mesh["extras"] = json!({"targetNames": model.morphs});
    }
    let mut document = json!({
        "asset": {"version": "2.0", "generator": "cargo xtask assets"},
        "scene": 0,
        "scenes": [{"name": model.name, "nodes": [0, 1]}],
        "nodes": nodes,
        "meshes": [mesh],
        "materials": model.materials.iter().map(material).collect::<Vec<_>>(),
        "skins": [{
            "name": model.name,
            "inverseBindMatrices": bind,
            "skeleton": 1,
            "joints": (1..=model.joints.len()).collect::<Vec<_>>(),
        }],
        "buffers": [{"byteLength": buffer.len()}],
        "bufferViews": buffer.views,
        "accessors": buffer.accessors,
    });
    // An empty list is not valid.
    if !animations.is_empty() {
        document["animations"] = json!(animations);
    }
    if !images.is_empty() {
        let textures: Vec<Value> = (0..images.len()).map(|i| json!({"source": i, "sampler": 0})).collect();
        document["images"] = json!(images);
        document["textures"] = json!(textures);
        // Linear, with smaller versions of the image; no repetition.
        document["samplers"] =
            json!([{"magFilter": 9729, "minFilter": 9987, "wrapS": 33071, "wrapT": 33071}]);
    }
    let head = glb::head(serde_json::to_vec(&document)?, buffer.len())
        .map_err(|whole| anyhow::anyhow!("a binary glTF file of {whole} bytes; must be less than 4 GiB"))?;
    Ok([head, buffer.into_bytes()].concat())
}

fn material(material: &Material) -> Value {
    let mut surface = json!({"metallicFactor": 0.0, "roughnessFactor": material.roughness});
    if material.colour != Vec3::ONE {
        surface["baseColorFactor"] = json!(material.colour.extend(1.0).to_array());
    }
    if let Some(image) = material.image {
        surface["baseColorTexture"] = json!({"index": image});
    }
    if let Some(image) = material.rough_image {
        surface["metallicRoughnessTexture"] = json!({"index": image});
    }
    let mut out = json!({"name": material.name, "pbrMetallicRoughness": surface});
    if let Some(region) = &material.region {
        out["extras"] = json!({"region": region});
    }
    out
}

/// Adds an image to the buffer, with a view but no accessor.
fn embedded(image: &Image, buffer: &mut Buffer) -> Value {
    buffer.add(&image.bytes, "SCALAR", UNSIGNED_BYTE, image.bytes.len(), None);
    buffer.accessors.pop();
    json!({"name": image.name, "mimeType": "image/jpeg", "bufferView": buffer.views.len() - 1})
}

fn primitive(part: &Part, buffer: &mut Buffer) -> Value {
    let count = part.positions.len();
    let mut attributes = serde_json::Map::new();
    let positions: Vec<[f32; 3]> = part.positions.iter().map(Vec3::to_array).collect();
    let position = floats(buffer, &positions, "VEC3", Some(ARRAY_BUFFER));
    bound(&mut buffer.accessors[position], &positions);
    attributes.insert("POSITION".into(), position.into());
    let normals: Vec<[f32; 3]> = part.normals.iter().map(Vec3::to_array).collect();
    attributes.insert("NORMAL".into(), floats(buffer, &normals, "VEC3", Some(ARRAY_BUFFER)).into());
    if !part.colours.is_empty() {
        let colours: Vec<u8> = part
            .colours
            .iter()
            .flat_map(|c| [c.x, c.y, c.z, 1.0])
            .flat_map(|v| ((v.clamp(0.0, 1.0) * 65535.0).round() as u16).to_le_bytes())
            .collect();
        let colour = buffer.add(&colours, "VEC4", UNSIGNED_SHORT, count, Some(ARRAY_BUFFER));
        buffer.accessors[colour]["normalized"] = json!(true);
        attributes.insert("COLOR_0".into(), colour.into());
    }
    if !part.uv.is_empty() {
        let uv: Vec<[f32; 2]> = part.uv.iter().map(Vec2::to_array).collect();
        attributes.insert("TEXCOORD_0".into(), floats(buffer, &uv, "VEC2", Some(ARRAY_BUFFER)).into());
    }
    for (name, values) in &part.masks {
        let values: Vec<[f32; 1]> = values.iter().map(|v| [*v]).collect();
        attributes.insert((*name).into(), floats(buffer, &values, "SCALAR", Some(ARRAY_BUFFER)).into());
    }
    let joints: Vec<u8> = part.influences.iter().flatten().map(|(joint, _)| *joint).collect();
    let joints = buffer.add(&joints, "VEC4", UNSIGNED_BYTE, count, Some(ARRAY_BUFFER));
    attributes.insert("JOINTS_0".into(), joints.into());
    let weights: Vec<u8> = part.influences.iter().flatten().flat_map(|(_, w)| w.to_le_bytes()).collect();
    let weights = buffer.add(&weights, "VEC4", UNSIGNED_SHORT, count, Some(ARRAY_BUFFER));
    buffer.accessors[weights]["normalized"] = json!(true);
    attributes.insert("WEIGHTS_0".into(), weights.into());
    let indices: Vec<u8> = part.triangles.iter().flatten().flat_map(|i| (*i as u16).to_le_bytes()).collect();
    let indices =
        buffer.add(&indices, "SCALAR", UNSIGNED_SHORT, part.triangles.len() * 3, Some(ELEMENT_ARRAY_BUFFER));
    let mut out = json!({"attributes": attributes, "indices": indices, "material": part.material});
    if !part.moves.is_empty() {
        let targets = part.moves.iter().map(|moves| json!({"POSITION": target(moves, count, buffer)}));
        out["targets"] = json!(targets.collect::<Vec<_>>());
    }
    out
}

/// An accessor of displacements that stores only the vertices that move; the first one with no displacement if none does, because
/// readers want something in it.
fn target(moves: &[(u32, Vec3)], count: usize, buffer: &mut Buffer) -> usize {
    let moves = if moves.is_empty() { &[(0, Vec3::ZERO)] } else { moves };
    let values: Vec<[f32; 3]> = moves.iter().map(|(_, by)| by.to_array()).collect();
    let mut accessor = json!({"componentType": FLOAT, "count": count, "type": "VEC3"});
    let with_zero: Vec<[f32; 3]> = values.iter().copied().chain([[0.0; 3]]).collect();
    bound(&mut accessor, &with_zero);
    let indices: Vec<u8> = moves.iter().flat_map(|(v, _)| (*v as u16).to_le_bytes()).collect();
    let mut view = |bytes: &[u8]| {
        buffer.add(bytes, "SCALAR", UNSIGNED_BYTE, bytes.len(), None);
        buffer.accessors.pop();
        buffer.views.len() - 1
    };
    let indices = view(&indices);
    let bytes: Vec<u8> = values.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    let displacements = view(&bytes);
    accessor["sparse"] = json!({
        "count": moves.len(),
        "indices": {"bufferView": indices, "componentType": UNSIGNED_SHORT},
        "values": {"bufferView": displacements},
    });
    buffer.accessors.push(accessor);
    buffer.accessors.len() - 1
}

fn animation(clip: &SampledClip, buffer: &mut Buffer) -> Value {
    let times: Vec<[f32; 1]> = clip.times.iter().map(|t| [*t]).collect();
    let input = floats(buffer, &times, "SCALAR", None);
    bound(&mut buffer.accessors[input], &times);
    let mut samplers = Vec::new();
    let mut channels = Vec::new();
    let mut channel = |output: usize, node: usize, path: &str| {
        channels.push(json!({"sampler": samplers.len(), "target": {"node": node, "path": path}}));
        samplers.push(json!({"input": input, "output": output, "interpolation": "LINEAR"}));
    };
    let places: Vec<[f32; 3]> = clip.hips.iter().map(Vec3::to_array).collect();
    let places = floats(buffer, &places, "VEC3", None);
    channel(places, 1, "translation");
    for (joint, rotations) in clip.rotations.iter().enumerate() {
        // Neighbouring keys are in the same hemisphere, so that every reader interpolates the short way.
        let mut last = Quat::IDENTITY;
        let keys: Vec<[f32; 4]> = rotations
            .iter()
            .map(|q| {
                last = if q.dot(last) < 0.0 { -*q } else { *q };
                last.to_array()
            })
            .collect();
        let keys = floats(buffer, &keys, "VEC4", None);
        channel(keys, joint + 1, "rotation");
    }
    if !clip.weights.is_empty() {
        let rows: Vec<[f32; 1]> = clip.weights.iter().flatten().map(|w| [*w]).collect();
        let rows = floats(buffer, &rows, "SCALAR", None);
        channel(rows, 0, "weights");
    }
    json!({"name": clip.name, "channels": channels, "samplers": samplers})
}
