//! Morph targets of the exported body in glTF. Each moves few vertices, so its accessors are sparse.

use std::collections::BTreeMap;

use glam::Vec3;
use lovelock_gltf::glb::{Buffer, FLOAT, UNSIGNED_INT};
use lovelock_motion::MorphTarget;
use serde_json::{Value, json};

use super::spool::bounds;

/// Writes morph targets into a buffer. Returns the `targets` that every primitive with these vertices has.
pub(super) fn targets(morphs: &[MorphTarget], vertices: usize, buffer: &mut Buffer) -> Vec<Value> {
    morphs.iter().map(|morph| target(morph, vertices, buffer)).collect()
}

fn target(morph: &MorphTarget, vertices: usize, buffer: &mut Buffer) -> Value {
    // Indices must rise strictly.
    let mut moved: BTreeMap<u32, (Vec3, Vec3)> = BTreeMap::new();
    for ((&vertex, &position), &normal) in morph.vertices.iter().zip(&morph.positions).zip(&morph.normals) {
        if (vertex as usize) < vertices {
            let sum = moved.entry(vertex).or_default();
            *sum = (sum.0 + position, sum.1 + normal);
        }
    }
    if moved.is_empty() {
        // A sparse accessor has at least one element.
        moved.insert(0, (Vec3::ZERO, Vec3::ZERO));
    }
    let indices: Vec<u32> = moved.keys().copied().collect();
    let indices = buffer.add_bytes(bytemuck::cast_slice(&indices));
    let mut sparse = |values: Vec<[f32; 3]>| {
        let view = buffer.add_bytes(bytemuck::cast_slice(&values));
        // All other vertices have 0.
        let [low, high] = bounds(values.iter().copied().chain([[0.0; 3]]));
        buffer.accessors.push(json!({
            "componentType": FLOAT, "count": vertices, "type": "VEC3", "min": low, "max": high,
            "sparse": {
                "count": values.len(),
                "indices": { "bufferView": indices, "componentType": UNSIGNED_INT },
                "values": { "bufferView": view },
            },
        }));
        buffer.accessors.len() - 1
    };
    let positions = sparse(moved.values().map(|(position, _)| position.to_array()).collect());
    let normals = sparse(moved.values().map(|(_, normal)| normal.to_array()).collect());
    json!({ "POSITION": positions, "NORMAL": normals })
}
