//! Characters from glTF 2.0 files.

mod assemble;
mod clip;
mod expressions;
mod material;
mod mesh;
mod mtoon;
mod nodes;
mod skin;
mod textures;
mod vrm;

pub(crate) use clip::UNTIMED;

use std::path::Path;

use lovelock_gltf::Asset;

use crate::character::Character;
use crate::{BodySettings, MotionError};

/// Reads a glTF document. `name` is used in messages. Other files with buffers are searched in `base_dir` and its subfolders, and
/// refused without it. Without `needs_mesh` a file without a body is read too, and meshes are left out.
pub(crate) fn read(
    name: &str,
    bytes: &[u8],
    base_dir: Option<&Path>,
    settings: BodySettings,
    needs_mesh: bool,
) -> Result<Character, MotionError> {
    let asset = Asset::read(name, bytes, base_dir)?;
    let mut character = assemble::assemble(&asset, settings, needs_mesh)?;
    character.format = match vrm::Vrm::of(&asset.document) {
        Some(vrm) => format!("{}, {}", vrm.format, asset.format),
        None => asset.format.to_owned(),
    };
    Ok(character)
}
