//! Why a picture of the surroundings could not be read, and the limits it must keep.

use std::path::PathBuf;

/// Pixels per row of the widest picture that is read.
pub const MAX_WIDTH: u32 = 16_384;

/// Rows of the highest picture that is read.
pub const MAX_HEIGHT: u32 = 8192;

/// Bytes of the largest file that is read: the largest picture with four floats per pixel, twice.
pub const MAX_FILE_BYTES: u64 = 4 << 30;

/// Bytes of the largest piece that a file may ask to be held in memory at once.
pub(super) const MAX_BLOCK_BYTES: u64 = 256 << 20;

/// What a file must be.
const FORMATS: &str = "a Radiance (.hdr) or OpenEXR (.exr) picture";

/// Why a file could not be read as a picture of the surroundings.
#[derive(Debug, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct EnvironmentError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    #[source]
    pub problem: Problem,
}

/// What is wrong with a picture: what was found, and what it must be.
#[derive(Debug, thiserror::Error)]
pub enum Problem {
    /// The system does not give the file's content.
    #[error("cannot be read ({0}); must be {FORMATS}")]
    Io(#[from] std::io::Error),
    /// A folder, a pipe or a device.
    #[error("is {0}; must be the file of {FORMATS}")]
    NotAFile(&'static str),
    /// The content is neither of the two formats.
    #[error("contains {0}; must be {FORMATS}")]
    Format(String),
    /// A format of the two, in a variant that is not read.
    #[error("has {found}; must be {wanted}")]
    Variant {
        /// The variant.
        found: String,
        /// Those that are read.
        wanted: &'static str,
    },
    /// No pixels.
    #[error("is {width} x {height} pixels; must be at least 1 x 1")]
    Empty {
        /// Pixels per row.
        width: u64,
        /// Rows.
        height: u64,
    },
    /// More pixels than the limit.
    #[error("is {width} x {height} pixels; must be at most {MAX_WIDTH} x {MAX_HEIGHT}")]
    TooLarge {
        /// Pixels per row.
        width: u64,
        /// Rows.
        height: u64,
    },
    /// More bytes than the limit.
    #[error("has {0} bytes; must be at most {MAX_FILE_BYTES}")]
    TooManyBytes(u64),
    /// Pixels compressed together in larger pieces than the limit.
    #[error(
        "stores its pixels in pieces of {0} bytes; must be at most {MAX_BLOCK_BYTES}: save it with smaller tiles"
    )]
    BlockTooLarge(u64),
    /// The content ends early.
    #[error("is cut short: found {found}; must be {wanted}")]
    CutShort {
        /// What is there.
        found: String,
        /// What was announced.
        wanted: String,
    },
    /// The content contradicts its format.
    #[error("is damaged: found {found}; must be {wanted}")]
    Damaged {
        /// What is there.
        found: String,
        /// What the format requires.
        wanted: &'static str,
    },
}
