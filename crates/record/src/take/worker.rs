//! The thread that compresses chunks and writes them.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::Receiver;

use super::chunk::{ChunkHeader, HEADER_BYTES, Kind, Part, compressor, pack};
use super::codec::{self, Meta};
use super::disk::{Disk, publish};
use super::index::{self, Entry, Trailer};
use super::layout::Layout;
use super::settings::SettingsLog;
use super::{TAKE_VERSION, TakeError};

/// Compression level of zstd for text.
const TEXT_LEVEL: i32 = 9;

/// Compression level of zstd for frames. Residuals are noise, in which higher levels search matches in vain: level 3 makes them
/// 5 % longer.
const DATA_LEVEL: i32 = 1;

/// The frames of one chunk, before they are encoded.
pub(super) struct PendingChunk {
    pub(super) layout: Layout,
    pub(super) metas: Vec<Meta>,
    pub(super) numbers: Vec<i32>,
    pub(super) settings: SettingsLog,
}

/// A message to the worker.
pub(super) enum Job {
    /// The next chunk.
    Chunk(PendingChunk),
    /// There are no more chunks. If the channel closes without this message, the unfinished file stays.
    Finish,
    /// Remove the unfinished file.
    Discard,
}

/// The unfinished file and what has been written to it.
pub(super) struct TakeFile {
    target: PathBuf,
    part: PathBuf,
    disk: Box<dyn Disk>,
    compressor: zstd::bulk::Compressor<'static>,
    head: Vec<u8>,
    take: u32,
    position: u64,
    entries: Vec<Entry>,
    /// Number of frames on the disk, shared with the writer.
    kept: Arc<AtomicU64>,
}

impl TakeFile {
    /// Writes two copies of the header and waits for the disk.
    pub(super) fn start(
        target: &Path,
        part: &Path,
        disk: Box<dyn Disk>,
        head: Vec<u8>,
        kept: Arc<AtomicU64>,
    ) -> Result<Self, TakeError> {
        let compressor = compressor().map_err(|error| TakeError::io(part, "compress", error))?;
        let mut file = Self {
            target: target.to_owned(),
            part: part.to_owned(),
            disk,
            compressor,
            take: crc32fast::hash(&head),
            head,
            position: 0,
            entries: Vec::new(),
            kept,
        };
        let write = |file: &mut Self| {
            let head = file.head_chunk()?;
            file.write(&[&head[..], &head[..]].concat())
        };
        write(&mut file).map_err(|error| file.failed("write its header", error))?;
        Ok(file)
    }

    /// Works until [`Job::Finish`] (returns the length of the file in bytes), until the channel closes or [`Job::Discard`]
    /// (returns `None`), or until an error.
    pub(super) fn run(mut self, jobs: &Receiver<Job>) -> Result<Option<u64>, TakeError> {
        while let Ok(job) = jobs.recv() {
            match job {
                Job::Chunk(pending) => self.add(&pending)?,
                Job::Finish => return self.finish().map(Some),
                // Removed while the file is locked, so that it cannot belong to another recording.
                Job::Discard => {
                    return fs::remove_file(&self.part)
                        .map(|()| None)
                        .map_err(|error| TakeError::io(&self.part, "remove", error));
                }
            }
        }
        Ok(None)
    }

    fn add(&mut self, pending: &PendingChunk) -> Result<(), TakeError> {
        let first = self.entries.last().map_or(0, |entry| entry.header.end());
        let last = first + pending.metas.len() as u64 - 1;
        self.write_frames(pending, first)
            .map_err(|error| self.failed(&format!("write frames {first} to {last}"), error))?;
        self.kept.store(last + 1, Ordering::Release);
        Ok(())
    }

    fn write_frames(&mut self, pending: &PendingChunk, first: u64) -> std::io::Result<()> {
        let data = codec::encode(&pending.metas, &pending.numbers, pending.layout);
        let mut header = self.header(Kind::Frames);
        (header.first, header.frames) = (first, pending.metas.len() as u32);
        header.changes = pending.settings.changes();
        let (header, bytes) = self.chunk(header, &pending.settings.to_bytes(), &data)?;
        let offset = self.position;
        self.write(&bytes)?;
        self.entries.push(Entry { offset, header });
        Ok(())
    }

    /// Writes another copy of the header, the index and the trailer, and renames the file to its final name.
    fn finish(mut self) -> Result<u64, TakeError> {
        let write = |file: &mut Self| {
            let mut bytes = file.head_chunk()?;
            let head = file.position;
            let index = file.position + bytes.len() as u64;
            let entries = index::to_bytes(&file.entries);
            bytes.extend(file.chunk(file.header(Kind::Index), &[], &entries)?.1);
            let frames = file.entries.last().map_or(0, |entry| entry.header.end());
            bytes.extend(Trailer { head, index, frames, take: file.take }.to_bytes());
            file.write(&bytes)
        };
        write(&mut self).map_err(|error| self.failed("write its index", error))?;
        publish(&self.part, &self.target)
            .map_err(|error| self.failed(&format!("name it {}", self.target.display()), error))?;
        Ok(self.position)
    }

    fn header(&self, kind: Kind) -> ChunkHeader {
        ChunkHeader {
            kind,
            version: TAKE_VERSION,
            first: 0,
            frames: 0,
            changes: 0,
            text: Part::default(),
            data: Part::default(),
            take: self.take,
        }
    }

    fn head_chunk(&mut self) -> std::io::Result<Vec<u8>> {
        let head = std::mem::take(&mut self.head);
        let chunk = self.chunk(self.header(Kind::Head), &head, &[]);
        self.head = head;
        Ok(chunk?.1)
    }

    /// The bytes of a chunk, and its header with the lengths and checksums filled in.
    fn chunk(
        &mut self,
        mut header: ChunkHeader,
        text: &[u8],
        data: &[u8],
    ) -> std::io::Result<(ChunkHeader, Vec<u8>)> {
        let mut bytes = vec![0; HEADER_BYTES];
        header.text = pack(&mut self.compressor, TEXT_LEVEL, text, &mut bytes)?;
        header.data = pack(&mut self.compressor, DATA_LEVEL, data, &mut bytes)?;
        bytes[..HEADER_BYTES].copy_from_slice(&header.to_bytes());
        Ok((header, bytes))
    }

    fn write(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.disk.write_all(bytes)?;
        self.disk.sync()?;
        self.position += bytes.len() as u64;
        Ok(())
    }

    fn failed(&self, action: &str, source: std::io::Error) -> TakeError {
        let kept = self.kept.load(Ordering::Acquire);
        TakeError::Write { path: self.part.clone(), action: action.to_owned(), kept, source }
    }
}
