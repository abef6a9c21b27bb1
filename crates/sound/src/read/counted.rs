//! A file that counts how far it was read.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use symphonia::core::io::MediaSource;

/// A file that counts how far it was read.
pub(super) struct Counted {
    file: File,
    length: u64,
    position: Arc<AtomicU64>,
}

/// How far a [`Counted`] was read.
pub(super) struct Position {
    length: u64,
    position: Arc<AtomicU64>,
}

impl Counted {
    pub(super) fn new(file: File) -> io::Result<(Self, Position)> {
        let data = file.metadata()?;
        if !data.is_file() {
            return Err(io::Error::other("it is not a file"));
        }
        let (length, position) = (data.len(), Arc::new(AtomicU64::new(0)));
        let seen = Position { length, position: Arc::clone(&position) };
        Ok((Self { file, length, position }, seen))
    }

    /// Length of the file, bytes.
    pub(super) fn length(&self) -> u64 {
        self.length
    }
}

impl Position {
    /// The part of the file that was read, 0 to 1.
    pub(super) fn fraction(&self) -> f32 {
        (self.position.load(Ordering::Relaxed) as f64 / self.length.max(1) as f64).min(1.0) as f32
    }
}

impl Read for Counted {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.file.read(buffer)?;
        self.position.fetch_add(count as u64, Ordering::Relaxed);
        Ok(count)
    }
}

impl Seek for Counted {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let at = self.file.seek(to)?;
        self.position.store(at, Ordering::Relaxed);
        Ok(at)
    }
}

impl MediaSource for Counted {
    fn is_seekable(&self) -> bool {
        true
    }

    fn byte_len(&self) -> Option<u64> {
        Some(self.length)
    }
}
