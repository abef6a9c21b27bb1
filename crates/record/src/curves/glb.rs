//! glTF 2 in one file: the curves as lines, the body as a skinned mesh.
//!
//! Viewers apply skinning to triangles only, so lines cannot be attached to joints. Each frame of the curves is a separate
//! mesh with its own node, and an animation shows one after another by stepping the scale of its node from 0 to 1 and back. The
//! points are exact at every frame, and every viewer that plays node animations shows them.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use glam::{Affine3A, Mat4, Quat, Vec2, Vec3};
use lovelock_gltf::glb::{
    self, ARRAY_BUFFER, Buffer, ELEMENT_ARRAY_BUFFER, FLOAT, UNSIGNED_INT, UNSIGNED_SHORT,
};
use serde_json::{Value, json};

use super::gltf_look::GltfLook;
use super::gltf_morphs;
use super::spool::{Spool, bounds};
use super::{CurveBody, CurveFrame, CurveReport, CurveScene};
use crate::RecordError;
use crate::partial::{Opener, PartialFile};

/// Mode of a primitive: separate lines.
const LINES: u32 = 1;

pub(super) struct GlbWriter {
    target: PathBuf,
    file: PartialFile,
    scene: CurveScene,
    spool: Spool,
    /// Bounding box of the curves in each frame.
    boxes: Vec<[[f32; 3]; 2]>,
    /// Transform from each joint to the world, frame after frame.
    joints: Vec<Affine3A>,
    /// Weights of the morph targets, frame after frame.
    weights: Vec<f32>,
}

impl GlbWriter {
    pub(super) fn create(path: &Path, scene: CurveScene, opener: &Opener) -> Result<Self, RecordError> {
        let file = PartialFile::create(path, opener)
            .map_err(|error| RecordError::io(path, "create the file", error))?;
        let spool = Spool::create(path, &scene, false)?;
        let target = path.to_owned();
        Ok(Self { target, file, scene, spool, boxes: Vec::new(), joints: Vec::new(), weights: Vec::new() })
    }

    pub(super) fn push(&mut self, frame: &CurveFrame<'_>) -> Result<(), RecordError> {
        let wanted = self.scene.body.as_ref().map_or(0, |body| body.joint_from_bind.len());
        let joints = frame.body.map_or(&[][..], |body| body.joints);
        if self.scene.body.is_some() && joints.len() != wanted {
            return Err(RecordError::request(format!(
                "{}: a body of {} joints; must have {wanted}",
                self.target.display(),
                joints.len()
            )));
        }
        self.spool.push(frame)?;
        let [x, y, z] = frame.points;
        self.boxes.push(bounds((0..x.len()).map(|i| [x[i], y[i], z[i]])));
        if let Some(body) = &self.scene.body {
            self.joints.extend_from_slice(joints);
            let weights = frame.body.map_or(&[][..], |body| body.morph_weights);
            let weight = |morph: usize| weights.get(morph).copied().filter(|weight| weight.is_finite());
            self.weights.extend((0..body.morphs.len()).map(|morph| weight(morph).unwrap_or(0.0)));
        }
        Ok(())
    }

