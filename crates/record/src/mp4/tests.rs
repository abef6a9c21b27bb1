use super::{AvcConfig, Mp4Writer, Track, parse};
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
