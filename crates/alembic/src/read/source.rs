//! The bytes of an archive, and the groups and data in them.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};

use crate::error::AlembicError;
use crate::layout;

/// Where the bytes of an archive are.
#[derive(Debug)]
pub enum Source<'a> {
    /// In memory.
    Memory(&'a [u8]),
    /// In a file of `length` bytes.
    File {
        /// The file.
        file: File,
        /// Its length.
        length: u64,
    },
}

impl Source<'_> {
    pub(super) fn len(&self) -> u64 {
        match self {
            Self::Memory(bytes) => bytes.len() as u64,
            Self::File { length, .. } => *length,
        }
    }

    /// Fills `into` from the position `at`.
    pub(super) fn read(&mut self, at: u64, into: &mut [u8]) -> Result<(), AlembicError> {
        let fits = at.checked_add(into.len() as u64).is_some_and(|end| end <= self.len());
        if !fits {
            let found = format!("{} bytes to read in a file of {}", into.len(), self.len());
            return Err(AlembicError::malformed(at, found, "a position in the file"));
        }
        match self {
            Self::Memory(bytes) => into.copy_from_slice(&bytes[at as usize..at as usize + into.len()]),
            Self::File { file, .. } => {
                file.seek(SeekFrom::Start(at))?;
                file.read_exact(into)?;
            }
        }
        Ok(())
    }

    pub(super) fn number(&mut self, at: u64) -> Result<u64, AlembicError> {
        let mut eight = [0; 8];
        self.read(at, &mut eight)?;
        Ok(u64::from_le_bytes(eight))
    }

    /// Number of children of the group at an address; 0 for an empty group.
    pub(super) fn group_len(&mut self, group: u64) -> Result<u64, AlembicError> {
        if group == 0 {
            return Ok(0);
        }
        if group & layout::DATA != 0 {
            return Err(AlembicError::malformed(group & !layout::DATA, "data", "a group"));
        }
        let count = self.number(group)?;
        let room = self.len() - group - 8;
        if count > room / 8 {
            let found = format!("a group of {count} children in {room} bytes");
            return Err(AlembicError::malformed(group, found, "children in the file"));
        }
        Ok(count)
    }

    /// The address of one child of a group.
    pub(super) fn child(&mut self, group: u64, index: u64) -> Result<u64, AlembicError> {
        let count = self.group_len(group)?;
        if index >= count {
            let found = format!("a group of {count} children");
            return Err(AlembicError::malformed(group, found, "as many as its headers say"));
        }
        self.number(group + 8 + 8 * index)
    }

    /// Position and length of the content of data.
    pub(super) fn data(&mut self, address: u64) -> Result<(u64, u64), AlembicError> {
        if address & layout::DATA == 0 {
            return Err(AlembicError::malformed(address, "a group", "data"));
        }
        let at = address & !layout::DATA;
        if at == 0 {
            return Ok((0, 0));
        }
        let size = self.number(at)?;
        let room = self.len() - at - 8;
        if size > room {
            let found = format!("data of {size} bytes where {room} are left");
            return Err(AlembicError::malformed(at, found, "data in the file"));
        }
        Ok((at + 8, size))
    }
}
