//! Finding the chunks of a take: by its index, or by looking through the file.

use std::io;
use std::ops::Range;

use super::chunk::{ChunkHeader, HEADER_BYTES, HeaderError, Kind, MAGIC, unpack};
use super::index::{self, Entry, TRAILER_BYTES, Trailer};
use super::source::Source;
use super::{MOST_CHUNK_FRAMES, TakeHeader};

/// The header of a take lies within so many bytes of its start, even where its first copy is damaged.
const HEAD_WITHIN: u64 = 16 << 20;

/// Chunks at the end of a take that was not finished whose bytes are checked at once: later ones may have been on their
/// way to the disk.
const LAST_CHUNKS: usize = 2;

/// Where everything is.
#[derive(Debug)]
pub(super) struct Map {
    pub(super) header: TakeHeader,
    /// The chunks of frames, in order. Frames between two are lost.
    pub(super) entries: Vec<Entry>,
    /// Frames of the take, with lost ones.
    pub(super) frames: u64,
    /// Why the take counts as cut.
    pub(super) cut: Option<String>,
    /// Damage of the file that was found on the way, the first first.
    pub(super) damage: Option<String>,
}

/// Why a file could not be mapped.
#[derive(Debug)]
pub(super) enum MapError {
    Io(io::Error),
    NotATake { found: String },
    Newer(u32),
    Malformed { offset: u64, found: String, wanted: String },
}

impl From<io::Error> for MapError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

/// Maps the `length` bytes of `source`.
pub(super) fn map(source: &mut dyn Source, length: u64) -> Result<Map, MapError> {
    if length == 0 {
        return Err(MapError::NotATake { found: "an empty file".to_owned() });
    }
    if let Some(map) = by_index(source, length)? {
        return Ok(map);
    }
    by_scan(source, length)
}

/// The map of a take that was finished and whose ends are sound.
fn by_index(source: &mut dyn Source, length: u64) -> Result<Option<Map>, MapError> {
    let Ok((_, Ok(first))) = header_at(source, 0, length) else { return Ok(None) };
    let Some((header, take)) = head_of(source, &Entry { offset: 0, header: first }, length)? else {
        return Ok(None);
    };
    let Some(trailer) = trailer(source, length)?.filter(|trailer| trailer.take == take) else {
        return Ok(None);
    };
    let Ok((_, Ok(index))) = header_at(source, trailer.index, length) else { return Ok(None) };
    let at = Entry { offset: trailer.index, header: index };
    let ends_well = at.end().and_then(|end| end.checked_add(TRAILER_BYTES as u64)) == Some(length);
    if index.kind != Kind::Index || index.take != take || !ends_well {
        return Ok(None);
    }
    let Some(raw) = data_of(source, &at)? else { return Ok(None) };
    let Some(entries) = index::parse(&raw) else { return Ok(None) };
    let mut at = (0, 0);
    for entry in &entries {
        let good = fits(entry, take) && entry.header.first == at.0 && entry.offset >= at.1;
        match entry.end() {
            Some(end) if good && end <= trailer.index => at = (entry.header.end(), end),
            _ => return Ok(None),
        }
    }
    if at.0 != trailer.frames {
        return Ok(None);
    }
    Ok(Some(Map { header, entries, frames: trailer.frames, cut: None, damage: None }))
}

/// Looks through the file from its start, past damage to the next chunk that is sound.
fn by_scan(source: &mut dyn Source, length: u64) -> Result<Map, MapError> {
    let mut found = Scan { head: None, entries: Vec::new(), index: false, damage: None, cut: None };
    let mut at = 0;
    let mut newer = None;
    while at < length {
        if found.head.is_none() && at > HEAD_WITHIN {
            break;
        }
        let (bytes, parsed) = header_at(source, at, length)?;
        let entry = match parsed {
            Ok(header) => Entry { offset: at, header },
            Err(error) => {
                if let HeaderError::Newer(version) = error {
                    newer = newer.or(Some(version));
                }
                let limit = if found.head.is_none() { length.min(HEAD_WITHIN) } else { length };
                let trailer = index::Trailer::parse_start(&bytes);
                let next = next_magic(source, at + 1, limit)?;
                if !(trailer && length - at == TRAILER_BYTES as u64) {
                    found.note_damage(at, next, length, error);
                }
                at = next.unwrap_or(length);
                continue;
            }
        };
        if let Some(end) = entry.end().filter(|&end| end <= length) {
            found.add(source, entry, length)?;
            at = end;
        } else {
            let Range { start, end } = entry.header.first..entry.header.end();
            found.cut = Some(match entry.header.kind {
                Kind::Frames => {
                    format!("the file ends in the middle of frames {start} to {}", end.saturating_sub(1))
                }
                Kind::Head | Kind::Index => "the file ends in the middle of its index".to_owned(),
            });
            break;
        }
    }
    match (found.head.is_some(), newer) {
        (false, Some(version)) => return Err(MapError::Newer(version)),
        (false, None) => return Err(no_head(source, length)?),
        (true, _) => {}
    }
    found.into_map(source, length)
}

