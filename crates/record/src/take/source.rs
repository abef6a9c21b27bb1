//! The source that a take is read from.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

/// Random access to bytes. A file, except in tests that count reads.
pub(super) trait Source: Send {
    /// Fills `buffer` from `offset` on.
    fn read_at(&mut self, offset: u64, buffer: &mut [u8]) -> io::Result<()>;
}

impl Source for File {
    fn read_at(&mut self, offset: u64, buffer: &mut [u8]) -> io::Result<()> {
        self.seek(SeekFrom::Start(offset))?;
        self.read_exact(buffer)
    }
}
