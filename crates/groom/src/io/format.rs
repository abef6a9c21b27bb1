//! What the program needs to know about a hair file format.

use super::HairFileError;
use super::file::{HairFile, RawHair};
use super::source::Source;
use super::units::UpAxis;

/// Makes a file of hair, or says in words why its format cannot hold the hair.
pub type HairWriter = fn(&HairFile) -> Result<Vec<u8>, String>;

/// A hair file format. [`HAIR_FORMATS`](super::HAIR_FORMATS) lists all of them.
pub struct HairFormat {
    /// Name in reports: `Yuksel .hair`.
    pub label: &'static str,
    /// Extensions of file names, without the dot, the most common one first.
    pub extensions: &'static [&'static str],
    /// How its files begin, for error messages.
    pub(super) signature: &'static str,
    /// Whether its files state their unit and axes, so that their points are read in metres with Y up.
    pub(super) states_unit: bool,
    /// The axis that points up in most of its files.
    pub(super) common_up: UpAxis,
    /// Bytes that only its files begin with, one of them each.
    pub(super) magics: &'static [&'static [u8]],
    /// Whether a file without such a magic may have this format, from its first bytes.
    pub(super) may_begin: fn(&[u8]) -> bool,
    /// Reads a file; its name is for messages.
    pub(super) read: fn(&str, Source<'_>) -> Result<RawHair, HairFileError>,
    /// Writes hair that is in metres with Y up ([`HairFile::in_metres`]); `None` for formats that this crate only reads.
    pub write: Option<HairWriter>,
}

impl PartialEq for HairFormat {
    fn eq(&self, other: &Self) -> bool {
        self.label == other.label
    }
}

impl std::fmt::Debug for HairFormat {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.label)
    }
}
