//! Recognises the format of a motion file by its first bytes and calls its reader.

use std::path::Path;

use crate::error::read_file;
use crate::{MotionError, MotionFile, MotionSettings, bvh, vmd};

/// Size of the largest file that is read.
const FILE_LIMIT: u64 = 1 << 30;

/// Loads a motion file, guessing what it does not specify: BVH or VMD.
///
/// # Errors
/// If the file is of another kind or broken (the error contains the line or byte), or has no joints or no frames.
pub fn load_motion(path: &Path) -> Result<MotionFile, MotionError> {
    load_motion_with(path, MotionSettings::default())
}

/// Loads a motion file.
///
/// # Errors
/// As [`load_motion`].
pub fn load_motion_with(path: &Path, settings: MotionSettings) -> Result<MotionFile, MotionError> {
    let bytes = read_file(path, FILE_LIMIT)?;
    load_motion_bytes(&path.display().to_string(), &bytes, settings)
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
    if vmd::is_vmd(bytes) { vmd::read(name, bytes) } else { bvh::read(name, bytes, settings) }
}
