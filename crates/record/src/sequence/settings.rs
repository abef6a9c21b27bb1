//! Settings and report of a sequence.

use std::path::PathBuf;

use lovelock_base::settings::Choices;
use serde::{Deserialize, Serialize};

/// File format of a sequence.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SequenceFormat {
    /// PNG: tone-mapped, 8 bits, sRGB.
    #[default]
    Png,
    /// `OpenEXR`: linear half floats with depth and transmittance ([`FrameLayers`](crate::FrameLayers)).
    Exr,
}

impl Choices for SequenceFormat {
    const ALL: &'static [Self] = &Self::ALL;

    fn names(self) -> (&'static str, &'static str) {
        (self.id(), self.label())
    }
}

impl SequenceFormat {
    /// All formats, in the order of menus.
    pub const ALL: [Self; 2] = [Self::Png, Self::Exr];

    /// Stable name for files and the command line; also the extension of the files.
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

/// Settings of a sequence.
#[derive(Debug, Clone, PartialEq)]
pub struct SequenceSettings {
    /// Width in pixels, 1 to 16,384.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Frames per second, 1 to 240. Stored in the manifest.
    pub fps: f64,
    /// Number of the first frame, which names its file.
    pub first_frame: u64,
    /// Format of the files.
    pub format: SequenceFormat,
    /// Whether PNG files have an alpha channel (not premultiplied). Files without one are smaller.
    pub alpha: bool,
    /// Whether to resume an existing sequence with the same settings. Its complete frames are kept.
    pub resume: bool,
    /// How the frames are rendered, for the manifest: an object. Error messages name the keys in which two sequences differ.
    pub settings: serde_json::Value,
}

/// What was written.
#[derive(Debug, Clone, PartialEq)]
pub struct SequenceReport {
    /// The folder.
    pub folder: PathBuf,
    /// Number of frames.
    pub frames: u64,
    /// Number of frames that were kept from an earlier recording.
    pub kept: u64,
    /// Total length of all frames and the sound in bytes.
    pub bytes: u64,
}

/// The file name of a frame: `frame_000042.png`.
pub fn frame_name(number: u64, format: SequenceFormat) -> String {
    format!("frame_{number:06}.{}", format.id())
}
