//! One type over films and sequences.

use crate::{
    FilmQuality, FilmReport, FilmSettings, FilmWriter, PreviewReport, PreviewSettings, PreviewWriter,
    RecordError, SequenceReport, SequenceSettings, SequenceWriter,
};
use std::path::Path;

/// What an output's name asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputKind {
    /// `.mp4`: a film.
    Film,
    /// `.apng`: an animated preview.
    Preview,
    /// A folder: a PNG sequence with a manifest.
    Sequence,
}

impl OutputKind {
    /// The kind that `path` asks for: `.mp4` (in any case) is a film, `.apng` a preview; a folder that exists, a name that ends in a
    /// separator, or a name without an extension is a sequence. `v1.2` has no extension: digits are none.
    ///
    /// # Errors
    /// [`RecordError::Request`] for any other extension, and for an empty path.
    pub fn of(path: &Path) -> Result<Self, RecordError> {
        if path.as_os_str().is_empty() {
            return Err(RecordError::request(
                "the output has no name: wanted a name ending in .mp4 or .apng, or a folder",
            ));
        }
        let ends_in_separator = path
            .as_os_str()
            .as_encoded_bytes()
            .last()
            .is_some_and(|&byte| std::path::is_separator(byte.into()));
        if ends_in_separator || path.is_dir() {
            return Ok(Self::Sequence);
        }
        match path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase()) {
            Some(extension) if extension == "mp4" => Ok(Self::Film),
            Some(extension) if extension == "apng" => Ok(Self::Preview),
            Some(extension) if extension.chars().any(|letter| !letter.is_ascii_digit()) => {
                Err(RecordError::request(format!(
                    "{}: cannot record to `.{extension}`: wanted a name ending in .mp4 (a film) or .apng (a preview), \
                     or a folder (a PNG sequence; end it with / if its name holds a dot)",
                    path.display()
                )))
            }
            _ => Ok(Self::Sequence),
        }
    }
}

/// What is recorded, for either kind of output.
#[derive(Debug, Clone, PartialEq)]
pub struct SinkSettings {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Frames per second.
    pub fps: f64,
    /// Number of the first frame; names the files of a sequence.
    pub first_frame: u64,
    /// Frames that will come; a preview says so at its start.
    pub frames: u64,
    /// How finely a film is coded.
    pub quality: FilmQuality,
    /// Whether a sequence or a preview keeps the alpha channel.
    pub alpha: bool,
    /// What draws the frames, for a sequence's manifest.
    pub settings: serde_json::Value,
}

impl SinkSettings {
    /// Settings of a size and rate, the rest as usual: one frame, from frame 0, high quality, no alpha.
    pub fn new(width: u32, height: u32, fps: f64) -> Self {
        Self {
            width,
            height,
            fps,
            first_frame: 0,
            frames: 1,
            quality: FilmQuality::default(),
            alpha: false,
            settings: serde_json::Value::Null,
        }
    }
}

/// What was written.
#[derive(Debug, Clone, PartialEq)]
pub enum SinkReport {
    /// A film.
    Film(FilmReport),
    /// A preview.
    Preview(PreviewReport),
    /// A sequence.
    Sequence(SequenceReport),
}

impl SinkReport {
    /// Frames written.
    pub fn frames(&self) -> u64 {
        match self {
            Self::Film(report) => report.frames,
            Self::Preview(report) => report.frames,
            Self::Sequence(report) => report.frames,
        }
    }

    /// Bytes written.
    pub fn bytes(&self) -> u64 {
        match self {
            Self::Film(report) => report.bytes,
            Self::Preview(report) => report.bytes,
            Self::Sequence(report) => report.bytes,
        }
    }

    /// The film, or the folder of the sequence.
    pub fn path(&self) -> &Path {
        match self {
            Self::Film(report) => &report.path,
            Self::Preview(report) => &report.path,
            Self::Sequence(report) => &report.folder,
        }
    }
}

/// Where the frames of a recording go. Dropping it without [`PictureSink::finish`] is a cancel.
#[derive(Debug)]
pub enum PictureSink {
    /// Into a film.
    Film(FilmWriter),
    /// Into a preview.
    Preview(PreviewWriter),
    /// Into a folder.
    Sequence(SequenceWriter),
}

