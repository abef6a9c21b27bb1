//! Finds the chunks of a take that was not finished or whose index is damaged, by scanning it from the start. After damage
//! it continues at the next intact chunk.

use super::chunk::{HEADER_BYTES, HeaderError, Kind};
use super::index::{Entry, TRAILER_BYTES, Trailer};
use super::map::{Map, MapError, fits};
use super::probe::{head_of, header_at, is_sound, next_magic, no_head, trailer};
use super::source::Source;
use super::{MAX_CHUNK_FRAMES, TakeHeader};

/// Bytes from the start of an unfinished take within which there is a copy of its header, even if the first copy is
/// damaged. Other files are not scanned any further.
const HEAD_WITHIN: u64 = 16 << 20;

/// Number of chunks at the end of an unfinished take that are checked on opening. A chunk is on the disk before the next one
/// is written, so only the last can be incomplete.
const LAST_CHUNKS: usize = 2;

pub(super) fn by_scan(source: &mut dyn Source, length: u64) -> Result<Map, MapError> {
    let trailer = trailer(source, length)?;
    let mut scan = Scan { head: None, entries: Vec::new(), damage: None, cut: None };
    if let Some(trailer) = trailer {
        scan.head = head_of(source, trailer.head, length)?;
    }
    let end = if trailer.is_some() { length - TRAILER_BYTES as u64 } else { length };
    let mut at = 0;
    while at < end {
        let limit = if scan.head.is_none() { end.min(HEAD_WITHIN) } else { end };
        at = match header_at(source, at, end)? {
            Ok(header) => scan.add(source, Entry { offset: at, header }, end)?,
            Err(HeaderError::Newer(version)) if scan.head.is_none() => return Err(MapError::Newer(version)),
            Err(error) => {
                let next = next_magic(source, at + 1, limit)?;
                scan.note_damage(at, next, end, error);
                next.unwrap_or(end)
            }
        };
    }
    let Some((header, take)) = scan.head.take() else { return Err(no_head(source, length)?) };
    scan.into_map(source, header, take, trailer.filter(|trailer| trailer.take == take), length)
}

/// The result of the scan so far.
struct Scan {
    head: Option<(TakeHeader, u32)>,
    entries: Vec<Entry>,
    damage: Option<String>,
    cut: Option<String>,
}

impl Scan {
    /// Adds a chunk. Returns the offset of the next one.
    fn add(&mut self, source: &mut dyn Source, entry: Entry, end: u64) -> Result<u64, MapError> {
        let Entry { offset, header } = entry;
        let Some(after) = entry.end().filter(|&after| after <= end) else {
            self.cut = Some(match header.kind {
                Kind::Frames => {
                    format!(
                        "the file ends in the middle of frames {} to {}",
                        header.first,
                        last_frame(&entry)
                    )
                }
                Kind::Head | Kind::Index => "the file ends in the middle of its header or index".to_owned(),
            });
            return Ok(end);
        };
        match header.kind {
            Kind::Head if self.head.is_none() => {
                self.head = head_of(source, offset, end)?;
                if self.head.is_none() {
                    self.damage.get_or_insert(format!("the header at byte {offset} is damaged"));
                }
            }
            Kind::Head | Kind::Index => {}
            Kind::Frames => self.entries.push(entry),
        }
        Ok(after)
    }

    fn note_damage(&mut self, at: u64, next: Option<u64>, end: u64, error: HeaderError) {
        let what = match error {
            HeaderError::Checksum => "a chunk whose header is damaged",
            HeaderError::Newer(_) | HeaderError::Absurd => "a chunk that no writer makes",
            HeaderError::Magic => "bytes that are not a chunk",
        };
        if next.is_some() {
            self.damage.get_or_insert(format!("{what} at byte {at}"));
        } else {
            self.cut.get_or_insert(format!("the last {} bytes are not a complete chunk", end - at));
        }
    }

    fn into_map(
        self,
        source: &mut dyn Source,
        header: TakeHeader,
        take: u32,
        trailer: Option<Trailer>,
        length: u64,
    ) -> Result<Map, MapError> {
        let Self { entries: found, mut damage, mut cut, .. } = self;
        let mut entries: Vec<Entry> = Vec::with_capacity(found.len());
        for entry in found {
            let end = entries.last().map_or(0, |last| last.header.end());
            let gap = entry.header.first.checked_sub(end);
            if fits(&entry, take) && gap.is_some_and(|gap| gap <= frames_in(length)) {
                entries.push(entry);
            } else {
                damage.get_or_insert(format!("a chunk of another take at byte {}", entry.offset));
            }
        }
        let mut frames = entries.last().map_or(0, |last| last.header.end());
        if let Some(trailer) = trailer {
            damage.get_or_insert_with(|| "its index is damaged".to_owned());
            cut = None;
            if trailer.frames.saturating_sub(frames) <= frames_in(length) {
                frames = frames.max(trailer.frames);
            }
        } else {
            cut.get_or_insert_with(|| "it was never finished".to_owned());
            for _ in 0..LAST_CHUNKS {
                let Some(last) = entries.last() else { break };
                if is_sound(source, last)? {
                    break;
                }
                let (first, last) = (last.header.first, last_frame(last));
                cut = Some(format!("frames {first} to {last} were not written completely"));
                entries.pop();
            }
            frames = entries.last().map_or(0, |last| last.header.end());
        }
        Ok(Map { header, length, entries, frames, cut, damage })
    }
}

/// The most frames that fit into `bytes` bytes. No more are regarded as lost.
fn frames_in(bytes: u64) -> u64 {
    (bytes / HEADER_BYTES as u64).saturating_mul(u64::from(MAX_CHUNK_FRAMES))
}

fn last_frame(entry: &Entry) -> u64 {
    entry.header.end().saturating_sub(1)
}
