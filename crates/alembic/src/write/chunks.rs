//! Groups and data at the end of a growing file.

use std::io::{self, Seek, SeekFrom, Write};

use crate::layout;

/// A file to which groups and data are appended.
pub(super) struct Chunks<W> {
    out: W,
    length: u64,
}

impl<W: Write + Seek> Chunks<W> {
    /// Writes the header of an archive that is not finished.
    pub(super) fn create(mut out: W) -> io::Result<Self> {
        let mut header = layout::MAGIC.to_vec();
        // Not finished; version 1 of the form, highest byte first; no root group.
        header.extend([0, 0, 1]);
        header.extend(0_u64.to_le_bytes());
        out.write_all(&header)?;
        Ok(Self { out, length: layout::HEADER })
    }

    /// Appends data and returns its address as the child of a group.
    pub(super) fn data(&mut self, pieces: &[&[u8]]) -> io::Result<u64> {
        let size: usize = pieces.iter().map(|piece| piece.len()).sum();
        if size == 0 {
            return Ok(layout::DATA);
        }
        let at = self.length;
        self.out.write_all(&(size as u64).to_le_bytes())?;
        for piece in pieces {
            self.out.write_all(piece)?;
        }
        self.length += 8 + size as u64;
        Ok(at | layout::DATA)
    }

    /// Appends a group and returns its address.
    pub(super) fn group(&mut self, children: &[u64]) -> io::Result<u64> {
        if children.is_empty() {
            return Ok(0);
        }
        let at = self.length;
        self.out.write_all(&(children.len() as u64).to_le_bytes())?;
        for child in children {
            self.out.write_all(&child.to_le_bytes())?;
        }
        self.length += 8 + 8 * children.len() as u64;
        Ok(at)
    }

    /// Enters the root group and marks the archive as finished. Returns the file, at its end, and its length.
    pub(super) fn finish(mut self, root: u64) -> io::Result<(W, u64)> {
        self.out.seek(SeekFrom::Start(layout::ROOT_AT))?;
        self.out.write_all(&root.to_le_bytes())?;
        self.out.seek(SeekFrom::Start(layout::FROZEN_AT))?;
        self.out.write_all(&[layout::FROZEN])?;
        self.out.seek(SeekFrom::Start(self.length))?;
        Ok((self.out, self.length))
    }
}
