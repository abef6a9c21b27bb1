//! The index at the end of a take, which lists its chunks, and the trailer, which locates the index.

use super::bytes::Bytes;
use super::chunk::{ChunkHeader, HEADER_BYTES};

/// The first bytes of a trailer.
pub(super) const TRAILER_MAGIC: [u8; 8] = *b"\x9ALTEND\r\n";

/// Length of the trailer at the end of a finished take, in bytes.
pub(super) const TRAILER_BYTES: usize = 40;

/// A chunk with its offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Entry {
    pub(super) offset: u64,
    pub(super) header: ChunkHeader,
}

impl Entry {
    /// Offset of the first byte after the chunk; `None` on overflow.
    pub(super) fn end(&self) -> Option<u64> {
        self.offset.checked_add(HEADER_BYTES as u64)?.checked_add(self.header.body_bytes())
    }
}

/// The data part of an index: the offset and the header of every chunk of frames, in order.
pub(super) fn to_bytes(entries: &[Entry]) -> Vec<u8> {
    let mut out = Vec::with_capacity(entries.len() * (8 + HEADER_BYTES));
    for entry in entries {
        out.extend(entry.offset.to_le_bytes());
        out.extend(entry.header.to_bytes());
    }
    out
}

/// The entries of an index; `None` if it is invalid.
pub(super) fn parse(raw: &[u8]) -> Option<Vec<Entry>> {
    let mut bytes = Bytes::new(raw);
    let mut entries = Vec::with_capacity(raw.len() / (8 + HEADER_BYTES));
    while bytes.left() > 0 {
        let offset = bytes.u64()?;
        let header = ChunkHeader::parse(bytes.take(HEADER_BYTES)?.try_into().ok()?).ok()?;
        entries.push(Entry { offset, header });
    }
    Some(entries)
}

/// The last bytes of a finished take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Trailer {
    /// Offset of the last copy of the take's header.
    pub(super) head: u64,
    /// Offset of the index chunk.
    pub(super) index: u64,
    pub(super) frames: u64,
    pub(super) take: u32,
}

impl Trailer {
    pub(super) fn to_bytes(self) -> [u8; TRAILER_BYTES] {
        let mut bytes = [0; TRAILER_BYTES];
        bytes[..8].copy_from_slice(&TRAILER_MAGIC);
        bytes[8..16].copy_from_slice(&self.head.to_le_bytes());
        bytes[16..24].copy_from_slice(&self.index.to_le_bytes());
        bytes[24..32].copy_from_slice(&self.frames.to_le_bytes());
        bytes[32..36].copy_from_slice(&self.take.to_le_bytes());
        let crc = crc32fast::hash(&bytes[..36]);
        bytes[36..].copy_from_slice(&crc.to_le_bytes());
        bytes
    }

    pub(super) fn parse(bytes: &[u8; TRAILER_BYTES]) -> Option<Self> {
        let (body, crc) = bytes.split_at(36);
        let mut rest = Bytes::new(body);
        if rest.take(8)? != TRAILER_MAGIC || Bytes::new(crc).u32()? != crc32fast::hash(body) {
            return None;
        }
        Some(Self { head: rest.u64()?, index: rest.u64()?, frames: rest.u64()?, take: rest.u32()? })
    }
}
