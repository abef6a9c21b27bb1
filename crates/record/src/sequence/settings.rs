//! What a sequence is, and what was written.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

/// What the files of a sequence are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SequenceFormat {
    /// PNG: as the screen shows it, 8 bits, sRGB.
    #[default]
    Png,
    /// `OpenEXR`: linear half floats with depth and transmittance ([`FrameLayers`](crate::FrameLayers)).
    Exr,
}

impl SequenceFormat {
    /// All, in the order of menus.
    pub const ALL: [Self; 2] = [Self::Png, Self::Exr];

    /// Stable name for files and the command line; the ending of the files.
    pub fn id(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Exr => "exr",
        }
    }

    /// Name for people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Png => "PNG",
            Self::Exr => "EXR, linear",
        }
    }
}

/// What a sequence is.
#[derive(Debug, Clone, PartialEq)]
pub struct SequenceSettings {
    /// Width in pixels, 1 to 16,384.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Frames per second, 1 to 240; for the manifest.
    pub fps: f64,
    /// Number of the first frame, which names its file.
    pub first_frame: u64,
    /// What the files are.
    pub format: SequenceFormat,
    /// Whether PNG files keep the alpha channel (not premultiplied). Without, they are smaller.
    pub alpha: bool,
    /// Whether to go on with a sequence of the same settings that is there, of which whole frames are kept.
    pub resume: bool,
    /// What drew the frames, for the manifest: an object whose keys say in what another sequence differs.
    pub settings: serde_json::Value,
}

/// What was written.
#[derive(Debug, Clone, PartialEq)]
pub struct SequenceReport {
    /// The folder.
    pub folder: PathBuf,
    /// Frames in it.
    pub frames: u64,
    /// Those of them that an earlier recording had left whole.
    pub kept: u64,
    /// Length of all frames together, in bytes.
    pub bytes: u64,
}

/// The file name of a frame: `frame_000042.png`.
pub fn frame_name(number: u64, format: SequenceFormat) -> String {
    format!("frame_{number:06}.{}", format.id())
}
