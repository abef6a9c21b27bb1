//! One type for every output of images: films, previews and sequences.

use crate::{
    FilmQuality, FilmReport, FilmSettings, FilmWriter, FrameLayers, PreviewReport, PreviewSettings,
    PreviewWriter, RecordError, SequenceFormat, SequenceReport, SequenceSettings, SequenceWriter,
    SoundSource,
};
use std::path::Path;

/// The kind of output, by its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputKind {
    /// `.mp4`: a film.
    Film,
    /// `.apng`: an animated preview.
    Preview,
    /// A folder: a sequence of PNG or EXR files with a manifest.
    Sequence,
}

impl OutputKind {
    /// The kind of the output `path`: `.mp4` (in upper or lower case) is a film, `.apng` a preview. An existing folder, a name that
    /// ends in a separator, and a name without an extension are sequences. Digits are not an extension: `v1.2` has none.
    ///
    /// # Errors
    /// [`RecordError::Request`] for any other extension, and for an empty path.
    pub fn of(path: &Path) -> Result<Self, RecordError> {
        if path.as_os_str().is_empty() {
            return Err(RecordError::request(
                "the output has no name: must be a name ending in .mp4 or .apng, or a folder",
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
                    "{}: cannot record to `.{extension}`: the name must end in .mp4 (a film) or .apng (a preview), \
                     or be a folder (an image sequence; end it with / if its name contains a dot)",
                    path.display()
                )))
            }
            _ => Ok(Self::Sequence),
        }
    }
}

/// Settings of a recording, for every kind of output.
#[derive(Debug, Clone, PartialEq)]
pub struct SinkSettings {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Frames per second.
    pub fps: f64,
    /// Number of the first frame, which names the files of a sequence.
    pub first_frame: u64,
    /// Number of frames. A preview stores it before its first frame.
    pub frames: u64,
    /// Quality of a film.
    pub quality: FilmQuality,
    /// File format of a sequence.
    pub format: SequenceFormat,
    /// Whether a sequence or a preview keeps the alpha channel.
    pub alpha: bool,
    /// Whether to resume an existing sequence.
    pub resume: bool,
    /// How the frames are rendered, for the manifest of a sequence.
    pub settings: serde_json::Value,
}

impl SinkSettings {
    /// Settings with this size and rate and default values otherwise: one frame, from frame 0, high quality, no alpha.
    pub fn new(width: u32, height: u32, fps: f64) -> Self {
        Self {
            width,
            height,
            fps,
            first_frame: 0,
            frames: 1,
            quality: FilmQuality::default(),
            format: SequenceFormat::default(),
            alpha: false,
            resume: false,
            settings: serde_json::Value::Null,
        }
    }
}

