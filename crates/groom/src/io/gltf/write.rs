//! Writes hair as lines of glTF: one primitive whose indices follow the strands, with widths as `_RADIUS`.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use lovelock_gltf::glb::{
    self, ARRAY_BUFFER, Buffer, ELEMENT_ARRAY_BUFFER, FLOAT, UNSIGNED_INT, UNSIGNED_SHORT,
};
use serde_json::{Value, json};

use super::LINES;
use crate::io::bytes::triple_bytes;
use crate::io::file::HairFile;
use crate::io::units::linear_from_display;

/// A `.glb`.
pub(super) fn binary(hair: &HairFile) -> Result<Vec<u8>, String> {
    let (document, buffer) = asset(hair, None);
    let length = buffer.len() as u64;
    let mut out = glb::head(document.to_string().into_bytes(), length)
        .map_err(|whole| format!("{whole} bytes; a binary glTF has at most {}", u32::MAX))?;
    out.extend(buffer);
    Ok(out)
}

/// A `.gltf` with its buffer as a data URI.
#[expect(clippy::unnecessary_wraps, reason = "the signature of all writers")]
pub(super) fn text(hair: &HairFile) -> Result<Vec<u8>, String> {
    let (document, _) = asset(hair, Some("data:application/octet-stream;base64,"));
    Ok(document.to_string().into_bytes())
}

/// The document and its buffer; with `uri`, the document contains the buffer as base64 after these words.
fn asset(hair: &HairFile, uri: Option<&str>) -> (Value, Vec<u8>) {
    let points = hair.points.len();
    let mut buffer = Buffer::default();
    let positions: Vec<u8> = hair.points.iter().flat_map(|&point| triple_bytes(point)).collect();
    let position = buffer.add(&positions, "VEC3", FLOAT, points, Some(ARRAY_BUFFER));
    // Required of positions.
    buffer.accessors[position]["min"] = json!(hair.bounds.min.to_array());
    buffer.accessors[position]["max"] = json!(hair.bounds.max.to_array());
    drop(positions);
    let mut attributes = json!({ "POSITION": position });
    let widths = |at: usize| match (&hair.thickness, hair.default_thickness) {
        (Some(widths), _) => Some(widths[at]),
        (None, width) => width.filter(|width| *width > 0.0),
    };
    if widths(0).is_some() {
        let radii = (0..points).flat_map(|at| (0.5 * widths(at).unwrap_or_default()).to_le_bytes());
        let radii: Vec<u8> = radii.collect();
        attributes["_RADIUS"] = buffer.add(&radii, "SCALAR", FLOAT, points, Some(ARRAY_BUFFER)).into();
    }
    if let Some(colours) = &hair.colours {
        let short = |v: f32| ((linear_from_display(v) * 65535.0).round() as u16).to_le_bytes();
        let rows = colours.iter().flat_map(|&[r, g, b]| [short(r), short(g), short(b), [255; 2]]);
        let rows: Vec<u8> = rows.flatten().collect();
        let color = buffer.add(&rows, "VEC4", UNSIGNED_SHORT, points, Some(ARRAY_BUFFER));
        buffer.accessors[color]["normalized"] = true.into();
        attributes["COLOR_0"] = color.into();
    }
    let mut indices = Vec::with_capacity(8 * hair.segments());
    for [start, end] in hair.first_point.array_windows() {
        indices.extend((start + 1..*end).flat_map(|point| [point - 1, point]).flat_map(u32::to_le_bytes));
    }
    let indices =
        buffer.add(&indices, "SCALAR", UNSIGNED_INT, 2 * hair.segments(), Some(ELEMENT_ARRAY_BUFFER));
    let (views, accessors) = (std::mem::take(&mut buffer.views), std::mem::take(&mut buffer.accessors));
    let bytes = buffer.into_bytes();
    let mut storage = json!({ "byteLength": bytes.len() });
    if let Some(uri) = uri {
        storage["uri"] = format!("{uri}{}", STANDARD.encode(&bytes)).into();
    }
    let document = json!({
        "asset": { "version": "2.0", "generator": concat!("Lovelock ", env!("CARGO_PKG_VERSION")) },
        "extensionsUsed": ["KHR_materials_unlit"],
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "name": "Hair", "mesh": 0 }],
        "meshes": [{ "name": "Hair", "primitives": [{
            "mode": LINES, "indices": indices, "material": 0, "attributes": attributes,
        }] }],
        // Lines have no normals, so they cannot be lit.
        "materials": [{ "name": "Hair", "extensions": { "KHR_materials_unlit": {} } }],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [storage],
    });
    (document, bytes)
}