    pub(super) fn finish(mut self) -> Result<CurveReport, RecordError> {
        self.spool.close()?;
        let frames = self.spool.frames;
        let points = self.scene.points();
        let spooled = 12 * points as u64 * frames;
        let mut asset = Asset::new(spooled);
        asset.hair(&self.scene, &self.boxes);
        if let Some(body) = &self.scene.body {
            asset.look = GltfLook::new(body, &mut asset.buffer)
                .map_err(|error| RecordError::io(&self.target, "write the images", error))?;
            asset.body(body, (&self.joints, &self.weights), &self.scene);
        }
        let head = glb::head(asset.json(), asset.buffer.len()).map_err(|whole| {
            RecordError::request(format!(
                "{}: {whole} bytes; a binary glTF has at most {}: write fewer frames",
                self.target.display(),
                u32::MAX
            ))
        })?;
        let rest = asset.buffer.into_bytes();
        let bytes = head.len() as u64 + spooled + rest.len() as u64;
        let (file, spool) = (&mut self.file, &mut self.spool);
        let mut write = || -> io::Result<()> {
            file.write_all(&head)?;
            let mut row = vec![[0.0; 3]; points];
            for frame in 0..frames {
                spool.read(frame, 0, &mut row)?;
                file.write_all(bytemuck::cast_slice(&row))?;
            }
            file.write_all(&rest)
        };
        let target = &self.target;
        let failed = |error| RecordError::io(target, "write the file", error);
        write().map_err(failed)?;
        self.file.commit(true).map_err(failed)?;
        Ok(CurveReport { frames, bytes })
    }
}

/// A glTF asset that is being built. Its buffer begins with the curves' points, frame after frame, which are not
/// in memory.
struct Asset {
    buffer: Buffer,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
    roots: Vec<usize>,
    skins: Vec<Value>,
    samplers: Vec<Value>,
    channels: Vec<Value>,
    look: GltfLook,
}

impl Asset {
    fn new(spooled: u64) -> Self {
        let mut buffer = Buffer::after(spooled);
        buffer.views.push(json!({
            "buffer": 0, "byteOffset": 0, "byteLength": spooled, "byteStride": 12, "target": ARRAY_BUFFER,
            "name": "points of the hair, frame after frame",
        }));
        Self {
            buffer,
            meshes: Vec::new(),
            nodes: Vec::new(),
            roots: Vec::new(),
            skins: Vec::new(),
            samplers: Vec::new(),
            channels: Vec::new(),
            look: GltfLook::default(),
        }
    }

    /// Appends an array to the buffer. Returns the index of its accessor.
    fn array<T: bytemuck::NoUninit>(
        &mut self,
        values: &[T],
        component: u32,
        kind: &str,
        target: Option<u32>,
        more: Value,
    ) -> usize {
        let accessor = self.buffer.add(bytemuck::cast_slice(values), kind, component, values.len(), target);
        merge(&mut self.buffer.accessors[accessor], more);
        accessor
    }

    /// Adds the times and values of an animated property of a node.
    fn animate(&mut self, node: usize, property: &str, interpolation: &str, input: usize, output: usize) {
        self.samplers.push(json!({ "input": input, "output": output, "interpolation": interpolation }));
        let target = json!({ "node": node, "path": property });
        self.channels.push(json!({ "sampler": self.samplers.len() - 1, "target": target }));
    }