struct Scan {
    head: Option<(TakeHeader, u32)>,
    entries: Vec<Entry>,
    index: bool,
    damage: Option<String>,
    cut: Option<String>,
}

impl Scan {
    fn add(&mut self, source: &mut dyn Source, entry: Entry, length: u64) -> Result<(), MapError> {
        match entry.header.kind {
            Kind::Head if self.head.is_none() => {
                self.head = head_of(source, &entry, length)?;
                if self.head.is_none() {
                    self.damage.get_or_insert(format!("the header at byte {} is damaged", entry.offset));
                }
            }
            Kind::Head => {}
            Kind::Index => self.index = true,
            Kind::Frames => self.entries.push(entry),
        }
        Ok(())
    }

    fn note_damage(&mut self, at: u64, next: Option<u64>, length: u64, error: HeaderError) {
        let what = match error {
            HeaderError::Checksum => "a chunk whose header is damaged",
            HeaderError::Newer(_) | HeaderError::Absurd => "a chunk that no writer makes",
            HeaderError::Magic => "bytes that are no chunk",
        };
        if next.is_some() {
            self.damage.get_or_insert(format!("{what} at byte {at}"));
        } else {
            self.cut.get_or_insert(format!("{} bytes at the end are no whole chunk", length - at));
        }
    }

    fn into_map(self, source: &mut dyn Source, length: u64) -> Result<Map, MapError> {
        let Self { head, entries: all, index, mut damage, mut cut } = self;
        let Some((header, take)) = head else { return Err(no_head(source, length)?) };
        let trailer = trailer(source, length)?.filter(|trailer| trailer.take == take);
        let mut entries: Vec<Entry> = Vec::with_capacity(all.len());
        for entry in all {
            let (end, after) =
                entries.last().map_or((0, 0), |last| (last.header.end(), last.end().unwrap_or(u64::MAX)));
            // Frames that are lost took bytes, too.
            let room = (entry.offset - after) / HEADER_BYTES as u64 * u64::from(MOST_CHUNK_FRAMES);
            let gap = entry.header.first.checked_sub(end);
            if fits(&entry, take) && gap.is_some_and(|gap| gap <= room) {
                entries.push(entry);
            } else {
                damage.get_or_insert(format!("a chunk of another take at byte {}", entry.offset));
            }
        }
        if trailer.is_none() {
            cut.get_or_insert("it was never finished".to_owned());
            for _ in 0..LAST_CHUNKS {
                let Some(last) = entries.last() else { break };
                if is_sound(source, last)? {
                    break;
                }
                let Range { start, end } = last.header.first..last.header.end();
                cut = Some(format!("frames {start} to {} were not written whole", end - 1));
                entries.pop();
            }
        } else {
            let what = if index { "its index does not fit it" } else { "its index is damaged" };
            damage.get_or_insert(what.to_owned());
            cut = None;
        }
        let end = entries.last().map_or(0, |last| last.header.end());
        let frames = trailer.map_or(end, |trailer| {
            let lost = trailer.frames.saturating_sub(end);
            if lost <= length / HEADER_BYTES as u64 * u64::from(MOST_CHUNK_FRAMES) { end + lost } else { end }
        });
        Ok(Map { header, entries, frames, cut, damage })
    }
}

