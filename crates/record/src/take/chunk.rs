//! The chunks of a take's file: a header of 64 bytes and two compressed parts, each with its checksum.

use std::io::{self, Read};

use super::TAKE_VERSION;

/// The first bytes of every chunk, and so of every take. The first byte is not in text files, and a conversion of line endings
/// changes the last two.
pub(super) const MAGIC: [u8; 8] = *b"\x9ALTAKE\r\n";

/// Bytes of a chunk's header.
pub(super) const HEADER_BYTES: usize = 64;

/// The largest part of a chunk in bytes before compression. Writers make smaller chunks.
pub(super) const MAX_RAW_BYTES: u32 = 128 << 20;

/// The highest compression ratio of zstd. A header with a higher one is rejected.
const MAX_RATIO: u64 = 1 << 16;

/// The contents of a chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Text: the take's header as JSON. Written twice at the start and once at the end.
    Head,
    /// Text: the project and its changes. Data: frames.
    Frames,
    /// Data: the headers and offsets of all chunks of frames.
    Index,
}

impl Kind {
    fn bytes(self) -> [u8; 4] {
        match self {
            Self::Head => *b"HEAD",
            Self::Frames => *b"FRMS",
            Self::Index => *b"INDX",
        }
    }

    fn of(bytes: [u8; 4]) -> Option<Self> {
        [Self::Head, Self::Frames, Self::Index].into_iter().find(|kind| kind.bytes() == bytes)
    }
}

/// A compressed part: its lengths and the CRC-32 of its compressed bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Part {
    pub(super) packed: u32,
    pub(super) raw: u32,
    pub(super) crc: u32,
}

/// The header of a chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct ChunkHeader {
    pub(super) kind: Kind,
    pub(super) version: u32,
    /// First frame, if there are frames.
    pub(super) first: u64,
    pub(super) frames: u32,
    /// Number of changes of the project in the chunk.
    pub(super) changes: u32,
    pub(super) text: Part,
    pub(super) data: Part,
    /// CRC-32 of the take's header text, which distinguishes the chunks of different takes.
    pub(super) take: u32,
}

impl ChunkHeader {
    /// Bytes after the header.
    pub(super) fn body_bytes(&self) -> u64 {
        u64::from(self.text.packed) + u64::from(self.data.packed)
    }

    /// First frame after the chunk.
    pub(super) fn end(&self) -> u64 {
        self.first + u64::from(self.frames)
    }

    pub(super) fn to_bytes(self) -> [u8; HEADER_BYTES] {
        let mut bytes = [0; HEADER_BYTES];
        bytes[..8].copy_from_slice(&MAGIC);
        bytes[8..12].copy_from_slice(&self.kind.bytes());
        bytes[12..16].copy_from_slice(&self.version.to_le_bytes());
        bytes[16..24].copy_from_slice(&self.first.to_le_bytes());
        let words = [
            self.frames,
            self.changes,
            self.text.packed,
            self.text.raw,
            self.text.crc,
            self.data.packed,
            self.data.raw,
            self.data.crc,
            self.take,
        ];
        for (slot, word) in bytes[24..60].chunks_exact_mut(4).zip(words) {
            slot.copy_from_slice(&word.to_le_bytes());
        }
        let crc = crc32fast::hash(&bytes[..60]);
        bytes[60..].copy_from_slice(&crc.to_le_bytes());
        bytes
    }

    /// The header in `bytes`, or what is wrong with it.
    pub(super) fn parse(bytes: &[u8; HEADER_BYTES]) -> Result<Self, HeaderError> {
        let word = |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        if bytes[..8] != MAGIC {
            return Err(HeaderError::Magic);
        }
        if word(60) != crc32fast::hash(&bytes[..60]) {
            return Err(HeaderError::Checksum);
        }
        let version = word(12);
        if version > TAKE_VERSION {
            return Err(HeaderError::Newer(version));
        }
        let kind = Kind::of([bytes[8], bytes[9], bytes[10], bytes[11]]);
        let part = |at: usize| Part { packed: word(at), raw: word(at + 4), crc: word(at + 8) };
        let (text, data) = (part(32), part(44));
        let first = u64::from(word(16)) | u64::from(word(20)) << 32;
        let frames = word(24);
        let believable = |part: &Part| {
            part.raw <= MAX_RAW_BYTES && u64::from(part.raw) <= u64::from(part.packed) * MAX_RATIO
        };
        match kind {
            Some(kind)
                if version > 0
                    && believable(&text)
                    && believable(&data)
                    && first.checked_add(u64::from(frames)).is_some() =>
            {
                Ok(Self { kind, version, first, frames, changes: word(28), text, data, take: word(56) })
            }
            _ => Err(HeaderError::Absurd),
        }
    }
}

/// Why 64 bytes are not the header of a chunk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum HeaderError {
    /// They do not start with [`MAGIC`].
    Magic,
    /// Their checksum does not match.
    Checksum,
    /// A newer version wrote them.
    Newer(u32),
    /// Their checksum matches, but no writer makes such a chunk.
    Absurd,
}

/// Compresses `raw` and appends it to `out`.
pub(super) fn pack(
    compressor: &mut zstd::bulk::Compressor<'_>,
    level: i32,
    raw: &[u8],
    out: &mut Vec<u8>,
) -> io::Result<Part> {
    if raw.len() > MAX_RAW_BYTES as usize {
        return Err(io::Error::other(format!(
            "a part of {} bytes; must be at most {MAX_RAW_BYTES}",
            raw.len()
        )));
    }
    if raw.is_empty() {
        return Ok(Part::default());
    }
    compressor.set_compression_level(level)?;
    let packed = compressor.compress(raw)?;
    out.extend_from_slice(&packed);
    Ok(Part { packed: packed.len() as u32, raw: raw.len() as u32, crc: crc32fast::hash(&packed) })
}

/// Decompresses the output of [`pack`]. Returns what is wrong if it is damaged.
pub(super) fn unpack(packed: &[u8], part: &Part) -> Result<Vec<u8>, String> {
    let crc = crc32fast::hash(packed);
    if packed.len() != part.packed as usize || crc != part.crc {
        return Err(format!("{} bytes with checksum {crc:08x}; must be {:08x}", packed.len(), part.crc));
    }
    if part.raw == 0 {
        return Ok(Vec::new());
    }
    let raw = zstd::bulk::decompress(packed, part.raw as usize).map_err(|error| error.to_string())?;
    if raw.len() != part.raw as usize {
        return Err(format!("{} bytes after decompression; must be {}", raw.len(), part.raw));
    }
    Ok(raw)
}

/// Compressed bytes that are enough for the start of any part. zstd compresses blocks of 128 KiB and stores those that do not get
/// smaller as they are.
pub(super) const MAX_START_BYTES: u32 = 160 << 10;

/// The first bytes of a part, from the start of its compressed bytes; `None` if they cannot be decompressed.
pub(super) fn unpack_start<const N: usize>(packed: &[u8]) -> Option<[u8; N]> {
    let mut start = [0; N];
    zstd::stream::read::Decoder::with_buffer(packed).ok()?.read_exact(&mut start).ok()?;
    Some(start)
}

/// A compressor whose output contains zstd's own checksum of the raw bytes.
pub(super) fn compressor() -> io::Result<zstd::bulk::Compressor<'static>> {
    let mut compressor = zstd::bulk::Compressor::new(0)?;
    compressor.include_checksum(true)?;
    Ok(compressor)
}
