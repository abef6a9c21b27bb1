//! Where the chunks of a take are.

use std::io;
use std::path::Path;

use super::chunk::{ChunkHeader, HeaderError, Kind, MAGIC};
use super::index::{self, Entry, TRAILER_BYTES};
use super::probe::{data_of, head_of, header_at, is_sound, trailer};
use super::scan::by_scan;
use super::source::Source;
use super::{MOST_CHUNK_FRAMES, TAKE_VERSION, TakeError, TakeHeader};

/// Where everything is.
#[derive(Debug)]
pub(super) struct Map {
    pub(super) header: TakeHeader,
    /// Bytes of the file.
    pub(super) length: u64,
    /// The chunks of frames, in order. Frames between two are lost.
    pub(super) entries: Vec<Entry>,
    /// Frames of the take, with lost ones.
    pub(super) frames: u64,
    /// Why the take counts as cut.
    pub(super) cut: Option<String>,
    /// Damage of the file that was found first.
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

impl MapError {
    /// As the error of the file at `path`.
    pub(super) fn at(self, path: &Path) -> TakeError {
        let path = path.to_owned();
        match self {
            Self::Io(source) => TakeError::Io { path, action: "read".to_owned(), source },
            Self::NotATake { found } => {
                TakeError::NotATake { path, found, wanted: MAGIC.escape_ascii().to_string() }
            }
            Self::Newer(found) => TakeError::Newer { path, found, newest: TAKE_VERSION },
            Self::Malformed { offset, found, wanted } => TakeError::Malformed { path, offset, found, wanted },
        }
    }
}

impl From<io::Error> for MapError {
    fn from(error: io::Error) -> Self {
        Self::Io(error)
    }
}

/// Maps the `length` bytes of `source`: by the index where the take was finished and its ends are sound, or by looking
/// through it.
pub(super) fn map(source: &mut dyn Source, length: u64) -> Result<Map, MapError> {
    if length == 0 {
        return Err(MapError::NotATake { found: "an empty file".to_owned() });
    }
    if let Err(HeaderError::Newer(version)) = header_at(source, 0, length)? {
        return Err(MapError::Newer(version));
    }
    match by_index(source, length)? {
        Some(map) => Ok(map),
        None => by_scan(source, length),
    }
}

fn by_index(source: &mut dyn Source, length: u64) -> Result<Option<Map>, MapError> {
    let Some(trailer) = trailer(source, length)? else { return Ok(None) };
    let mut head = head_of(source, 0, length)?;
    if head.is_none() {
        head = head_of(source, trailer.head, length)?;
    }
    let Some((header, take)) = head.filter(|(_, take)| *take == trailer.take) else { return Ok(None) };
    let Ok(index) = header_at(source, trailer.index, length)? else { return Ok(None) };
    let at = Entry { offset: trailer.index, header: index };
    let ends_well = at.end().and_then(|end| end.checked_add(TRAILER_BYTES as u64)) == Some(length);
    if index.kind != Kind::Index || index.take != take || !ends_well {
        return Ok(None);
    }
    let Some(entries) = data_of(source, &at)?.and_then(|raw| index::parse(&raw)) else { return Ok(None) };
    let (mut frames, mut byte) = (0, 0);
    for entry in &entries {
        let good = fits(entry, take) && entry.header.first == frames && entry.offset >= byte;
        match entry.end() {
            Some(end) if good && end <= trailer.index => (frames, byte) = (entry.header.end(), end),
            _ => return Ok(None),
        }
    }
    let map = Map { header, length, entries, frames, cut: None, damage: None };
    Ok((frames == trailer.frames).then_some(map))
}

/// Whether a chunk of frames can belong to the take.
pub(super) fn fits(entry: &Entry, take: u32) -> bool {
    let ChunkHeader { kind, frames, changes, .. } = entry.header;
    kind == Kind::Frames
        && entry.header.take == take
        && (1..=MOST_CHUNK_FRAMES).contains(&frames)
        && changes < frames
}

impl Map {
    /// Looks at all that opening by the index leaves out, but for the frames themselves: says what is damaged.
    pub(super) fn inspect(&self, source: &mut dyn Source) -> io::Result<Option<String>> {
        let end = self.length.saturating_sub(TRAILER_BYTES as u64);
        let mut at = 0;
        while at < end {
            let entry = match header_at(source, at, self.length)? {
                Ok(header) => Entry { offset: at, header },
                Err(_) => return Ok(Some(format!("a chunk whose header is damaged at byte {at}"))),
            };
            let known = self.entries.binary_search_by_key(&at, |known| known.offset);
            let fits = entry.end().is_some_and(|after| after <= end);
            let good = match (entry.header.kind, known) {
                (Kind::Frames, Ok(chunk)) => self.entries[chunk].header == entry.header,
                (Kind::Head | Kind::Index, Err(_)) => fits && is_sound(source, &entry)?,
                _ => false,
            };
            if !good {
                return Ok(Some(format!("a chunk that was changed at byte {at}")));
            }
            at = entry.end().unwrap_or(u64::MAX);
        }
        Ok(None)
    }
}
