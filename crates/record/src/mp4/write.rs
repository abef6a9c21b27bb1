//! Writes MP4 files: frames as they arrive, and at the end the tables that locate them.

use super::AvcConfig;
use super::boxes::{chunk_offsets, full, identity_matrix, leaf, nest, numbers, same_file};
use super::sound::{SoundTrack, TrackTimes};
use std::io::{self, Seek, SeekFrom, Write};

/// Frames per chunk. Players read one chunk at a time.
const FRAMES_PER_CHUNK: u32 = 16;

/// The video track of a film.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Track {
    /// Width in pixels, at most 65,535.
    pub(crate) width: u16,
    /// Height in pixels.
    pub(crate) height: u16,
    /// Clock ticks per second.
    pub(crate) ticks_per_second: u32,
    /// Clock ticks per frame.
    pub(crate) ticks_per_frame: u32,
}

/// The tables of what is written of a film. They are right where `mdat` ends at `end` and they follow it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Tables {
    /// Offset of `mdat`.
    pub(crate) mdat_start: u64,
    /// The end of the images.
    pub(crate) end: u64,
    /// The box `moov`.
    pub(crate) moov: Vec<u8>,
}

/// An MP4 file that is being written: `ftyp`, then `mdat` frame by frame, then `moov`.
pub(crate) struct Mp4Writer<W> {
    out: W,
    track: Track,
    /// Offset of `mdat`, and of the next byte.
    mdat_start: u64,
    position: u64,
    sizes: Vec<u32>,
    chunks: Vec<u64>,
    /// Key frames, counted from 1 as in the table.
    keys: Vec<u32>,
    sound: Option<SoundTrack>,
}

impl<W: Write + Seek> Mp4Writer<W> {
    pub(crate) fn new(mut out: W, track: Track) -> io::Result<Self> {
        let ftyp = leaf(*b"ftyp", |b| {
            b.extend(b"isom");
            b.extend(512_u32.to_be_bytes());
            b.extend(b"isomiso2avc1mp41");
        });
        out.write_all(&ftyp)?;
        let mdat_start = ftyp.len() as u64;
        // Size 1 means that a 64-bit size follows. It is written at the end, when it is known.
        out.write_all(&1_u32.to_be_bytes())?;
        out.write_all(b"mdat")?;
        out.write_all(&16_u64.to_be_bytes())?;
        let position = mdat_start + 16;
        let (sizes, chunks, keys) = (Vec::new(), Vec::new(), Vec::new());
        Ok(Self { out, track, mdat_start, position, sizes, chunks, keys, sound: None })
    }

    /// What the film is written to.
    pub(crate) fn medium(&mut self) -> &mut W {
        &mut self.out
    }

    /// Gives the film a track of sound.
    pub(crate) fn add_sound(&mut self, track: SoundTrack) {
        self.sound = Some(track);
    }

    /// Whether the next frame begins a chunk. Only then packets of sound may be written, because a chunk is contiguous.
    pub(crate) fn is_between_chunks(&self) -> bool {
        (self.sizes.len() as u32).is_multiple_of(FRAMES_PER_CHUNK)
    }

    /// Appends packets of sound, which become one chunk.
    pub(crate) fn write_sound(&mut self, packets: &[Vec<u8>]) -> io::Result<()> {
        let Some(track) = &mut self.sound else { return Ok(()) };
        for packet in packets {
            self.out.write_all(packet)?;
        }
        self.position += track.add_chunk(self.position, packets);
        Ok(())
    }

    /// Appends one encoded frame.
    pub(crate) fn write_frame(&mut self, sample: &[u8], key: bool) -> io::Result<()> {
        let size = u32::try_from(sample.len())
            .map_err(|_| io::Error::other("an encoded frame of more than 4 GiB"))?;
        self.out.write_all(sample)?;
        if (self.sizes.len() as u32).is_multiple_of(FRAMES_PER_CHUNK) {
            self.chunks.push(self.position);
        }
        self.sizes.push(size);
        if key {
            self.keys.push(self.sizes.len() as u32);
        }
        self.position += u64::from(size);
        Ok(())
    }

    /// Hands everything written so far to the medium, and returns the tables of it.
    pub(crate) fn tables_so_far(&mut self, config: &AvcConfig) -> io::Result<Tables> {
        self.out.flush()?;
        Ok(Tables { mdat_start: self.mdat_start, end: self.position, moov: self.moov(config) })
    }

    /// Writes the tables and the size of `mdat`. Returns the medium and the length of the file in bytes.
    pub(crate) fn finish(mut self, config: &AvcConfig) -> io::Result<(W, u64)> {
        let moov = self.moov(config);
        self.out.write_all(&moov)?;
        self.out.seek(SeekFrom::Start(self.mdat_start + 8))?;
        self.out.write_all(&(self.position - self.mdat_start).to_be_bytes())?;
        self.out.flush()?;
        Ok((self.out, self.position + moov.len() as u64))
    }

