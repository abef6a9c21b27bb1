//! Reads the tables of the first video track. Every count and offset is checked against the file's length.

use super::AvcConfig;
use crate::RecordError;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

/// Largest accepted size of the tables in bytes. A day at 60 frames per second needs 40 MB.
const LARGEST_TABLES: u64 = 256 << 20;

/// The tables of a film.
#[derive(Debug)]
pub(crate) struct Movie {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) ticks_per_second: u32,
    pub(crate) duration_ticks: u64,
    /// Four-letter code of the codec, such as `avc1`.
    pub(crate) codec: [u8; 4],
    /// Parameter sets, if the codec is H.264.
    pub(crate) config: Option<AvcConfig>,
    /// Offset and length in bytes of every frame, in order.
    pub(crate) frames: Vec<(u64, u32)>,
}

/// A part of the file in memory, with its offset for error messages.
#[derive(Clone, Copy)]
struct Span<'a> {
    path: &'a Path,
    start: u64,
    bytes: &'a [u8],
}

/// Reads the tables of an MP4 or QuickTime file, without the frames.
pub(crate) fn parse(path: &Path, file: &mut File) -> Result<Movie, RecordError> {
    let read = |error| RecordError::io(path, "read the film", error);
    let length = file.metadata().map_err(read)?.len();
    let mut at = 0;
    while at < length {
        file.seek(SeekFrom::Start(at)).map_err(read)?;
        let mut head = [0; 16];
        let got = (length - at).min(16) as usize;
        file.read_exact(&mut head[..got]).map_err(read)?;
        let (kind, header, size) = box_head(&head[..got], length - at).ok_or_else(|| {
            malformed(path, at, format!("bytes {:02X?}", &head[..got.min(8)]), "a box of the film")
        })?;
        if at == 0 && &kind != b"ftyp" {
            return Err(malformed(
                path,
                0,
                format!("bytes {:02X?}", &head[..8]),
                "an MP4 file (a box `ftyp`)",
            ));
        }
        if &kind == b"moov" {
            if size > LARGEST_TABLES {
                return Err(malformed(
                    path,
                    at,
                    format!("tables of {size} bytes"),
                    format!("at most {LARGEST_TABLES}"),
                ));
            }
            // `box_head` has checked that the box fits into the file.
            let mut bytes = vec![0; (size - header) as usize];
            file.seek(SeekFrom::Start(at + header)).map_err(read)?;
            file.read_exact(&mut bytes).map_err(read)?;
            return movie(Span { path, start: at + header, bytes: &bytes }, length);
        }
        at += size;
    }
    Err(malformed(path, length, "the end of the file", "the film's tables (a box `moov`)"))
}

/// Type, header length and total size of the box at the start of `bytes`, if it fits into `room` bytes.
fn box_head(bytes: &[u8], room: u64) -> Option<([u8; 4], u64, u64)> {
    let short = u32::from_be_bytes(*bytes.first_chunk()?);
    let kind = *bytes.get(4..)?.first_chunk()?;
    let (header, size) = match short {
        0 => (8, room),
        1 => (16, u64::from_be_bytes(*bytes.get(8..)?.first_chunk()?)),
        _ => (8, u64::from(short)),
    };
    (size >= header && size <= room).then_some((kind, header, size))
}

fn malformed(path: &Path, offset: u64, found: impl Into<String>, wanted: impl Into<String>) -> RecordError {
    RecordError::Malformed { path: path.to_owned(), offset, found: found.into(), wanted: wanted.into() }
}

impl<'a> Span<'a> {
    fn error(self, offset: usize, found: impl Into<String>, wanted: impl Into<String>) -> RecordError {
        malformed(self.path, self.start + offset as u64, found, wanted)
    }

    /// The boxes inside this one.
    fn boxes(self) -> Result<Vec<([u8; 4], Self)>, RecordError> {
        let mut boxes = Vec::new();
        let mut at = 0;
        while at < self.bytes.len() {
            let rest = &self.bytes[at..];
            let (kind, header, size) = box_head(rest, rest.len() as u64).ok_or_else(|| {
                self.error(at, "a box that is longer than the box around it", "a shorter one")
            })?;
            let body = Self {
                path: self.path,
                start: self.start + at as u64 + header,
                bytes: &rest[header as usize..size as usize],
            };
            boxes.push((kind, body));
            at += size as usize;
        }
        Ok(boxes)
    }

    fn find(self, wanted: [u8; 4]) -> Result<Self, RecordError> {
        let found = self.boxes()?.into_iter().find(|(kind, _)| *kind == wanted);
        found.map(|(_, body)| body).ok_or_else(|| {
            self.error(0, "no such box", format!("a box `{}`", String::from_utf8_lossy(&wanted)))
        })
    }

    fn u16(self, at: usize) -> Result<u16, RecordError> {
        let bytes = self.bytes.get(at..).and_then(<[u8]>::first_chunk);
        bytes
            .map(|b| u16::from_be_bytes(*b))
            .ok_or_else(|| self.error(at, "the end of the box", "2 bytes more"))
    }

    fn u32(self, at: usize) -> Result<u32, RecordError> {
        let bytes = self.bytes.get(at..).and_then(<[u8]>::first_chunk);
        bytes
            .map(|b| u32::from_be_bytes(*b))
            .ok_or_else(|| self.error(at, "the end of the box", "4 bytes more"))
    }

