//! Characters from glTF 2.0 files.
//!
//! The document is parsed leniently and every index, offset and count is checked here, in 64 bits, before it is
//! used; a validating reader would refuse files that are legal (accessors without bytes, quantised meshes) or that
//! only lack a picture.

mod accessor;
mod assemble;
mod axes;
mod buffers;
mod clip;
mod document;
mod mesh;
mod nodes;
mod normals;
mod skin;

use std::{collections::BTreeMap, path::Path, sync::Arc};

pub use buffers::gltf_reference;

use crate::{Body, BodySettings, Clip, MotionError, error::read_file};

/// Largest file, and largest sum of buffers, that is read.
const FILE_LIMIT: u64 = 2 << 30;

/// The extension that Google's compressor writes.
const DRACO: &str = "KHR_draco_mesh_compression";

/// A character file: a body, its clips, and what was lost on the way.
#[derive(Clone, Debug, Default)]
pub struct Character {
    /// What moves.
    pub body: Arc<Body>,
    /// How it can move; may be empty.
    pub clips: Vec<Arc<Clip>>,
    /// What was left out, with counts; empty where all was read.
    pub dropped: BTreeMap<String, u64>,
    /// Guesses made and other things to know, as sentences.
    pub notes: Vec<String>,
    /// The format, such as `glTF 2.0 (binary)`.
    pub format: String,
    /// Joints that skins use; all nodes that carry meshes where there is no skin.
    pub joints: usize,
    /// Number of skins.
    pub skins: usize,
    /// Metres of one unit of the file.
    pub unit_metres: f32,
}

/// Loads a `.glb` or `.gltf` file with automatic unit and axis.
///
/// # Errors
/// Refuses what cannot be read, is cut short, points outside itself or its folder, needs an extension that is not
/// read here, or holds no triangle.
pub fn load_character(path: &Path) -> Result<Character, MotionError> {
    load_character_with(path, BodySettings::default())
}

/// Loads a `.glb` or `.gltf` file.
///
/// # Errors
/// As [`load_character`].
pub fn load_character_with(path: &Path, settings: BodySettings) -> Result<Character, MotionError> {
    let bytes = read_file(path, FILE_LIMIT)?;
    load_character_bytes_with(&path.display().to_string(), &bytes, path.parent(), settings)
}

/// Loads a character from bytes. `name` is what messages call it; buffers in other files are looked for in
/// `base_dir` and below, and refused where there is none.
///
/// # Errors
/// As [`load_character`].
pub fn load_character_bytes(
    name: &str,
    bytes: &[u8],
    base_dir: Option<&Path>,
) -> Result<Character, MotionError> {
    load_character_bytes_with(name, bytes, base_dir, BodySettings::default())
}

/// Loads a character from bytes with a chosen unit and axis.
///
/// # Errors
/// As [`load_character`].
pub fn load_character_bytes_with(
    name: &str,
    bytes: &[u8],
    base_dir: Option<&Path>,
    settings: BodySettings,
) -> Result<Character, MotionError> {
    let container = buffers::open(name, bytes)?;
    let document: document::Document = serde_json::from_slice(container.json).map_err(|e| {
        MotionError::malformed(name, "the JSON text", format!("{e}; wanted a glTF 2.0 document"))
    })?;
    for extension in &document.extensions_required {
        if !is_harmless(extension) {
            return Err(refuse(name, extension));
        }
    }
    let buffers = buffers::load(name, &document, container.bin, base_dir)?;
    let accessors = accessor::Accessors::new(name, &document, &buffers);
    let mut character = assemble::assemble(&accessors, settings)?;
    container.format.clone_into(&mut character.format);
    Ok(character)
}

/// Extensions that a file may require and that change nothing about shape and motion, or that are read.
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
    KNOWN.contains(&extension) || extension.starts_with("KHR_materials_")
}

/// The refusal of an extension, with what to do about it.
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
