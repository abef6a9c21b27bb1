//! Recognises the format of a file by its first bytes and calls its reader.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use lovelock_base::watch::Watch;

use crate::character::Character;
use crate::content::FigureContent;
use crate::error::read_file;
use crate::recorded::motion_of;
use crate::{BodySettings, MotionError, MotionFile, MotionSettings, bvh, fbx, gltf, usd, vmd};

/// Size of the largest file that is read.
const FILE_LIMIT: u64 = 2 << 30;

/// What an FBX or USD file contains; `None` for a file of another format.
///
/// # Errors
/// For a file that cannot be read.
pub fn figure_content(path: &Path) -> Result<Option<FigureContent>, MotionError> {
    let file = path.display().to_string();
    let cannot_read = |source| MotionError::Read { file: file.clone(), source };
    let mut opened = File::open(path).map_err(cannot_read)?;
    let mut start = Vec::new();
    opened.by_ref().take(8).read_to_end(&mut start).map_err(cannot_read)?;
    if usd::is_crate(&start) {
        let length = opened.metadata().map_err(cannot_read)?.len();
        return usd::crate_content(&file, opened, length).map(Some);
    }
    let bytes = read_file(path, FILE_LIMIT)?;
    if fbx::is_fbx(&bytes) {
        fbx::content(&file, &bytes).map(Some)
    } else if usd::is_usd(&bytes) {
        usd::content(&file, &bytes).map(Some)
    } else {
        Ok(None)
    }
}

/// Loads a character with automatic unit and axes: glTF, VRM, FBX or USD.
///
/// # Errors
/// If the file cannot be read, is truncated, refers outside itself or its folder, needs an unsupported
/// extension, or contains no triangle.
pub fn load_character(path: &Path) -> Result<Character, MotionError> {
    load_character_with(path, BodySettings::default())
}

/// Loads a character.
///
/// # Errors
/// As [`load_character`].
pub fn load_character_with(path: &Path, settings: BodySettings) -> Result<Character, MotionError> {
    load_character_watched(path, settings, &Watch::default())
}

/// As [`load_character_with`]. Reports to `watch`, and stops when it says so.
///
/// # Errors
/// As [`load_character`], and if the load is cancelled.
pub fn load_character_watched(
    path: &Path,
    settings: BodySettings,
    watch: &Watch,
) -> Result<Character, MotionError> {
    let bytes = read_file(path, FILE_LIMIT)?;
    read_figure((&path.display().to_string(), watch), &bytes, path.parent(), settings, true)
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
    read_figure((name, &Watch::default()), bytes, base_dir, settings, true)
}

/// Reads a character, or with `needs_mesh` unset the joints and clips of a file that may have no mesh.
fn read_figure(
    (name, watch): (&str, &Watch),
    bytes: &[u8],
    base_dir: Option<&Path>,
    settings: BodySettings,
    needs_mesh: bool,
) -> Result<Character, MotionError> {
    refuse_empty(name, bytes)?;
    if fbx::is_fbx(bytes) {
        return fbx::read((name, watch), bytes, base_dir, settings, needs_mesh);
    }
    if usd::is_usd(bytes) {
        return usd::read(name, bytes, base_dir, settings, needs_mesh);
    }
    if bytes.starts_with(b"HIERARCHY") {
        let problem = "is BVH, which holds motion but no body; open it as a motion file";
        return Err(MotionError::malformed(name, "the file", problem));
    }
    gltf::read(name, bytes, base_dir, settings, needs_mesh)
}

fn refuse_empty(name: &str, bytes: &[u8]) -> Result<(), MotionError> {
    if bytes.is_empty() {
        return Err(MotionError::malformed(name, "the file", "is empty (0 bytes)"));
    }
    Ok(())
}

/// Loads a motion file, guessing what it does not specify: BVH, VMD, or the first clip of a glTF, VRM animation, FBX or USD file.
///
/// # Errors
/// If the file is of another kind or broken (the error contains the line or place), or has no joints or no frames.
pub fn load_motion(path: &Path) -> Result<MotionFile, MotionError> {
    load_motion_with(path, MotionSettings::default(), "")
}

/// Loads a motion file. Of a file with several clips, that called `clip` is loaded, otherwise the first.
///
/// # Errors
/// As [`load_motion`].
pub fn load_motion_with(
    path: &Path,
    settings: MotionSettings,
    clip: &str,
) -> Result<MotionFile, MotionError> {
    load_motion_watched(path, settings, clip, &Watch::default())
}

/// As [`load_motion_with`]. Reports to `watch`, and stops when it says so.
///
/// # Errors
/// As [`load_motion`], and if the load is cancelled.
pub fn load_motion_watched(
    path: &Path,
    settings: MotionSettings,
    clip: &str,
    watch: &Watch,
) -> Result<MotionFile, MotionError> {
    let bytes = read_file(path, FILE_LIMIT)?;
    let name = path.display().to_string();
    read_motion((&name, watch), &bytes, path.parent(), settings, clip)
}

/// Loads a motion file from bytes; `name` is used in messages.
///
/// # Errors
/// As [`load_motion`].
pub fn load_motion_bytes(
    name: &str,
    bytes: &[u8],
    settings: MotionSettings,
) -> Result<MotionFile, MotionError> {
    read_motion((name, &Watch::default()), bytes, None, settings, "")
}

fn read_motion(
    (name, watch): (&str, &Watch),
    bytes: &[u8],
    base_dir: Option<&Path>,
    settings: MotionSettings,
    clip: &str,
) -> Result<MotionFile, MotionError> {
    if vmd::is_vmd(bytes) {
        return vmd::read(name, bytes);
    }
    let ends_in = |ending: &str| {
        Path::new(name).extension().is_some_and(|e| e.to_string_lossy().eq_ignore_ascii_case(ending))
    };
    let is_figure = fbx::is_fbx(bytes)
        || usd::is_usd(bytes)
        || bytes.starts_with(b"glTF")
        || ["gltf", "vrma"].into_iter().any(ends_in);
    if !is_figure {
        return bvh::read(name, bytes, settings);
    }
    let of_file = BodySettings { unit: settings.unit, up: settings.up, ..BodySettings::default() };
    let figure = read_figure((name, watch), bytes, base_dir, of_file, false)?;
    motion_of(name, figure, clip)
}