    fn hair(&mut self, scene: &CurveScene, boxes: &[[[f32; 3]; 2]]) {
        let points = scene.points();
        let mut segments: Vec<u32> = Vec::with_capacity(2 * points);
        for &[start, end] in scene.first_point.array_windows() {
            segments.extend((start + 1..end).flat_map(|point| [point - 1, point]));
        }
        let segments = self.array(&segments, UNSIGNED_INT, "SCALAR", Some(ELEMENT_ARRAY_BUFFER), Value::Null);
        let colors = self.colors(&scene.colors, &[]);
        // glTF has no width of lines; several programs read half the width from this attribute.
        let radii: Vec<f32> = scene.widths.iter().map(|width| 0.5 * width).collect();
        let radii = self.array(&radii, FLOAT, "SCALAR", Some(ARRAY_BUFFER), Value::Null);
        // Scales of a node: hidden, shown while its frame lasts, hidden.
        let shown = |keys: &[f32]| keys.iter().map(|&key| [key; 3]).collect::<Vec<_>>();
        let [at_first, at_last, between] = [&[1.0, 0.0][..], &[0.0, 1.0], &[0.0, 1.0, 0.0]]
            .map(|keys| self.array(&shown(keys), FLOAT, "VEC3", None, Value::Null));
        let frames = boxes.len();
        let mut children = Vec::with_capacity(frames);
        for (frame, [low, high]) in boxes.iter().enumerate() {
            self.buffer.accessors.push(json!({
                "bufferView": 0, "byteOffset": 12 * points as u64 * frame as u64,
                "componentType": FLOAT, "count": points, "type": "VEC3", "min": low, "max": high,
            }));
            let positions = self.buffer.accessors.len() - 1;
            let number = scene.first_frame + frame as u64;
            self.meshes.push(json!({
                "name": format!("Hair of frame {number}"),
                "primitives": [{
                    "mode": LINES, "indices": segments, "material": 0,
                    "attributes": { "POSITION": positions, "COLOR_0": colors, "_RADIUS": radii },
                }],
            }));
            let mut node = json!({ "name": format!("Hair {number}"), "mesh": self.meshes.len() - 1 });
            if frame > 0 {
                // Viewers without animation show the first frame.
                node["scale"] = json!([0, 0, 0]);
            }
            self.nodes.push(node);
            let node = self.nodes.len() - 1;
            children.push(node);
            if frames == 1 {
                continue;
            }
            let (now, next) = (secs(scene, frame), secs(scene, frame + 1));
            let (times, values) = match frame {
                0 => (vec![0.0, next], at_first),
                last if last + 1 == frames => (vec![0.0, now], at_last),
                _ => (vec![0.0, now, next], between),
            };
            let times = self.times(&times);
            self.animate(node, "scale", "STEP", times, values);
        }
        self.nodes.push(json!({ "name": "Hair", "children": children }));
        self.roots.push(self.nodes.len() - 1);
    }