    fn moov(&self, config: &AvcConfig) -> Vec<u8> {
        let Track { width, height, ticks_per_second, ticks_per_frame } = self.track;
        let duration = self.sizes.len() as u64 * u64::from(ticks_per_frame);
        let mvhd = full(*b"mvhd", 1, 0, |b| {
            b.extend([0; 16]); // No times of creation, so that the same images give the same file.
            b.extend(ticks_per_second.to_be_bytes());
            b.extend(duration.to_be_bytes());
            b.extend(0x0001_0000_u32.to_be_bytes()); // Normal rate.
            b.extend(0x0100_u16.to_be_bytes()); // Full volume.
            b.extend([0; 10]);
            b.extend(identity_matrix());
            b.extend([0; 24]);
            // Number of the next track.
            b.extend((2 + u32::from(self.sound.is_some())).to_be_bytes());
        });
        // Flags: enabled, in the movie and in the preview.
        let tkhd = full(*b"tkhd", 1, 7, |b| {
            b.extend([0; 16]);
            b.extend(1_u32.to_be_bytes());
            b.extend([0; 4]);
            b.extend(duration.to_be_bytes());
            b.extend([0; 16]);
            b.extend(identity_matrix());
            b.extend((u32::from(width) << 16).to_be_bytes());
            b.extend((u32::from(height) << 16).to_be_bytes());
        });
        let mdhd = full(*b"mdhd", 1, 0, |b| {
            b.extend([0; 16]);
            b.extend(ticks_per_second.to_be_bytes());
            b.extend(duration.to_be_bytes());
            b.extend([0x55, 0xC4, 0, 0]); // Language: undetermined.
        });
        let hdlr = full(*b"hdlr", 0, 0, |b| {
            b.extend([0; 4]);
            b.extend(b"vide");
            b.extend([0; 12]);
            b.extend(b"Lovelock\0");
        });
        let vmhd = full(*b"vmhd", 0, 1, |b| b.extend([0; 8]));
        let minf = nest(*b"minf", &[vmhd, same_file(), self.stbl(config)]);
        let mdia = nest(*b"mdia", &[mdhd, hdlr, minf]);
        let mut parts = vec![mvhd, nest(*b"trak", &[tkhd, mdia])];
        let times = TrackTimes { ticks_per_second, duration, large: u32::try_from(self.position).is_err() };
        parts.extend(self.sound.as_ref().map(|sound| sound.trak(times)));
        nest(*b"moov", &parts)
    }

    fn stbl(&self, config: &AvcConfig) -> Vec<u8> {
        let Track { width, height, ticks_per_frame, .. } = self.track;
        let frames = self.sizes.len() as u32;
        let avc1 = leaf(*b"avc1", |b| {
            b.extend([0, 0, 0, 0, 0, 0, 0, 1]);
            b.extend([0; 16]);
            b.extend(width.to_be_bytes());
            b.extend(height.to_be_bytes());
            b.extend(0x0048_0000_u32.to_be_bytes()); // 72 dots per inch, horizontally and vertically.
            b.extend(0x0048_0000_u32.to_be_bytes());
            b.extend([0; 4]);
            b.extend(1_u16.to_be_bytes());
            b.extend([0; 32]); // No compressor name.
            b.extend(24_u16.to_be_bytes());
            b.extend([0xFF, 0xFF]);
            b.extend(leaf(*b"avcC", |b| b.extend(config.record())));
            // BT.709 primaries, sRGB transfer, BT.709 matrix, limited range; the same as in the stream.
            b.extend(leaf(*b"colr", |b| b.extend(b"nclx\0\x01\0\x0D\0\x01\0")));
            b.extend(leaf(*b"pasp", |b| b.extend([0, 0, 0, 1, 0, 0, 0, 1])));
        });
        let stsd = full(*b"stsd", 0, 0, |b| {
            b.extend(1_u32.to_be_bytes());
            b.extend(avc1);
        });
        let stts = full(*b"stts", 0, 0, |b| numbers(b, 1, [frames, ticks_per_frame]));
        let stss = full(*b"stss", 0, 0, |b| numbers(b, self.keys.len(), self.keys.iter().copied()));
        let rest = frames % FRAMES_PER_CHUNK;
        let whole_chunks = frames / FRAMES_PER_CHUNK;
        let mut runs = Vec::new();
        if whole_chunks > 0 {
            runs.push([1, FRAMES_PER_CHUNK, 1]);
        }
        if rest > 0 {
            runs.push([whole_chunks + 1, rest, 1]);
        }
        let stsc = full(*b"stsc", 0, 0, |b| numbers(b, runs.len(), runs.concat()));
        let stsz = full(*b"stsz", 0, 0, |b| {
            b.extend([0; 4]);
            numbers(b, self.sizes.len(), self.sizes.iter().copied());
        });
        let offsets = chunk_offsets(&self.chunks, u32::try_from(self.position).is_err());
        nest(*b"stbl", &[stsd, stts, stss, stsc, stsz, offsets])
    }
}
