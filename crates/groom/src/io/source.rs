//! The bytes of a hair file, in memory or on disk.

use std::borrow::Cow;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::HairFileError;

/// Bytes that are read from a file before its format is recognised.
const START: u64 = 64;

/// Where the bytes of a hair file are.
pub(super) enum Source<'a> {
    /// In memory.
    Memory(&'a [u8]),
    /// In a file of `length` bytes. `start` contains the bytes read so far.
    File { file: File, length: u64, start: Vec<u8> },
}

impl<'a> Source<'a> {
    /// Opens a file and reads its start.
    pub(super) fn open(name: &str, path: &Path) -> Result<Self, HairFileError> {
        let open = || {
            let mut file = File::open(path)?;
            let mut start = Vec::new();
            file.by_ref().take(START).read_to_end(&mut start)?;
            let length = file.metadata()?.len();
            Ok(Self::File { file, length, start })
        };
        open().map_err(|source| HairFileError::Io { name: name.to_owned(), source })
    }

    /// The first bytes: up to 64 of a file, or all of those in memory.
    pub(super) fn start(&self) -> &[u8] {
        match self {
            Self::Memory(data) => data,
            Self::File { start, .. } => start,
        }
    }

    /// All bytes.
    pub(super) fn into_bytes(self, name: &str) -> Result<Cow<'a, [u8]>, HairFileError> {
        match self {
            Self::Memory(data) => Ok(Cow::Borrowed(data)),
            Self::File { mut file, mut start, .. } => {
                let read = file.read_to_end(&mut start);
                read.map_err(|source| HairFileError::Io { name: name.to_owned(), source })?;
                Ok(Cow::Owned(start))
            }
        }
    }
}
