//! Playback of takes.

use std::collections::BTreeMap;
use std::fs::File;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::bytes::Bytes;
use super::cache::Cache;
use super::chunk::{ChunkHeader, HEADER_BYTES, MAX_START_BYTES, Part, unpack, unpack_start};
use super::codec::{self, DecodedChunk};
use super::disk::part_path;
use super::index::Entry;
use super::layout::{LAYOUT_BYTES, Layout, TakeLayout};
use super::locate::{inspect, locate};
use super::map::Map;
use super::probe::is_sound;
use super::quantise::restore;
use super::settings::Settings;
use super::source::Source;
use super::{TakeCondition, TakeError, TakeFrame, TakeHeader};

/// Default bound of decoded chunks in memory, in bytes: seven seconds of a shipped hairstyle.
pub const CACHE_BYTES: usize = 64 << 20;

/// A take that is open for playback. It may be finished, cut or damaged.
pub struct TakeReader {
    path: PathBuf,
    source: Box<dyn Source>,
    map: Map,
    cache: Cache,
    project: Option<ProjectText>,
    /// Chunks that were found to be damaged, by their index in the map.
    bad: BTreeMap<usize, String>,
    /// Buffers for the numbers of a frame and for the two frames of an interpolation.
    numbers: Vec<i32>,
    ends: (TakeFrame, TakeFrame),
}

/// The project text that was returned last.
struct ProjectText {
    chunk: usize,
    settings: Settings,
    text: Arc<str>,
    /// The frames of the chunk for which it is valid.
    frames: Range<u32>,
}

impl TakeReader {
    /// Opens the take at `path`, finished or not (`NAME.take.part`). Reads only the start and the end of a finished take,
    /// and scans an unfinished one.
    ///
    /// # Errors
    /// [`TakeError::NotATake`], [`TakeError::Newer`], [`TakeError::Empty`] and [`TakeError::Malformed`], depending on the
    /// contents; [`TakeError::Io`] if the file cannot be read.
    pub fn open(path: &Path) -> Result<Self, TakeError> {
        let file = File::open(path).map_err(|error| {
            let part = part_path(path);
            if error.kind() == io::ErrorKind::NotFound && part.exists() {
                let what = format!("does not exist, but the unfinished take {} does", part.display());
                return TakeError::request(path, what);
            }
            TakeError::io(path, "open", error)
        })?;
        let data = file.metadata().map_err(|error| TakeError::io(path, "read", error))?;
        if data.is_dir() {
            return Err(TakeError::request(path, "is a folder; must be a take"));
        }
        Self::open_source(path, Box::new(file), data.len())
    }

    pub(super) fn open_source(
        path: &Path,
        mut source: Box<dyn Source>,
        length: u64,
    ) -> Result<Self, TakeError> {
        let map = locate(&mut *source, length).map_err(|error| error.at(path))?;
        if map.entries.is_empty() {
            let why = map.cut.or(map.damage).unwrap_or_else(|| "its index is empty".to_owned());
            return Err(TakeError::Empty { path: path.to_owned(), why });
        }
        Ok(Self {
            path: path.to_owned(),
            source,
            map,
            cache: Cache::new(CACHE_BYTES),
            project: None,
            bad: BTreeMap::new(),
            numbers: Vec::new(),
            ends: <(TakeFrame, TakeFrame)>::default(),
        })
    }

    /// Path of the file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Header of the take.
    pub fn header(&self) -> &TakeHeader {
        &self.map.header
    }

    /// Number of frames, including lost ones; at least 1.
    pub fn frames(&self) -> u64 {
        self.map.frames
    }

    /// Duration in seconds: the number of frames divided by the frame rate.
    pub fn duration_secs(&self) -> f64 {
        self.header().secs_of(self.frames())
    }

    /// Bounds the memory for decoded frames in bytes (default 64 MiB). The chunk that is being played is always kept.
    pub fn set_cache_bytes(&mut self, bytes: usize) {
        self.cache.set_bound(bytes);
    }

    /// Bytes of decoded frames in memory.
    pub fn cached_bytes(&self) -> usize {
        self.cache.bytes()
    }

