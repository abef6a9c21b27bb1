use super::{AvcConfig, Mp4Writer, SoundTrack, Track, parse};
use crate::RecordError;
use std::fs::{self, File};
use std::io::{self, Cursor, Seek, SeekFrom, Write};
use std::path::Path;

const TRACK: Track = Track { width: 64, height: 32, ticks_per_second: 12_000, ticks_per_frame: 400 };

fn config() -> AvcConfig {
    AvcConfig { sps: vec![0x67, 66, 0xC0, 31, 9], pps: vec![0x68, 1] }
}

fn film(frames: usize) -> Vec<u8> {
    let mut writer = Mp4Writer::new(Cursor::new(Vec::new()), TRACK).unwrap();
    for frame in 0..frames {
        writer.write_frame(&vec![frame as u8; 10 + frame], frame % 10 == 0).unwrap();
    }
    let (cursor, length) = writer.finish(&config()).unwrap();
    assert_eq!(cursor.get_ref().len() as u64, length);
    cursor.into_inner()
}

fn parse_bytes(bytes: &[u8]) -> Result<super::Movie, RecordError> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.mp4");
    fs::write(&path, bytes).unwrap();
    parse(&path, &mut File::open(&path).unwrap())
}

#[test]
fn every_frame_is_found_again() {
    // No frame, one frame, one chunk, one frame more, two chunks, and more.
    for count in [0, 1, 16, 17, 32, 50] {
        let bytes = film(count);
        let movie = parse_bytes(&bytes).unwrap();
        assert_eq!((movie.width, movie.height, movie.frames.len()), (64, 32, count));
        assert_eq!((movie.ticks_per_second, movie.duration_ticks), (12_000, 400 * count as u64));
        assert_eq!(movie.config, Some(config()));
        for (frame, &(offset, size)) in movie.frames.iter().enumerate() {
            assert_eq!(&bytes[offset as usize..][..size as usize], vec![frame as u8; 10 + frame]);
        }
    }
}

#[test]
fn a_cut_film_is_refused_at_every_length() {
    let bytes = film(20);
    for length in 0..bytes.len() {
        let error = parse_bytes(&bytes[..length]).unwrap_err();
        assert!(error.is_request() && error.to_string().contains("film.mp4"), "{length}: {error}");
    }
}

/// Sets each byte of the tables to extreme values. The result is a movie or an error, never a panic or a large allocation.
#[test]
fn broken_tables_never_panic() {
    let bytes = film(20);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.mp4");
    let mut refused = 0;
    for at in (0..40).chain(bytes.len() - 900..bytes.len()) {
        for value in [0, 0x7F, 0xFF] {
            let mut broken = bytes.clone();
            broken[at] = value;
            fs::write(&path, &broken).unwrap();
            refused += usize::from(parse(&path, &mut File::open(&path).unwrap()).is_err());
        }
    }
    // Most bytes of the tables belong to names and counts that are checked.
    assert!(refused > 500, "{refused}");
}

#[test]
fn other_files_are_refused_by_their_first_bytes() {
    for bytes in [&b""[..], b"x", b"RIFF1234WAVEfmt ", b"\x89PNG\r\n\x1a\n0000IHDR", &[0; 64]] {
        assert!(parse_bytes(bytes).unwrap_err().is_request());
    }
    let missing = Path::new("no/such/film.mp4");
    assert!(matches!(crate::read_film(missing), Err(RecordError::Io { .. })));
}

/// A file in which large writes only move the position, so that the test does not fill the disk.
#[cfg(unix)]
struct Sparse(File);

#[cfg(unix)]
impl Write for Sparse {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if bytes.len() < 1 << 20 {
            return self.0.write(bytes);
        }
        self.0.seek(SeekFrom::Current(bytes.len() as i64))?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush()
    }
}

#[cfg(unix)]
impl Seek for Sparse {
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        self.0.seek(position)
    }
}

#[cfg(unix)]
#[test]
fn films_over_four_gibibytes_have_wide_offsets() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("film.mp4");
    let mut writer = Mp4Writer::new(Sparse(File::create(&path).unwrap()), TRACK).unwrap();
    let frame = vec![0; 80 << 20];
    for _ in 0..60 {
        writer.write_frame(&frame, true).unwrap();
    }
    writer.finish(&config()).unwrap();
    let movie = parse(&path, &mut File::open(&path).unwrap()).unwrap();
    assert_eq!(movie.frames.len(), 60);
    let (first, _) = movie.frames[0];
    assert_eq!(movie.frames[59], (first + 59 * (80 << 20), 80 << 20));
}

