//! The description of a hair file format.

use super::HairFileError;
use super::file::{HairFile, RawHair};
use super::source::Source;
use super::units::UpAxis;

/// Returns the bytes of a hair file, or the reason why its format cannot hold the hair.
pub type HairWriter = fn(&HairFile) -> Result<Vec<u8>, String>;

/// A hair file format. [`HAIR_FORMATS`](super::HAIR_FORMATS) lists all of them.
pub struct HairFormat {
    /// Name in reports: `Yuksel .hair`.
    pub label: &'static str,
    /// Extensions of file names, without the dot, the most common one first.
    pub extensions: &'static [&'static str],
    /// The start of its files, for error messages.
    pub(super) signature: &'static str,
    /// Whether its files state their unit and axes; their points are then read in metres with Y up.
    pub(super) states_unit: bool,
    /// The axis that points up in most of its files.
    pub(super) common_up: UpAxis,
    /// Magic numbers; a file begins with one of them.
    pub(super) magics: &'static [&'static [u8]],
    /// Whether a file that begins with these bytes may have this format, for formats without a magic number.
    pub(super) may_begin: fn(&[u8]) -> bool,
    /// Whether files of other formats often begin in the same way. Under the name of another format, such a file is of this one only if it
    /// can be read.
    pub(super) by_chance: bool,
    /// Reads a file. The name is used in messages.
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