impl SinkSettings {
    /// Checks that this kind of output supports the settings.
    ///
    /// # Errors
    /// [`RecordError::Request`] with what is not supported and what can be done instead.
    pub fn check_kind(&self, kind: OutputKind) -> Result<(), RecordError> {
        let refuse = |what: &str| Err(RecordError::request(what));
        match kind {
            OutputKind::Sequence => Ok(()),
            OutputKind::Film if self.alpha => refuse(
                "a film (.mp4) cannot have a transparent background: H.264 stores no alpha; record a folder of images or a \
                 preview (.apng)",
            ),
            _ if self.resume => refuse("only a folder of images can be resumed, not a single file"),
            _ if self.format == SequenceFormat::Exr => {
                refuse("EXR files need a folder, not the name of a film or a preview")
            }
            OutputKind::Film | OutputKind::Preview => Ok(()),
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

    /// Frames of a resumed sequence that already existed and were kept.
    pub fn kept(&self) -> u64 {
        match self {
            Self::Film(_) | Self::Preview(_) => 0,
            Self::Sequence(report) => report.kept,
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

/// The output that receives the frames of a recording. Dropping it without [`PictureSink::finish`] cancels the recording.
#[derive(Debug)]
#[expect(clippy::large_enum_variant, reason = "there is one of them at a time")]
pub enum PictureSink {
    /// A film.
    Film(FilmWriter),
    /// A preview.
    Preview(PreviewWriter),
    /// A folder of files.
    Sequence(SequenceWriter),
}

impl PictureSink {
    /// Starts the output `path` (its kind is that of [`OutputKind::of`]) and creates missing folders.
    ///
    /// # Errors
    /// As [`FilmWriter::create`], [`PreviewWriter::create`], [`SequenceWriter::create`] and [`OutputKind::of`]; also
    /// [`RecordError::Request`] for settings that the kind of output does not support ([`SinkSettings::check_kind`]).
    pub fn for_path(path: &Path, settings: SinkSettings) -> Result<Self, RecordError> {
        let kind = OutputKind::of(path)?;
        settings.check_kind(kind)?;
        let SinkSettings {
            width,
            height,
            fps,
            first_frame,
            frames,
            quality,
            format,
            alpha,
            resume,
            settings,
        } = settings;
        match kind {
            OutputKind::Film => {
                FilmWriter::create(path, FilmSettings { width, height, fps, quality }).map(Self::Film)
            }
            OutputKind::Preview => {
                PreviewWriter::create(path, PreviewSettings { width, height, fps, frames, alpha })
                    .map(Self::Preview)
            }
            OutputKind::Sequence => {
                let settings =
                    SequenceSettings { width, height, fps, first_frame, format, alpha, resume, settings };
                SequenceWriter::create(path, settings).map(Self::Sequence)
            }
        }
    }

    /// Writes the next frame: RGBA, 8-bit sRGB, rows from the top, `width × height × 4` bytes.
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

    /// Writes the next frame of a sequence of EXR files.
    ///
    /// # Errors
    /// As [`SequenceWriter::push_layers`]; [`RecordError::Request`] for any other output.
    pub fn push_layers(&mut self, layers: &FrameLayers) -> Result<(), RecordError> {
        match self {
            Self::Sequence(writer) => writer.push_layers(layers),
            Self::Film(_) | Self::Preview(_) => {
                Err(RecordError::request("only sequences of EXR files can store layers"))
            }
        }
    }

    /// Gives the output a sound, which ends with its last frame: Opus in a film, the file [`crate::SOUND_NAME`] in the folder of a sequence. A
    /// preview has none. Call it before the first frame.
    ///
    /// # Errors
    /// As [`SequenceWriter::set_sound`].
    pub fn set_sound(&mut self, sound: Box<dyn SoundSource>) -> Result<(), RecordError> {
        match self {
            Self::Film(writer) => writer.set_sound(sound),
            Self::Sequence(writer) => return writer.set_sound(sound),
            Self::Preview(_) => {}
        }
        Ok(())
    }

    /// Whether the next frame already exists and is complete; see [`SequenceWriter::next_is_kept`].
    pub fn next_is_kept(&self) -> bool {
        matches!(self, Self::Sequence(writer) if writer.next_is_kept())
    }

    /// Skips the next frame; see [`SequenceWriter::keep_next`].
    pub fn keep_next(&mut self) {
        if let Self::Sequence(writer) = self {
            writer.keep_next();
        }
    }

    /// Completes the output.
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

    /// Cancels the recording. The file of a film or a preview is removed; complete frames of a sequence stay.
    pub fn cancel(self) {}

    /// A sink that leaves nothing of a film whose recording fails: see [`FilmWriter::leaving_nothing`].
    #[must_use]
    pub fn leaving_nothing(self) -> Self {
        match self {
            Self::Film(writer) => Self::Film(writer.leaving_nothing()),
            other => other,
        }
    }

    /// Ends a recording that cannot go on. What plays of a film is left ([`FilmWriter::leave`]), and complete frames of a sequence stay.
    pub fn leave(self) {
        if let Self::Film(writer) = self {
            writer.leave();
        }
    }
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
    fn missing_folders_are_created_for_every_kind() {
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
