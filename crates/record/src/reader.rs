//! Reads films back.

use crate::RecordError;
use crate::mp4::{Movie, parse};
use crate::yuv::write_rgba;
use openh264::decoder::Decoder;
use serde::Serialize;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// What the tables of a film say.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FilmInfo {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Number of frames.
    pub frames: u64,
    /// Duration in seconds.
    pub duration_secs: f64,
    /// Four-letter code of the codec: `avc1` is H.264.
    pub codec: String,
}

/// Reads the tables of a film without decoding it.
///
/// # Errors
/// [`RecordError::Io`] if it cannot be read; [`RecordError::Malformed`] if it is not an MP4 file, or if its tables contradict
/// each other or the file's length.
pub fn read_film(path: &Path) -> Result<FilmInfo, RecordError> {
    film_in(path, &mut open(path)?)
}

/// As [`read_film`], from a file that is open. Some systems let nobody else read a locked one.
pub(crate) fn film_in(path: &Path, file: &mut File) -> Result<FilmInfo, RecordError> {
    Ok(info(&parse(path, file)?))
}

fn open(path: &Path) -> Result<File, RecordError> {
    File::open(path).map_err(|error| RecordError::io(path, "open the film", error))
}

fn info(movie: &Movie) -> FilmInfo {
    FilmInfo {
        width: movie.width,
        height: movie.height,
        frames: movie.frames.len() as u64,
        duration_secs: movie.duration_ticks as f64 / f64::from(movie.ticks_per_second),
        codec: String::from_utf8_lossy(&movie.codec).into_owned(),
    }
}

/// Decodes a film written by this crate (H.264 without reordered frames), frame by frame.
pub struct FilmReader {
    path: PathBuf,
    file: File,
    movie: Movie,
    decoder: Decoder,
    next: usize,
    stream: Vec<u8>,
}

impl FilmReader {
    /// Opens a film.
    ///
    /// # Errors
    /// As [`read_film`]; also [`RecordError::Malformed`] for a codec other than H.264.
    pub fn open(path: &Path) -> Result<Self, RecordError> {
        let mut file = open(path)?;
        let movie = parse(path, &mut file)?;
        let Some(config) = &movie.config else {
            return Err(RecordError::Malformed {
                path: path.to_owned(),
                offset: 0,
                found: format!("the codec `{}`", String::from_utf8_lossy(&movie.codec)),
                wanted: "H.264 (`avc1`)".into(),
            });
        };
        let mut stream = Vec::new();
        for set in [&config.sps, &config.pps] {
            stream.extend([0, 0, 0, 1]);
            stream.extend(set);
        }
        let decoder = Decoder::new().map_err(|error| RecordError::Encoder {
            path: path.to_owned(),
            frame: 0,
            reason: format!("no decoder: {error}"),
        })?;
        Ok(Self { path: path.to_owned(), file, movie, decoder, next: 0, stream })
    }

    /// What the tables of the film say.
    pub fn info(&self) -> FilmInfo {
        info(&self.movie)
    }

    /// Decodes the next frame into `rgba` (`width × height × 4` bytes, alpha 255). Returns false after the last frame.
    ///
    /// # Errors
    /// [`RecordError::Io`] if the file cannot be read, [`RecordError::Malformed`] if a frame cannot be decoded.
    pub fn next_frame(&mut self, rgba: &mut Vec<u8>) -> Result<bool, RecordError> {
        let Some(&(offset, size)) = self.movie.frames.get(self.next) else {
            return Ok(false);
        };
        let read = |error| RecordError::io(&self.path, format!("read frame {}", self.next), error);
        let mut sample = vec![0; size as usize];
        self.file.seek(SeekFrom::Start(offset)).map_err(read)?;
        self.file.read_exact(&mut sample).map_err(read)?;
        let malformed = |found: String| RecordError::Malformed {
            path: self.path.clone(),
            offset,
            found,
            wanted: format!("frame {} as H.264 of {}x{}", self.next, self.movie.width, self.movie.height),
        };
        // For the first frame the stream already contains the parameter sets, which `open` put there.
        let mut rest = &sample[..];
        while let Some((length, tail)) = rest.split_first_chunk::<4>() {
            let unit = tail.split_at_checked(u32::from_be_bytes(*length) as usize);
            let (unit, tail) = unit.ok_or_else(|| malformed("a NAL unit longer than its frame".into()))?;
            self.stream.extend([0, 0, 0, 1]);
            self.stream.extend(unit);
            rest = tail;
        }
        let decoded = self.decoder.decode(&self.stream).map_err(|error| malformed(error.to_string()))?;
        let picture = decoded.ok_or_else(|| malformed("no image".into()))?;
        let size = openh264::formats::YUVSource::dimensions(&picture);
        if size != (self.movie.width as usize, self.movie.height as usize) {
            return Err(malformed(format!("an image of {}x{}", size.0, size.1)));
        }
        write_rgba(&picture, rgba);
        self.stream.clear();
        self.next += 1;
        Ok(true)
    }
}
