//! The manifest of a folder of frames.

use crate::RecordError;
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The manifest's name inside its folder.
pub const MANIFEST_NAME: &str = "manifest.json";

/// The version that this crate writes.
pub(crate) const VERSION: u32 = 1;

/// The contents of a folder of frames.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Manifest {
    /// Always `lovelock-sequence`.
    pub format: String,
    /// Version of the format, 1.
    pub version: u32,
    /// Whether the recording was finished. False after a cancel or an error: the listed frames are complete, but some are
    /// missing.
    pub complete: bool,
    /// Width of every frame in pixels.
    pub width: u32,
    /// Height of every frame in pixels.
    pub height: u32,
    /// Frames per second.
    pub fps: f64,
    /// Number of the first frame of the requested range.
    pub first_frame: u64,
    /// The frames, by rising number.
    pub frames: Vec<ManifestFrame>,
    /// The sound beside the frames, if the recording wrote one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sound: Option<ManifestSound>,
    /// How the frames were rendered, as given by the caller.
    pub settings: serde_json::Value,
}

/// One frame of a [`Manifest`].
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ManifestFrame {
    /// The frame's number.
    pub number: u64,
    /// Name of its file in the manifest's folder.
    pub file: String,
    /// Length of the file in bytes.
    pub bytes: u64,
    /// CRC-32 of the file's bytes (as in zip and PNG), eight hexadecimal digits.
    pub crc32: String,
}

/// The sound of a [`Manifest`].
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ManifestSound {
    /// Name of its file in the manifest's folder.
    pub file: String,
    /// Length of the file in bytes.
    pub bytes: u64,
    /// CRC-32 of the file's bytes, eight hexadecimal digits.
    pub crc32: String,
}

/// Reads a folder's manifest.
///
/// # Errors
/// [`RecordError::Io`] if there is none, [`RecordError::Malformed`] if it is not a manifest of this program.
pub fn read_manifest(folder: &Path) -> Result<Manifest, RecordError> {
    let path = folder.join(MANIFEST_NAME);
    let text = std::fs::read(&path).map_err(|error| RecordError::io(&path, "read the manifest", error))?;
    let malformed = |found: String| RecordError::Malformed {
        path: path.clone(),
        offset: 0,
        found,
        wanted: format!("a manifest of frames, version {VERSION}"),
    };
    let manifest: Manifest = serde_json::from_slice(&text).map_err(|error| malformed(error.to_string()))?;
    if manifest.format != "lovelock-sequence" || manifest.version != VERSION {
        return Err(malformed(format!("`{}`, version {}", manifest.format, manifest.version)));
    }
    Ok(manifest)
}