/// Whether a chunk of frames can belong to the take.
fn fits(entry: &Entry, take: u32) -> bool {
    let ChunkHeader { kind, frames, changes, .. } = entry.header;
    kind == Kind::Frames
        && entry.header.take == take
        && (1..=MOST_CHUNK_FRAMES).contains(&frames)
        && changes < frames
}

/// What there is instead of a header of a take.
fn no_head(source: &mut dyn Source, length: u64) -> Result<MapError, MapError> {
    let mut start = vec![0; length.min(8) as usize];
    source.read_at(0, &mut start)?;
    if start == MAGIC {
        let found = "a header that is damaged, and no whole copy of it".to_owned();
        return Ok(MapError::Malformed { offset: 0, found, wanted: "the header of a take".to_owned() });
    }
    Ok(MapError::NotATake { found: start.escape_ascii().to_string() })
}

/// The 64 bytes at `offset` (zeros past the end) and the header in them.
fn header_at(
    source: &mut dyn Source,
    offset: u64,
    length: u64,
) -> io::Result<([u8; HEADER_BYTES], Result<ChunkHeader, HeaderError>)> {
    let mut bytes = [0; HEADER_BYTES];
    let there = length.saturating_sub(offset).min(HEADER_BYTES as u64) as usize;
    if there > 0 {
        source.read_at(offset, &mut bytes[..there])?;
    }
    Ok((bytes, ChunkHeader::parse(&bytes)))
}

/// The header of the take in the chunk, and the take's number; nothing where the chunk holds none.
fn head_of(
    source: &mut dyn Source,
    entry: &Entry,
    length: u64,
) -> Result<Option<(TakeHeader, u32)>, MapError> {
    if entry.header.kind != Kind::Head || entry.end().is_none_or(|end| end > length) {
        return Ok(None);
    }
    let mut packed = vec![0; entry.header.text.packed as usize];
    source.read_at(entry.offset + HEADER_BYTES as u64, &mut packed)?;
    let Ok(text) = unpack(&packed, &entry.header.text) else { return Ok(None) };
    let take = crc32fast::hash(&text);
    if take != entry.header.take {
        return Ok(None);
    }
    let malformed = |found: String, wanted: &str| MapError::Malformed {
        offset: entry.offset,
        found,
        wanted: wanted.to_owned(),
    };
    let header: TakeHeader = serde_json::from_slice(&text)
        .map_err(|error| malformed(format!("a header that is none: {error}"), "the header of a take"))?;
    header.check().map_err(|(found, wanted)| malformed(found, &wanted))?;
    Ok(Some((header, take)))
}

fn trailer(source: &mut dyn Source, length: u64) -> io::Result<Option<Trailer>> {
    let Some(offset) = length.checked_sub(TRAILER_BYTES as u64) else { return Ok(None) };
    let mut bytes = [0; TRAILER_BYTES];
    source.read_at(offset, &mut bytes)?;
    Ok(Trailer::parse(&bytes))
}

/// The data part of a chunk that lies in the file; nothing where it is damaged.
fn data_of(source: &mut dyn Source, entry: &Entry) -> io::Result<Option<Vec<u8>>> {
    let mut packed = vec![0; entry.header.data.packed as usize];
    let offset = entry.offset + HEADER_BYTES as u64 + u64::from(entry.header.text.packed);
    source.read_at(offset, &mut packed)?;
    Ok(unpack(&packed, &entry.header.data).ok())
}

/// Whether both parts of a chunk are as they were written.
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

/// Where the next chunk may start, from `from` on and before `limit`.
fn next_magic(source: &mut dyn Source, from: u64, limit: u64) -> io::Result<Option<u64>> {
    const PIECE: u64 = 1 << 20;
    let mut buffer = Vec::new();
    let mut at = from;
    while at < limit {
        // Pieces overlap by a magic less one byte.
        let piece = (limit - at).min(PIECE);
        buffer.resize(piece as usize, 0);
        source.read_at(at, &mut buffer)?;
        if let Some(place) = buffer.windows(MAGIC.len()).position(|window| window == MAGIC) {
            return Ok(Some(at + place as u64));
        }
        if piece < PIECE {
            break;
        }
        at += piece - (MAGIC.len() as u64 - 1);
    }
    Ok(None)
}
