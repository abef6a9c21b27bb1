//! Reads parts of a take that may be damaged.

use std::io;

use super::TakeHeader;
use super::chunk::{ChunkHeader, HEADER_BYTES, HeaderError, Kind, MAGIC, unpack};
use super::index::{Entry, TRAILER_BYTES, Trailer};
use super::map::MapError;
use super::source::Source;

/// The longest text of a header in bytes: a project in which every character is escaped, with some reserve.
const MAX_HEAD_BYTES: u32 = 32 << 20;

/// The header of the chunk at `offset`.
pub(super) fn header_at(
    source: &mut dyn Source,
    offset: u64,
    length: u64,
) -> io::Result<Result<ChunkHeader, HeaderError>> {
    let mut bytes = [0; HEADER_BYTES];
    let there = length.saturating_sub(offset).min(HEADER_BYTES as u64) as usize;
    if there > 0 {
        source.read_at(offset, &mut bytes[..there])?;
    }
    Ok(ChunkHeader::parse(&bytes))
}

/// The header of the take in the chunk at `offset` and the checksum that identifies the take; `None` if the chunk is damaged.
pub(super) fn head_of(
    source: &mut dyn Source,
    offset: u64,
    length: u64,
) -> Result<Option<(TakeHeader, u32)>, MapError> {
    let Ok(header) = header_at(source, offset, length)? else { return Ok(None) };
    let ends = Entry { offset, header }.end();
    if header.kind != Kind::Head || ends.is_none_or(|end| end > length) || header.text.raw > MAX_HEAD_BYTES {
        return Ok(None);
    }
    let mut packed = vec![0; header.text.packed as usize];
    source.read_at(offset + HEADER_BYTES as u64, &mut packed)?;
    let Ok(text) = unpack(&packed, &header.text) else { return Ok(None) };
    let take = crc32fast::hash(&text);
    if take != header.take {
        return Ok(None);
    }
    let malformed =
        |found: String, wanted: &str| MapError::Malformed { offset, found, wanted: wanted.to_owned() };
    let header: TakeHeader = serde_json::from_slice(&text)
        .map_err(|error| malformed(format!("an invalid header: {error}"), "the header of a take"))?;
    header.check().map_err(|(found, wanted)| malformed(found, &wanted))?;
    Ok(Some((header, take)))
}

/// The error for a file without a valid header of a take.
pub(super) fn no_head(source: &mut dyn Source, length: u64) -> io::Result<MapError> {
    let mut start = vec![0; length.min(MAGIC.len() as u64) as usize];
    source.read_at(0, &mut start)?;
    if start == MAGIC {
        let found = "a damaged or incomplete header and no intact copy of it".to_owned();
        return Ok(MapError::Malformed { offset: 0, found, wanted: "the header of a take".to_owned() });
    }
    Ok(MapError::NotATake { why: "does not begin like a take".to_owned() })
}

/// The trailer at the end of the file.
pub(super) fn trailer(source: &mut dyn Source, length: u64) -> io::Result<Option<Trailer>> {
    let Some(offset) = length.checked_sub(TRAILER_BYTES as u64) else { return Ok(None) };
    let mut bytes = [0; TRAILER_BYTES];
    source.read_at(offset, &mut bytes)?;
    Ok(Trailer::parse(&bytes))
}

/// The data part of a chunk; `None` if it is damaged.
pub(super) fn data_of(source: &mut dyn Source, entry: &Entry) -> io::Result<Option<Vec<u8>>> {
    let mut packed = vec![0; entry.header.data.packed as usize];
    let offset = entry.offset + HEADER_BYTES as u64 + u64::from(entry.header.text.packed);
    source.read_at(offset, &mut packed)?;
    Ok(unpack(&packed, &entry.header.data).ok())
}

/// Whether both parts of a chunk match their checksums.
pub(super) fn is_sound(source: &mut dyn Source, entry: &Entry) -> io::Result<bool> {
    let mut at = entry.offset + HEADER_BYTES as u64;
    for part in [&entry.header.text, &entry.header.data] {
        let mut packed = vec![0; part.packed as usize];
        source.read_at(at, &mut packed)?;
        if crc32fast::hash(&packed) != part.crc {
            return Ok(false);
        }
        at += u64::from(part.packed);
    }
    Ok(true)
}

/// Offset of the next possible start of a chunk between `from` and `limit`.
pub(super) fn next_magic(source: &mut dyn Source, from: u64, limit: u64) -> io::Result<Option<u64>> {
    const PIECE: u64 = 1 << 20;
    let mut buffer = Vec::new();
    let mut at = from;
    while at < limit {
        let piece = (limit - at).min(PIECE);
        buffer.resize(piece as usize, 0);
        source.read_at(at, &mut buffer)?;
        if let Some(place) = buffer.windows(MAGIC.len()).position(|window| window == MAGIC) {
            return Ok(Some(at + place as u64));
        }
        if piece < PIECE {
            break;
        }
        // Pieces overlap by one byte less than the magic, so that a magic across their border is found.
        at += piece - (MAGIC.len() as u64 - 1);
    }
    Ok(None)
}