    fn u64(self, at: usize) -> Result<u64, RecordError> {
        Ok(u64::from(self.u32(at)?) << 32 | u64::from(self.u32(at + 4)?))
    }

    /// The entries of a table. Their count is at `at`, and the entries of `size` bytes follow.
    fn table(self, at: usize, size: usize) -> Result<std::slice::ChunksExact<'a, u8>, RecordError> {
        let count = u64::from(self.u32(at)?);
        let bytes = &self.bytes[at + 4..];
        if count * size as u64 > bytes.len() as u64 {
            let room = bytes.len() / size;
            return Err(self.error(
                at,
                format!("{count} entries"),
                format!("at most the {room} that fit into the box"),
            ));
        }
        Ok(bytes[..count as usize * size].chunks_exact(size))
    }
}

fn movie(moov: Span, file_length: u64) -> Result<Movie, RecordError> {
    for (kind, trak) in moov.boxes()? {
        if &kind != b"trak" {
            continue;
        }
        let mdia = trak.find(*b"mdia")?;
        if mdia.find(*b"hdlr")?.bytes.get(8..12) == Some(b"vide") {
            return track(mdia, file_length);
        }
    }
    Err(moov.error(0, "no video track", "one (a handler `vide`)"))
}

fn track(mdia: Span, file_length: u64) -> Result<Movie, RecordError> {
    let mdhd = mdia.find(*b"mdhd")?;
    let (ticks_per_second, duration_ticks) = match mdhd.bytes.first() {
        Some(1) => (mdhd.u32(20)?, mdhd.u64(24)?),
        _ => (mdhd.u32(12)?, u64::from(mdhd.u32(16)?)),
    };
    if ticks_per_second == 0 {
        return Err(mdhd.error(12, "a clock of 0 ticks a second", "1 or more"));
    }
    let stbl = mdia.find(*b"minf")?.find(*b"stbl")?;
    let stsd = stbl.find(*b"stsd")?;
    let entries = Span { start: stsd.start + 8, bytes: stsd.bytes.get(8..).unwrap_or_default(), ..stsd };
    let (codec, entry) =
        entries.boxes()?.into_iter().next().ok_or_else(|| stsd.error(4, "no codec", "one"))?;
    let (width, height) = (u32::from(entry.u16(24)?), u32::from(entry.u16(26)?));
    let parts = Span { start: entry.start + 78, bytes: entry.bytes.get(78..).unwrap_or_default(), ..entry };
    let config =
        if &codec == b"avc1" {
            let record = parts.find(*b"avcC")?;
            let config = AvcConfig::from_record(record.bytes);
            Some(config.ok_or_else(|| {
                record.error(0, "broken parameter sets", "an SPS and a PPS, four-byte lengths")
            })?)
        } else {
            None
        };
    let frames = frames(stbl, file_length)?;
    Ok(Movie { width, height, ticks_per_second, duration_ticks, codec, config, frames })
}

/// Offset and length of every frame, from the tables of sizes, chunks and frames per chunk.
fn frames(stbl: Span, file_length: u64) -> Result<Vec<(u64, u32)>, RecordError> {
    let word = |entry: &[u8], at: usize| entry[at..].first_chunk().map_or(0, |b| u32::from_be_bytes(*b));
    let stsz = stbl.find(*b"stsz")?;
    let (uniform, count) = (stsz.u32(4)?, stsz.u32(8)?);
    if uniform != 0 && u64::from(uniform) * u64::from(count) > file_length {
        return Err(stsz.error(
            8,
            format!("{count} frames of {uniform} bytes"),
            "no more than fit into the file",
        ));
    }
    let sizes: Vec<u32> = if uniform == 0 {
        stsz.table(8, 4)?.map(|entry| word(entry, 0)).collect()
    } else {
        vec![uniform; count as usize]
    };

    let chunks: Vec<u64> = match stbl.find(*b"stco") {
        Ok(stco) => stco.table(4, 4)?.map(|entry| u64::from(word(entry, 0))).collect(),
        Err(_) => stbl
            .find(*b"co64")?
            .table(4, 8)?
            .map(|entry| u64::from(word(entry, 0)) << 32 | u64::from(word(entry, 4)))
            .collect(),
    };
    let stsc = stbl.find(*b"stsc")?;
    let runs: Vec<(u64, u32)> =
        stsc.table(4, 12)?.map(|entry| (u64::from(word(entry, 0)), word(entry, 4))).collect();

    let mut frames = Vec::with_capacity(sizes.len());
    let mut run = 0;
    for (index, &chunk) in chunks.iter().enumerate() {
        while run + 1 < runs.len() && runs[run + 1].0 <= index as u64 + 1 {
            run += 1;
        }
        let mut at = chunk;
        let in_chunk = runs.get(run).map_or(0, |run| run.1) as usize;
        let first = frames.len();
        for &size in &sizes[first..first.saturating_add(in_chunk).min(sizes.len())] {
            if at.checked_add(u64::from(size)).is_none_or(|end| end > file_length) {
                let found = format!("frame {} at byte {at}, {size} bytes long", frames.len());
                return Err(stsz.error(0, found, format!("a frame inside the file of {file_length} bytes")));
            }
            frames.push((at, size));
            at += u64::from(size);
        }
    }
    if frames.len() != sizes.len() {
        let found = format!("{} frames with an offset", frames.len());
        return Err(stsc.error(0, found, format!("all {} that have a length", sizes.len())));
    }
    Ok(frames)
}