/// A film of 20 frames at 30 frames per second with sound: 34 packets of 20 ms in two chunks.
fn film_with_sound() -> Vec<u8> {
    let mut writer = Mp4Writer::new(Cursor::new(Vec::new()), TRACK).unwrap();
    writer.add_sound(SoundTrack::new(2, 120, 960));
    let packets: Vec<Vec<u8>> = (0..34).map(|i| vec![200 + i; 3 + usize::from(i)]).collect();
    for frame in 0..20 {
        writer.write_frame(&vec![frame as u8; 10 + frame], frame % 10 == 0).unwrap();
        if writer.is_between_chunks() {
            writer.write_sound(&packets[..27]).unwrap();
        }
    }
    writer.write_sound(&packets[27..]).unwrap();
    writer.finish(&config()).unwrap().0.into_inner()
}

/// The contents of the box at the end of a path.
fn find<'a>(mut bytes: &'a [u8], path: &[(&[u8; 4], usize)]) -> &'a [u8] {
    for (kind, which) in path {
        let mut at = 0;
        let mut left = *which;
        bytes = loop {
            let size = u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
            let size = if size == 1 {
                u64::from_be_bytes(bytes[at + 8..at + 16].try_into().unwrap())
            } else {
                size.into()
            };
            if bytes[at + 4..at + 8] == **kind {
                if left == 0 {
                    break &bytes[at + 8..at + size as usize];
                }
                left -= 1;
            }
            at += size as usize;
        };
    }
    bytes
}

#[test]
fn the_sound_is_found_by_its_tables_and_the_frames_as_before() {
    let bytes = film_with_sound();
    let movie = parse_bytes(&bytes).unwrap();
    for (frame, &(offset, size)) in movie.frames.iter().enumerate() {
        assert_eq!(&bytes[offset as usize..][..size as usize], vec![frame as u8; 10 + frame]);
    }
    let track = [(b"moov", 0), (b"trak", 1)];
    let words = |bytes: &[u8]| -> Vec<u32> {
        bytes.chunks_exact(4).map(|word| u32::from_be_bytes(word.try_into().unwrap())).collect()
    };
    // 20 frames of 400 ticks; the sound starts at sample 120 and ends with the film after 32,000 samples.
    let elst = find(&bytes, &[&track[..], &[(b"edts", 0), (b"elst", 0)]].concat());
    assert_eq!(words(elst), [0x0100_0000, 1, 0, 8000, 0, 120, 0x1_0000]);
    let mdia = [&track[..], &[(b"mdia", 0)]].concat();
    let mdhd = find(&bytes, &[&mdia[..], &[(b"mdhd", 0)]].concat());
    assert_eq!(words(mdhd)[5..8], [48_000, 0, 32_120]);
    let stbl = [&mdia[..], &[(b"minf", 0), (b"stbl", 0)]].concat();
    let table = |kind: &'static [u8; 4]| find(&bytes, &[&stbl[..], &[(kind, 0)]].concat());
    assert_eq!(words(table(b"stts")), [0, 2, 33, 960, 1, 440], "the last one ends with the film");
    assert_eq!(words(table(b"stsc")), [0, 2, 1, 27, 1, 2, 7, 1]);
    let (sizes, chunks) = (words(table(b"stsz")), words(table(b"stco")));
    assert_eq!((sizes[2], sizes.len()), (34, 37));
    let mut packet = 0;
    for (chunk, count) in [(chunks[2], 27), (chunks[3], 7)] {
        let mut at = chunk as usize;
        for _ in 0..count {
            let size = sizes[3 + packet] as usize;
            assert_eq!(bytes[at..at + size], vec![200 + packet as u8; 3 + packet]);
            (at, packet) = (at + size, packet + 1);
        }
    }
    let stsd = table(b"stsd");
    assert_eq!(&stsd[12..16], b"Opus");
    // Version, channels, pre-skip, rate, gain, family of channels.
    assert_eq!(&stsd[8 + 36..], b"\0\0\0\x13dOps\0\x02\0\x78\0\0\xBB\x80\0\0\0");
}
