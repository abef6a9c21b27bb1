//! The bytes of a stage, in memory or on disk.

use std::borrow::Cow;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};

use crate::UsdError;

/// Where the bytes of a stage are.
#[derive(Debug)]
pub enum Source<'a> {
    /// In memory.
    Memory(&'a [u8]),
    /// In a file of a length in bytes.
    File(File, u64),
}

impl<'a> Source<'a> {
    /// Length of the file, bytes.
    pub(crate) fn len(&self) -> u64 {
        match self {
            Self::Memory(data) => data.len() as u64,
            Self::File(_, length) => *length,
        }
    }

    /// `count` bytes from `at` on, which lie within [`Self::len`].
    pub(crate) fn read_at(&mut self, name: &str, at: u64, count: u64) -> Result<Vec<u8>, UsdError> {
        match self {
            Self::Memory(data) => Ok(data[at as usize..(at + count) as usize].to_vec()),
            Self::File(file, _) => {
                let mut bytes = vec![0; count as usize];
                let read = file.seek(SeekFrom::Start(at)).and_then(|_| file.read_exact(&mut bytes));
                read.map_err(|source| UsdError::Io { name: name.to_owned(), source })?;
                Ok(bytes)
            }
        }
    }

    /// All bytes.
    pub(crate) fn into_bytes(self, name: &str) -> Result<Cow<'a, [u8]>, UsdError> {
        match self {
            Self::Memory(data) => Ok(Cow::Borrowed(data)),
            Self::File(mut file, _) => {
                let mut bytes = Vec::new();
                let read = file.seek(SeekFrom::Start(0)).and_then(|_| file.read_to_end(&mut bytes));
                read.map_err(|source| UsdError::Io { name: name.to_owned(), source })?;
                Ok(Cow::Owned(bytes))
            }
        }
    }
}
