//! Writes glTF 2.0 in its binary form: one skinned mesh, a skeleton and clips.

use glam::{Quat, Vec3};
use lovelock_gltf::glb::{
    self, ARRAY_BUFFER, Buffer, ELEMENT_ARRAY_BUFFER, FLOAT, UNSIGNED_BYTE, UNSIGNED_SHORT,
};
use serde_json::{Value, json};

use super::rig::RigJoint;
use super::weights::Influences;

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
}

/// The contents of the file.
pub(super) struct Model {
    /// Its name in the file.
    pub(super) name: &'static str,
    /// Rest positions, metres.
    pub(super) positions: Vec<Vec3>,
    /// Unit normals.
    pub(super) normals: Vec<Vec3>,
    /// Linear sRGB.
    pub(super) colours: Vec<Vec3>,
    /// 1 where hair grows.
    pub(super) scalp: Vec<f32>,
    /// Joints and weights.
    pub(super) influences: Vec<Influences>,
    /// Counter-clockwise triangles.
    pub(super) triangles: Vec<[u32; 3]>,
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
    let primitive = primitive(model, &mut buffer);

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

    let mut document = json!({
        "asset": {"version": "2.0", "generator": "cargo xtask assets"},
        "scene": 0,
        "scenes": [{"name": model.name, "nodes": [0, 1]}],
        "nodes": nodes,
        "meshes": [{"name": model.name, "primitives": [primitive]}],
        "materials": [{
            "name": "matt",
            "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.75},
        }],
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
    let head = glb::head(serde_json::to_vec(&document)?, buffer.len())
        .map_err(|whole| anyhow::anyhow!("a binary glTF file of {whole} bytes; must be less than 4 GiB"))?;
    Ok([head, buffer.into_bytes()].concat())
}

fn primitive(model: &Model, buffer: &mut Buffer) -> Value {
    let count = model.positions.len();
    let positions: Vec<[f32; 3]> = model.positions.iter().map(Vec3::to_array).collect();
    let position = floats(buffer, &positions, "VEC3", Some(ARRAY_BUFFER));
    bound(&mut buffer.accessors[position], &positions);
    let normals: Vec<[f32; 3]> = model.normals.iter().map(Vec3::to_array).collect();
    let normal = floats(buffer, &normals, "VEC3", Some(ARRAY_BUFFER));
    let colours: Vec<u8> = model
        .colours
        .iter()
        .flat_map(|c| [c.x, c.y, c.z, 1.0])
        .flat_map(|v| ((v.clamp(0.0, 1.0) * 65535.0).round() as u16).to_le_bytes())
        .collect();
    let colour = buffer.add(&colours, "VEC4", UNSIGNED_SHORT, count, Some(ARRAY_BUFFER));
    buffer.accessors[colour]["normalized"] = json!(true);
    let scalp: Vec<[f32; 1]> = model.scalp.iter().map(|v| [*v]).collect();
    let scalp = floats(buffer, &scalp, "SCALAR", Some(ARRAY_BUFFER));
    let joints: Vec<u8> = model.influences.iter().flatten().map(|(joint, _)| *joint).collect();
    let joints = buffer.add(&joints, "VEC4", UNSIGNED_BYTE, count, Some(ARRAY_BUFFER));
    let weights: Vec<u8> = model.influences.iter().flatten().flat_map(|(_, w)| w.to_le_bytes()).collect();
    let weights = buffer.add(&weights, "VEC4", UNSIGNED_SHORT, count, Some(ARRAY_BUFFER));
    buffer.accessors[weights]["normalized"] = json!(true);
    let indices: Vec<u8> = model.triangles.iter().flatten().flat_map(|i| (*i as u16).to_le_bytes()).collect();
    let indices =
        buffer.add(&indices, "SCALAR", UNSIGNED_SHORT, model.triangles.len() * 3, Some(ELEMENT_ARRAY_BUFFER));
    json!({
        "attributes": {
            "POSITION": position, "NORMAL": normal, "COLOR_0": colour, "_SCALP": scalp,
            "JOINTS_0": joints, "WEIGHTS_0": weights,
        },
        "indices": indices,
        "material": 0,
    })
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
    json!({"name": clip.name, "channels": channels, "samplers": samplers})
}