    /// The damage that is known so far, from opening the take and from the frames played since.
    /// [`TakeReader::verify`] checks the whole file.
    pub fn condition(&self) -> TakeCondition {
        let lost = self.lost();
        let why = self.map.damage.as_ref().or_else(|| self.bad.values().next());
        match (why, &self.map.cut) {
            (None, None) if lost.is_empty() => TakeCondition::Whole,
            (None, Some(why)) if lost.is_empty() => {
                TakeCondition::Cut { frames: self.frames(), why: why.clone() }
            }
            (why, cut) => TakeCondition::Damaged {
                lost,
                cut: cut.is_some(),
                why: why.or(cut.as_ref()).cloned().unwrap_or_else(|| "frames are missing".to_owned()),
            },
        }
    }

    /// Reads the whole file and checks every checksum.
    ///
    /// # Errors
    /// [`TakeError::Io`] if the file cannot be read.
    pub fn verify(&mut self) -> Result<TakeCondition, TakeError> {
        for chunk in 0..self.map.entries.len() {
            let entry = self.map.entries[chunk];
            let why = match is_sound(&mut *self.source, &entry) {
                Ok(true) => continue,
                Ok(false) => format!("the chunk at byte {} was changed", entry.offset),
                Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                    format!("the file now ends before the end of the chunk at byte {}", entry.offset)
                }
                Err(error) => return Err(TakeError::io(&self.path, "read", error)),
            };
            self.bad.entry(chunk).or_insert(why);
        }
        if self.map.damage.is_none() && self.map.cut.is_none() {
            let found = inspect(&self.map, &mut *self.source);
            self.map.damage = found.map_err(|error| TakeError::io(&self.path, "read", error))?;
        }
        Ok(self.condition())
    }

    /// Frame `frame`, counted from 0.
    ///
    /// # Errors
    /// [`TakeError::NoSuchFrame`] after the end; [`TakeError::Lost`] if it is damaged, with the range of lost frames;
    /// [`TakeError::Io`] if the file cannot be read.
    pub fn frame(&mut self, frame: u64) -> Result<TakeFrame, TakeError> {
        let mut out = TakeFrame::default();
        self.frame_into(frame, &mut out)?;
        Ok(out)
    }

    /// As [`TakeReader::frame`], but reuses the memory of `out`. After an error `out` is unchanged.
    ///
    /// # Errors
    /// As [`TakeReader::frame`].
    pub fn frame_into(&mut self, frame: u64, out: &mut TakeFrame) -> Result<(), TakeError> {
        let (chunk, within) = self.find(frame)?;
        let decoded = self.decoded(chunk, frame)?;
        let meta = &decoded.metas[within as usize];
        out.guides.time_secs = meta.time_secs;
        out.guides.world_from_head = meta.world_from_head;
        out.clip_secs = meta.clip_secs;
        out.wall_frame = meta.wall_frame;
        out.substeps = meta.substeps;
        out.jumped = meta.jumped;
        decoded.numbers(within as usize, &mut self.numbers);
        restore(&self.numbers, decoded.layout, &mut out.guides);
        Ok(())
    }

    /// The instant `secs` after the start of the take, clamped to its duration and interpolated between the two frames beside it
    /// by [`TakeFrame::set_between`]. If one of the two is lost, it is the other one. Returns the number of the frame whose
    /// project and guides apply.
    ///
    /// # Errors
    /// As [`TakeReader::frame`] if both frames are lost.
    pub fn frame_at(&mut self, secs: f64, out: &mut TakeFrame) -> Result<u64, TakeError> {
        let rate = self.header().frames_per_second.as_f64();
        let last = self.frames() - 1;
        let place = if secs.is_finite() { (secs * rate).clamp(0.0, last as f64) } else { 0.0 };
        let (before, t) = (place.floor(), place - place.floor());
        let before = before as u64;
        // The motion in a thousandth of a frame is below the precision of stored positions.
        if t < 1e-3 || before >= last {
            return self.frame_into(before, out).map(|()| before);
        }
        if t > 1.0 - 1e-3 {
            return self.frame_into(before + 1, out).map(|()| before + 1);
        }
        let mut ends = std::mem::take(&mut self.ends);
        let result = match (self.frame_into(before, &mut ends.0), self.frame_into(before + 1, &mut ends.1)) {
            (Ok(()), Ok(())) => {
                out.set_between(&ends.0, &ends.1, t, self.map.header.clip_secs);
                Ok(before + u64::from(t >= 0.5))
            }
            (Ok(()), Err(TakeError::Lost { .. })) => {
                out.clone_from(&ends.0);
                Ok(before)
            }
            (Err(TakeError::Lost { .. }), Ok(())) => {
                out.clone_from(&ends.1);
                Ok(before + 1)
            }
            (Err(error), _) | (_, Err(error)) => Err(error),
        };
        self.ends = ends;
        result
    }

    /// The nearest frame that is not known to be lost; the earlier one of two at equal distance.
    pub fn nearest(&self, frame: u64) -> Option<u64> {
        let good = self.map.entries.iter().enumerate().filter(|(chunk, _)| !self.bad.contains_key(chunk));
        good.map(|(_, entry)| frame.clamp(entry.header.first, entry.header.end() - 1))
            .min_by_key(|&near| (near.abs_diff(frame), near))
    }

    /// The project's text at frame `frame`. The same `Arc` is returned while the text does not change.
    ///
    /// # Errors
    /// As [`TakeReader::frame`].
    pub fn project_at(&mut self, frame: u64) -> Result<Arc<str>, TakeError> {
        let (chunk, within) = self.find(frame)?;
        let same_chunk = self.project.as_ref().is_some_and(|known| known.chunk == chunk);
        if let Some(known) = self.project.as_ref().filter(|p| same_chunk && p.frames.contains(&within)) {
            return Ok(Arc::clone(&known.text));
        }
        let before = self.project.take();
        let (settings, old) = match before {
            Some(known) if same_chunk => (known.settings, Some(known.text)),
            before => {
                let Entry { offset, header } = self.map.entries[chunk];
                let raw = self.part(chunk, frame, offset + HEADER_BYTES as u64, &header.text)?;
                let settings =
                    Settings::parse(&raw, header.changes).map_err(|why| self.damaged(chunk, frame, &why))?;
                (settings, before.map(|known| known.text))
            }
        };
        let (text, frames) = settings.at(within).map_err(|why| self.damaged(chunk, frame, &why))?;
        let text = old.filter(|old| **old == *text).unwrap_or_else(|| text.into());
        self.project = Some(ProjectText { chunk, settings, text: Arc::clone(&text), frames });
        Ok(text)
    }

    /// The chunk that contains a frame, and the frame's index in it.
    fn find(&self, frame: u64) -> Result<(usize, u32), TakeError> {
        if frame >= self.frames() {
            return Err(TakeError::NoSuchFrame { path: self.path.clone(), frame, frames: self.frames() });
        }
        let after = self.map.entries.partition_point(|entry| entry.header.first <= frame);
        match after.checked_sub(1).map(|chunk| (chunk, self.map.entries[chunk].header)) {
            Some((chunk, header)) if frame < header.end() => match self.bad.get(&chunk) {
                None => Ok((chunk, (frame - header.first) as u32)),
                Some(why) => Err(self.lost_error(frame, header.first..header.end(), why.clone())),
            },
            before => {
                let start = before.map_or(0, |(_, header)| header.end());
                let end = self.map.entries.get(after).map_or(self.frames(), |entry| entry.header.first);
                let why = self.map.damage.clone().unwrap_or_else(|| "they are missing".to_owned());
                Err(self.lost_error(frame, start..end, why))
            }
        }
    }

    fn lost_error(&self, frame: u64, lost: Range<u64>, why: String) -> TakeError {
        TakeError::Lost { path: self.path.clone(), frame, first: lost.start, last: lost.end - 1, why }
    }

    /// Marks a chunk as damaged and returns the error for a frame in it.
    fn damaged(&mut self, chunk: usize, frame: u64, why: &str) -> TakeError {
        let Entry { offset, header } = self.map.entries[chunk];
        let why = format!("the chunk at byte {offset} was changed: {why}");
        self.bad.entry(chunk).or_insert(why.clone());
        self.lost_error(frame, header.first..header.end(), why)
    }

    /// All ranges of lost frames.
    fn lost(&self) -> Vec<Range<u64>> {
        let mut lost: Vec<Range<u64>> = Vec::new();
        let mut add = |range: Range<u64>| match lost.last_mut() {
            _ if range.is_empty() => {}
            Some(last) if last.end == range.start => last.end = range.end,
            _ => lost.push(range),
        };
        let mut end = 0;
        for (chunk, entry) in self.map.entries.iter().enumerate() {
            add(end..entry.header.first);
            end = entry.header.end();
            if self.bad.contains_key(&chunk) {
                add(entry.header.first..end);
            }
        }
        add(end..self.map.frames);
        lost
    }

    /// The frames of a chunk, from the cache or the file. `frame` is the requested one, for error messages.
    fn decoded(&mut self, chunk: usize, frame: u64) -> Result<Arc<DecodedChunk>, TakeError> {
        if let Some(decoded) = self.cache.get(chunk) {
            return Ok(decoded);
        }
        let Entry { offset, header } = self.map.entries[chunk];
        let offset = offset + HEADER_BYTES as u64 + u64::from(header.text.packed);
        let raw = self.part(chunk, frame, offset, &header.data)?;
        let decoded = codec::decode(&raw, header.frames as usize, self.known_layout(chunk))
            .map_err(|why| self.damaged(chunk, frame, &why))?;
        let decoded = Arc::new(decoded);
        self.cache.put(chunk, &decoded);
        Ok(decoded)
    }

    /// The layout of a chunk of version 1, which does not contain its layout.
    fn known_layout(&self, chunk: usize) -> Option<Layout> {
        let version = self.map.entries[chunk].header.version;
        if version == 1 { self.map.header.layout().ok() } else { None }
    }

    /// The layout in a chunk whose parts start at `offset`; `None` if it is damaged.
    fn stored_layout(&mut self, offset: u64, header: &ChunkHeader) -> Result<Option<Layout>, TakeError> {
        let mut packed = vec![0; header.data.packed.min(MAX_START_BYTES) as usize];
        match self.source.read_at(offset + u64::from(header.text.packed), &mut packed) {
            Ok(()) => {}
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => return Ok(None),
            Err(error) => return Err(TakeError::io(&self.path, "read", error)),
        }
        let start = unpack_start::<LAYOUT_BYTES>(&packed);
        Ok(start.and_then(|start| Layout::read(&mut Bytes::new(&start)).ok()))
    }

    /// The layouts of the frames, in order, with one entry per change. Lost chunks are skipped. Reads the start of every chunk.
    ///
    /// # Errors
    /// [`TakeError::Io`] if the file cannot be read.
    pub fn layouts(&mut self) -> Result<Vec<TakeLayout>, TakeError> {
        let mut layouts: Vec<TakeLayout> = Vec::new();
        for chunk in 0..self.map.entries.len() {
            let Entry { offset, header } = self.map.entries[chunk];
            let layout = match self.known_layout(chunk) {
                Some(layout) => Some(layout),
                None => self.stored_layout(offset + HEADER_BYTES as u64, &header)?,
            };
            let Some(layout) = layout else { continue };
            let [guides, points_per_guide] = [layout.guides, layout.points].map(|n| n as u32);
            let same = |last: &TakeLayout| (last.guides, last.points_per_guide) == (guides, points_per_guide);
            if !layouts.last().is_some_and(same) {
                layouts.push(TakeLayout { first_frame: header.first, guides, points_per_guide });
            }
        }
        Ok(layouts)
    }

    /// A part of a chunk, decompressed.
    fn part(&mut self, chunk: usize, frame: u64, offset: u64, part: &Part) -> Result<Vec<u8>, TakeError> {
        let mut packed = vec![0; part.packed as usize];
        match self.source.read_at(offset, &mut packed) {
            Ok(()) => {}
            Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                return Err(self.damaged(chunk, frame, "the file now ends before it"));
            }
            Err(error) => return Err(TakeError::io(&self.path, format!("read frame {frame}"), error)),
        }
        unpack(&packed, part).map_err(|why| self.damaged(chunk, frame, &why))
    }
}
