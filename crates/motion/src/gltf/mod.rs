//! Characters from glTF 2.0 files.
//!
//! The document is parsed leniently, and every index, offset and count is checked in 64 bits before use. A
//! validating reader would refuse files that are legal (accessors without bytes, quantised meshes) or that
//! only lack a texture.

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

/// Largest file, and largest total size of buffers, that is read.
const FILE_LIMIT: u64 = 2 << 30;

/// The extension for meshes compressed with Draco.
const DRACO: &str = "KHR_draco_mesh_compression";

/// A character file: a body, its clips, and what was lost.
#[derive(Clone, Debug, Default)]
pub struct Character {
    /// The body.
    pub body: Arc<Body>,
    /// Its clips; may be empty.
    pub clips: Vec<Arc<Clip>>,
    /// Counts of what was left out; empty if everything was read.
    pub dropped: BTreeMap<String, u64>,
    /// Guesses and other remarks, as sentences.
    pub notes: Vec<String>,
    /// The format, such as `glTF 2.0 (binary)`.
    pub format: String,
    /// Joints used by skins; all nodes with meshes if there is no skin.
    pub joints: usize,
    /// Number of skins.
    pub skins: usize,
    /// Metres per unit of the file.
    pub unit_metres: f32,
}

/// Loads a `.glb` or `.gltf` file with automatic unit and axis.
///
/// # Errors
/// If the file cannot be read, is truncated, refers outside itself or its folder, needs an unsupported
/// extension, or contains no triangle.
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

/// Loads a character from bytes. `name` is used in messages. Other files with buffers are searched in
/// `base_dir` and its subfolders, and refused without it.
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
        MotionError::malformed(name, "the JSON text", format!("{e}; must be a glTF 2.0 document"))
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
    KNOWN.contains(&extension) || extension.starts_with("KHR_materials_")
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
