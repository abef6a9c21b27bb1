//! A part of a file that counts how far it was read.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use symphonia::core::io::MediaSource;

/// A part of a file, after bytes that stand before it, that counts how far it was read.
pub(super) struct Counted {
    file: File,
    /// Read before the part of the file.
    head: Vec<u8>,
    /// The part of the file, bytes.
    part: Range<u64>,
    length: u64,
    at: u64,
    position: Arc<AtomicU64>,
}

/// How far a [`Counted`] was read.
pub(super) struct Position {
    length: u64,
    position: Arc<AtomicU64>,
}

impl Counted {
    pub(super) fn new(mut file: File, head: Vec<u8>, part: Range<u64>) -> io::Result<(Self, Position)> {
        file.seek(SeekFrom::Start(part.start))?;
        let length = head.len() as u64 + (part.end - part.start);
        let position = Arc::new(AtomicU64::new(0));
        let seen = Position { length, position: Arc::clone(&position) };
        Ok((Self { file, head, part, length, at: 0, position }, seen))
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
        let head = usize::try_from(self.at).ok().and_then(|at| self.head.get(at..)).unwrap_or_default();
        let count = if head.is_empty() {
            let left = usize::try_from(self.length.saturating_sub(self.at)).unwrap_or(usize::MAX);
            let most = buffer.len().min(left);
            self.file.read(&mut buffer[..most])?
        } else {
            let count = head.len().min(buffer.len());
            buffer[..count].copy_from_slice(&head[..count]);
            count
        };
        self.at += count as u64;
        self.position.store(self.at, Ordering::Relaxed);
        Ok(count)
    }
}

impl Seek for Counted {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let target = match to {
            SeekFrom::Start(at) => Some(at),
            SeekFrom::Current(by) => self.at.checked_add_signed(by),
            SeekFrom::End(by) => self.length.checked_add_signed(by),
        };
        let target = target.ok_or_else(|| io::Error::from(io::ErrorKind::InvalidInput))?;
        let in_part = target.saturating_sub(self.head.len() as u64);
        self.file.seek(SeekFrom::Start(self.part.start.saturating_add(in_part)))?;
        self.at = target;
        self.position.store(target, Ordering::Relaxed);
        Ok(target)
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
