//! Finds the chunks of a take by its index if the take was finished, otherwise by scanning the file.

use std::io;

use super::chunk::{HeaderError, Kind};
use super::index::{self, Entry, TRAILER_BYTES};
use super::map::{Map, MapError, fits};
use super::probe::{data_of, head_of, header_at, is_sound, trailer};
use super::scan::by_scan;
use super::source::Source;

/// Maps the `length` bytes of `source`: by the index if the take was finished and its start and end are intact, otherwise by a
/// scan.
pub(super) fn locate(source: &mut dyn Source, length: u64) -> Result<Map, MapError> {
    if length == 0 {
        return Err(MapError::NotATake { why: "is empty; must be a take".to_owned() });
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

/// Checks every part of the file that opening by the index skips, except the data of frames. Returns the first damage found.
pub(super) fn inspect(map: &Map, source: &mut dyn Source) -> io::Result<Option<String>> {
    let end = map.length.saturating_sub(TRAILER_BYTES as u64);
    let mut at = 0;
    while at < end {
        let entry = match header_at(source, at, map.length)? {
            Ok(header) => Entry { offset: at, header },
            Err(_) => return Ok(Some(format!("a chunk whose header is damaged at byte {at}"))),
        };
        let known = map.entries.binary_search_by_key(&at, |known| known.offset);
        let fits = entry.end().is_some_and(|after| after <= end);
        let good = match (entry.header.kind, known) {
            (Kind::Frames, Ok(chunk)) => map.entries[chunk].header == entry.header,
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