    fn body(&mut self, body: &CurveBody, (transforms, weights): (&[Affine3A], &[f32]), scene: &CurveScene) {
        let vectors = |vectors: &[Vec3]| vectors.iter().map(Vec3::to_array).collect::<Vec<_>>();
        let positions = vectors(&body.bind_positions);
        let [low, high] = bounds(positions.iter().copied());
        let attributes = Some(ARRAY_BUFFER);
        let position = self.array(&positions, FLOAT, "VEC3", attributes, json!({ "min": low, "max": high }));
        let normals: Vec<Vec3> =
            body.bind_normals.iter().map(|normal| normal.normalize_or(Vec3::Y)).collect();
        let normal = self.array(&vectors(&normals), FLOAT, "VEC3", attributes, Value::Null);
        let color = self.colors(&body.colors, &body.opacity);
        let mut set = json!({ "POSITION": position, "NORMAL": normal, "COLOR_0": color });
        for (number, coordinates) in body.coordinates.iter().enumerate().filter(|(_, set)| !set.is_empty()) {
            let coordinates: Vec<[f32; 2]> = coordinates.iter().map(Vec2::to_array).collect();
            let accessor = self.array(&coordinates, FLOAT, "VEC2", attributes, Value::Null);
            set[format!("TEXCOORD_{number}")] = accessor.into();
        }
        let halves =
            1 + usize::from(body.weights.iter().any(|weights| weights[4..].iter().any(|&w| w > 0.0)));
        for half in 0..halves {
            let at = 4 * half;
            let weights: Vec<[f32; 4]> =
                body.weights.iter().map(|all| [all[at], all[at + 1], all[at + 2], all[at + 3]]).collect();
            let joints = body.joints.iter().zip(&weights).map(|(all, weights)| {
                // glTF requires index 0 for joints without weight.
                std::array::from_fn::<u16, 4, _>(|k| if weights[k] > 0.0 { all[at + k] } else { 0 })
            });
            let joints: Vec<_> = joints.collect();
            let joints = self.array(&joints, UNSIGNED_SHORT, "VEC4", attributes, Value::Null);
            let weights = self.array(&weights, FLOAT, "VEC4", attributes, Value::Null);
            (set[format!("JOINTS_{half}")], set[format!("WEIGHTS_{half}")]) = (joints.into(), weights.into());
        }
        let targets = gltf_morphs::targets(&body.morphs, positions.len(), &mut self.buffer);
        let mut primitives = Vec::new();
        for (material, triangles) in body.parts() {
            let corners: Vec<[u32; 3]> = triangles.iter().map(|&t| body.triangles[t]).collect();
            let target = Some(ELEMENT_ARRAY_BUFFER);
            let corners = self.array(corners.as_flattened(), UNSIGNED_INT, "SCALAR", target, Value::Null);
            // The first material is that of the hair.
            let material = 1 + material.unwrap_or(0);
            let mut primitive = json!({ "attributes": set, "indices": corners, "material": material });
            if !targets.is_empty() {
                primitive["targets"] = json!(targets);
            }
            primitives.push(primitive);
        }
        let mut written = json!({ "name": "Body", "primitives": primitives });
        let morphs = body.morphs.len();
        if morphs > 0 {
            written["weights"] = json!(weights.get(..morphs));
            let names: Vec<&str> = body.morphs.iter().map(|morph| morph.name.as_str()).collect();
            written["extras"] = json!({ "targetNames": names });
        }
        self.meshes.push(written);
        let mesh = self.meshes.len() - 1;

        let count = body.joint_from_bind.len();
        let inverse: Vec<Mat4> = body.joint_from_bind.iter().map(|&bind| Mat4::from(bind)).collect();
        let inverse: Vec<[f32; 16]> = inverse.iter().map(Mat4::to_cols_array).collect();
        let inverse = self.array(&inverse, FLOAT, "MAT4", None, Value::Null);
        let frames = transforms.len() / count.max(1);
        let times: Vec<f32> = (0..frames).map(|frame| secs(scene, frame)).collect();
        let input = (frames > 1).then(|| self.times(&times));
        let first = self.nodes.len();
        for joint in 0..count {
            let mut keys = Keys::default();
            for frame in 0..frames {
                keys.push(&transforms[frame * count + joint]);
            }
            self.nodes.push(json!({
                "name": format!("Joint {joint}"), "translation": keys.translations[0],
                "rotation": keys.rotations[0], "scale": keys.scales[0],
            }));
            let Some(input) = input else { continue };
            let node = first + joint;
            let output = self.array(&keys.translations, FLOAT, "VEC3", None, Value::Null);
            self.animate(node, "translation", "LINEAR", input, output);
            let output = self.array(&keys.rotations, FLOAT, "VEC4", None, Value::Null);
            self.animate(node, "rotation", "LINEAR", input, output);
            if keys.scales.iter().any(|scale| *scale != keys.scales[0]) {
                let output = self.array(&keys.scales, FLOAT, "VEC3", None, Value::Null);
                self.animate(node, "scale", "LINEAR", input, output);
            }
        }
        let joints: Vec<usize> = (first..first + count).collect();
        self.nodes.push(json!({ "name": "Joints", "children": joints }));
        let skeleton = self.nodes.len() - 1;
        self.skins.push(json!({ "joints": joints, "inverseBindMatrices": inverse, "skeleton": skeleton }));
        self.nodes.push(json!({ "name": "Body", "mesh": mesh, "skin": 0 }));
        let moves = weights.chunks(morphs.max(1)).any(|frame| !weights.starts_with(frame));
        if let (Some(input), true) = (input, moves) {
            let output = self.array(weights, FLOAT, "SCALAR", None, Value::Null);
            self.animate(skeleton + 1, "weights", "LINEAR", input, output);
        }
        self.roots.extend([skeleton, skeleton + 1]);
    }

    fn times(&mut self, times: &[f32]) -> usize {
        let range = json!({ "min": [times[0]], "max": [times[times.len() - 1]] });
        self.array(times, FLOAT, "SCALAR", None, range)
    }

