//! The map of a take: where its chunks are.

use std::io;
use std::path::Path;

use super::chunk::{ChunkHeader, Kind};
use super::index::Entry;
use super::{MAX_CHUNK_FRAMES, TAKE_VERSION, TakeError, TakeHeader};

/// Where the chunks of a take are.
#[derive(Debug)]
pub(super) struct Map {
    pub(super) header: TakeHeader,
    /// Length of the file in bytes.
    pub(super) length: u64,
    /// The chunks of frames, in order. Frames missing between two chunks are lost.
    pub(super) entries: Vec<Entry>,
    /// Number of frames of the take, including lost ones.
    pub(super) frames: u64,
    /// Why the take is regarded as cut, if it is.
    pub(super) cut: Option<String>,
    /// The damage that was found first, if there is any.
    pub(super) damage: Option<String>,
}

/// Why a file could not be mapped.
#[derive(Debug)]
pub(super) enum MapError {
    Io(io::Error),
    NotATake { why: String },
    Newer(u32),
    Malformed { offset: u64, found: String, wanted: String },
}

impl MapError {
    /// Converts to an error about the file at `path`.
    pub(super) fn at(self, path: &Path) -> TakeError {
        let path = path.to_owned();
        match self {
            Self::Io(source) => TakeError::Io { path, action: "read".to_owned(), source },
            Self::NotATake { why } => TakeError::NotATake { path, why },
            Self::Newer(found) => TakeError::Newer { path, found, newest: TAKE_VERSION },
            Self::Malformed { offset, found, wanted } => TakeError::Malformed { path, offset, found, wanted },
        }
    }
}

impl From<io::Error> for MapError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

/// Whether a chunk can be a chunk of frames of the take.
pub(super) fn fits(entry: &Entry, take: u32) -> bool {
    let ChunkHeader { kind, frames, changes, .. } = entry.header;
    kind == Kind::Frames
        && entry.header.take == take
        && (1..=MAX_CHUNK_FRAMES).contains(&frames)
        && changes < frames
}
