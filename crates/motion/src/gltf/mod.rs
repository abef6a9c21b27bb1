//! Characters from glTF 2.0 files.
//!
//! The document is parsed leniently, and every index, offset and count is checked in 64 bits before use. A
//! validating reader would refuse files that are legal (accessors without bytes, quantised meshes) or that
//! only lack a texture.

mod accessor;
mod assemble;
mod buffers;
mod clip;
mod document;
mod mesh;
mod nodes;
mod skin;
mod vrm;

use std::path::Path;

pub use buffers::gltf_reference;

use crate::character::Character;
use crate::{BodySettings, MotionError};

/// Largest total size of buffers that is read.
const BUFFER_LIMIT: u64 = 2 << 30;

/// The extension for meshes compressed with Draco.
const DRACO: &str = "KHR_draco_mesh_compression";

/// Reads a glTF document. `name` is used in messages. Other files with buffers are searched in `base_dir` and its subfolders, and
/// refused without it. Without `needs_mesh` a file without a body is read too, and meshes are left out.
pub(crate) fn read(
    name: &str,
    bytes: &[u8],
    base_dir: Option<&Path>,
    settings: BodySettings,
    needs_mesh: bool,
) -> Result<Character, MotionError> {
    let container = buffers::open(name, bytes)?;
    let document: document::Document = serde_json::from_slice(container.json).map_err(|e| {
        MotionError::malformed(name, "the JSON text", format!("{e}; must be a glTF 2.0 document"))
    })?;
    for extension in &document.extensions_required {
        if !is_harmless(extension) {
            return Err(refuse(name, extension));
        }
    }
    let buffers = buffers::load(name, &document, container.bin, base_dir)?;
    let accessors = accessor::Accessors::new(name, &document, &buffers);
    let mut character = assemble::assemble(&accessors, settings, needs_mesh)?;
    character.format = match vrm::Vrm::of(&document) {
        Some(vrm) => format!("{}, {}", vrm.format, container.format),
        None => container.format.to_owned(),
    };
    Ok(character)
}

/// Required extensions that are supported or do not affect shape and motion.
fn is_harmless(extension: &str) -> bool {
    const KNOWN: [&str; 9] = [
        "KHR_mesh_quantization",
        "KHR_texture_transform",
        "KHR_texture_basisu",
        "KHR_lights_punctual",
        "KHR_xmp_json_ld",
        "KHR_node_visibility",
        "EXT_texture_webp",
        "EXT_texture_avif",
        "MSFT_texture_dds",
    ];
    KNOWN.contains(&extension) || ["KHR_materials_", "VRM"].iter().any(|prefix| extension.starts_with(prefix))
}

/// The error for an unsupported extension, with advice.
fn refuse(file: &str, extension: &str) -> MotionError {
    let advice = if extension == DRACO {
        "export it again without Draco compression"
    } else if extension.ends_with("_meshopt_compression") {
        "export it again without meshopt compression (gltfpack: leave out -c and -cc)"
    } else {
        "export it again without that extension"
    };
    MotionError::Extension { file: file.to_owned(), extension: extension.to_owned(), advice }
}