    /// Colours with their opacity, which is 1 where the list is empty.
    fn colors(&mut self, colors: &[Vec3], opacity: &[f32]) -> usize {
        let short = |v: f32| (v.clamp(0.0, 1.0) * 65535.0).round() as u16;
        let colors: Vec<[u16; 4]> = colors
            .iter()
            .enumerate()
            .map(|(i, c)| [short(c.x), short(c.y), short(c.z), short(opacity.get(i).copied().unwrap_or(1.0))])
            .collect();
        self.array(&colors, UNSIGNED_SHORT, "VEC4", Some(ARRAY_BUFFER), json!({ "normalized": true }))
    }

    fn json(&self) -> Vec<u8> {
        let mut asset = json!({
            "asset": { "version": "2.0", "generator": concat!("Lovelock ", env!("CARGO_PKG_VERSION")) },
            "extensionsUsed": ["KHR_materials_unlit"],
            "scene": 0,
            "scenes": [{ "nodes": self.roots }],
            "nodes": self.nodes,
            "meshes": self.meshes,
            "materials": [
                // Lines have no normals, so they cannot be lit.
                { "name": "Hair", "extensions": { "KHR_materials_unlit": {} } },
                { "name": "Body", "pbrMetallicRoughness": { "metallicFactor": 0.0, "roughnessFactor": 0.8 } },
            ],
            "accessors": self.buffer.accessors,
            "bufferViews": self.buffer.views,
            "buffers": [{ "byteLength": self.buffer.len() }],
        });
        if !self.look.materials.is_empty()
            && let Some(materials) = asset["materials"].as_array_mut()
        {
            materials.truncate(1);
            materials.extend_from_slice(&self.look.materials);
        }
        for (name, list) in [
            ("textures", &self.look.textures),
            ("samplers", &self.look.samplers),
            ("images", &self.look.images),
        ] {
            if !list.is_empty() {
                asset[name] = json!(list);
            }
        }
        if let Some(used) = asset["extensionsUsed"].as_array_mut() {
            used.extend(self.look.extensions.iter().map(|&name| name.into()));
        }
        if self.skins.is_empty() {
            // Validators report unused materials.
            if let Some(materials) = asset["materials"].as_array_mut() {
                materials.truncate(1);
            }
        } else {
            asset["skins"] = json!(self.skins);
        }
        if !self.channels.is_empty() {
            let dance = json!({ "name": "Dance", "samplers": self.samplers, "channels": self.channels });
            asset["animations"] = json!([dance]);
        }
        asset.to_string().into_bytes()
    }
}

/// Animation keys of one joint.
#[derive(Default)]
struct Keys {
    translations: Vec<[f32; 3]>,
    rotations: Vec<[f32; 4]>,
    scales: Vec<[f32; 3]>,
}

impl Keys {
    fn push(&mut self, transform: &Affine3A) {
        let (scale, rotation, translation) = transform.to_scale_rotation_translation();
        let mut rotation = rotation.normalize();
        // Of the two quaternions of a rotation, the one nearer to the key before, because viewers interpolate between them.
        if self.rotations.last().is_some_and(|&last| Quat::from_array(last).dot(rotation) < 0.0) {
            rotation = -rotation;
        }
        self.translations.push(translation.to_array());
        self.rotations.push(rotation.to_array());
        // Rounding errors of a scale of 1 would otherwise become an animation.
        let round = |s: f32| if (s - 1.0).abs() < 1e-5 { 1.0 } else { s };
        self.scales.push(scale.to_array().map(round));
    }
}

/// Time of a frame in seconds after the first.
fn secs(scene: &CurveScene, frame: usize) -> f32 {
    (frame as f64 / scene.rate.as_f64()) as f32
}

fn merge(into: &mut Value, more: Value) {
    if let (Some(into), Value::Object(more)) = (into.as_object_mut(), more) {
        into.extend(more);
    }
}