impl PictureSink {
    /// Starts the output that `path` asks for (see [`OutputKind::of`]), creating missing folders.
    ///
    /// # Errors
    /// As [`FilmWriter::create`], [`PreviewWriter::create`], [`SequenceWriter::create`] and [`OutputKind::of`].
    pub fn for_path(path: &Path, settings: SinkSettings) -> Result<Self, RecordError> {
        let SinkSettings { width, height, fps, first_frame, frames, quality, alpha, settings } = settings;
        match OutputKind::of(path)? {
            OutputKind::Film => {
                FilmWriter::create(path, FilmSettings { width, height, fps, quality }).map(Self::Film)
            }
            OutputKind::Preview => {
                PreviewWriter::create(path, PreviewSettings { width, height, fps, frames, alpha })
                    .map(Self::Preview)
            }
            OutputKind::Sequence => {
                let settings = SequenceSettings { width, height, fps, first_frame, alpha, settings };
                SequenceWriter::create(path, settings).map(Self::Sequence)
            }
        }
    }

    /// Hands over the next frame: RGBA, 8 bits sRGB, rows from the top, `width × height × 4` bytes.
    ///
    /// # Errors
    /// As [`FilmWriter::push`], [`PreviewWriter::push`] and [`SequenceWriter::push`].
    pub fn push(&mut self, rgba: &[u8]) -> Result<(), RecordError> {
        match self {
            Self::Film(writer) => writer.push(rgba),
            Self::Preview(writer) => writer.push(rgba),
            Self::Sequence(writer) => writer.push(rgba),
        }
    }

    /// Makes the output whole.
    ///
    /// # Errors
    /// As [`FilmWriter::finish`], [`PreviewWriter::finish`] and [`SequenceWriter::finish`].
    pub fn finish(self) -> Result<SinkReport, RecordError> {
        match self {
            Self::Film(writer) => writer.finish().map(SinkReport::Film),
            Self::Preview(writer) => writer.finish().map(SinkReport::Preview),
            Self::Sequence(writer) => writer.finish().map(SinkReport::Sequence),
        }
    }

    /// Gives up: a film and a preview leave nothing, a sequence the frames that are whole.
    pub fn cancel(self) {}
}

#[cfg(test)]
mod tests {
    use super::{OutputKind, PictureSink, SinkSettings};
    use std::path::Path;

    #[test]
    fn the_name_decides() {
        for name in ["dance.mp4", "out/Dance.MP4", "ä b/c.mp4"] {
            assert_eq!(OutputKind::of(Path::new(name)).unwrap(), OutputKind::Film, "{name}");
        }
        for name in ["out/frames", "out/v1.2", "out/take.b/", "out/", "."] {
            assert_eq!(OutputKind::of(Path::new(name)).unwrap(), OutputKind::Sequence, "{name}");
        }
        for name in ["", "dance.avi", "dance.mp4.gz", "dance.png", "frames.take", "a.b2"] {
            let error = OutputKind::of(Path::new(name)).unwrap_err();
            assert!(error.is_request() && error.to_string().contains(".mp4"), "{name}: {error}");
        }
    }

    #[test]
    fn both_kinds_are_made_in_missing_folders() {
        let folder = tempfile::tempdir().unwrap();
        for (name, file) in [
            ("new/ö film/dance.mp4", "new/ö film/dance.mp4"),
            ("new/dance.APNG", "new/dance.APNG"),
            ("new/frames", "new/frames/manifest.json"),
        ] {
            let settings = SinkSettings::new(16, 16, 30.0);
            let mut sink = PictureSink::for_path(&folder.path().join(name), settings).unwrap();
            sink.push(&[7; 16 * 16 * 4]).unwrap();
            let report = sink.finish().unwrap();
            assert_eq!(report.frames(), 1);
            assert!(report.bytes() > 0);
            assert_eq!(report.path(), folder.path().join(name));
            assert!(folder.path().join(file).exists(), "{name}");
        }
    }
}
