//! Animated previews (APNG) for web pages and messages. They are lossless.

use std::path::{Path, PathBuf};

use png::{BitDepth, ColorType, Compression, Encoder, Writer};

use crate::film::check_frame;
use crate::partial::{PartialFile, create_parent, open_file};
use crate::{FrameRate, RecordError};

/// The largest side in pixels. A browser holds all frames of a preview in memory.
pub const MAX_PREVIEW_SIDE: u32 = 2048;

/// The most frames: a minute and a half at 24 frames per second.
pub const MAX_PREVIEW_FRAMES: u64 = 2160;

/// Settings of a preview.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PreviewSettings {
    /// Width in pixels, 1 to [`MAX_PREVIEW_SIDE`].
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Frames per second, 1 to 240.
    pub fps: f64,
    /// Number of frames, 1 to [`MAX_PREVIEW_FRAMES`]. The file stores it before the first frame.
    pub frames: u64,
    /// Whether the alpha channel is kept (not premultiplied).
    pub alpha: bool,
}

impl PreviewSettings {
    /// Checks the settings without starting anything.
    ///
    /// # Errors
    /// [`RecordError::Request`] with what was found and what is valid.
    pub fn check(&self) -> Result<FrameRate, RecordError> {
        let Self { width, height, fps, frames, .. } = *self;
        if width.min(height) == 0 || width.max(height) > MAX_PREVIEW_SIDE {
            return Err(RecordError::request(format!(
                "a preview of {width}x{height} pixels: each side must be 1 to {MAX_PREVIEW_SIDE}"
            )));
        }
        if frames == 0 || frames > MAX_PREVIEW_FRAMES {
            return Err(RecordError::request(format!(
                "a preview of {frames} frames: must have 1 to {MAX_PREVIEW_FRAMES}; a film (.mp4) can have any number"
            )));
        }
        FrameRate::from_fps(fps)
    }
}

/// What was written.
#[derive(Debug, Clone, PartialEq)]
pub struct PreviewReport {
    /// The file.
    pub path: PathBuf,
    /// Frames in it.
    pub frames: u64,
    /// Its length in bytes.
    pub bytes: u64,
}

/// A preview that is being written, as `NAME.partial`. If it is dropped before [`PreviewWriter::finish`], the file is removed.
pub struct PreviewWriter {
    path: PathBuf,
    settings: PreviewSettings,
    writer: Option<Writer<SharedFile>>,
    file: SharedFile,
    pushed: u64,
    opaque: Vec<u8>,
}

/// The file, shared by the encoder, which writes to it, and the [`PreviewWriter`], which commits it.
#[derive(Clone)]
struct SharedFile(std::sync::Arc<std::sync::Mutex<Option<PartialFile>>>);

impl std::fmt::Debug for PreviewWriter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PreviewWriter")
            .field("path", &self.path)
            .field("pushed", &self.pushed)
            .finish_non_exhaustive()
    }
}

impl SharedFile {
    fn take(&self) -> Option<PartialFile> {
        self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner).take()
    }

    fn with<T>(&self, act: impl FnOnce(&mut PartialFile) -> std::io::Result<T>) -> std::io::Result<T> {
        let mut file = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        act(file.as_mut().ok_or_else(|| std::io::Error::other("the file is closed"))?)
    }
}

impl std::io::Write for SharedFile {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.with(|file| file.write(bytes))
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.with(std::io::Write::flush)
    }
}

impl PreviewWriter {
    /// Starts a preview at `path` and creates its folder if it is missing. An existing file stays until the new one is
    /// complete.
    ///
    /// # Errors
    /// As [`PreviewSettings::check`]; [`RecordError::Io`] if the file cannot be created.
    pub fn create(path: &Path, settings: PreviewSettings) -> Result<Self, RecordError> {
        let rate = settings.check()?;
        let failed = |error| RecordError::io(path, "create the preview", error);
        create_parent(path).map_err(failed)?;
        let file = PartialFile::create(path, &open_file).map_err(failed)?;
        let file = SharedFile(std::sync::Arc::new(std::sync::Mutex::new(Some(file))));
        let coded = |error: png::EncodingError| failed(std::io::Error::other(error));
        let mut encoder = Encoder::new(file.clone(), settings.width, settings.height);
        encoder.set_color(if settings.alpha { ColorType::Rgba } else { ColorType::Rgb });
        encoder.set_depth(BitDepth::Eight);
        encoder.set_compression(Compression::Balanced);
        // 0 plays: it loops forever.
        encoder.set_animated(settings.frames as u32, 0).map_err(coded)?;
        let (num, den) = delay(rate);
        encoder.set_frame_delay(num, den).map_err(coded)?;
        crate::still::mark_png(&mut encoder).map_err(coded)?;
        let writer = encoder.write_header().map_err(coded)?;
        Ok(Self {
            path: path.to_owned(),
            settings,
            writer: Some(writer),
            file,
            pushed: 0,
            opaque: Vec::new(),
        })
    }

    /// Writes the next frame: RGBA, 8-bit sRGB, rows from the top, `width × height × 4` bytes.
    ///
    /// # Errors
    /// [`RecordError::FrameSize`] for a wrong number of bytes; [`RecordError::Request`] for more frames than the settings say;
    /// [`RecordError::Io`] for errors such as a full disk, and [`RecordError::Stopped`] after that.
    pub fn push(&mut self, rgba: &[u8]) -> Result<(), RecordError> {
        check_frame(rgba, self.settings.width, self.settings.height)?;
        if self.pushed == self.settings.frames {
            return Err(RecordError::request(format!(
                "{}: more frames than the {} of its settings",
                self.path.display(),
                self.settings.frames
            )));
        }
        let Some(writer) = &mut self.writer else {
            return Err(RecordError::Stopped { path: self.path.clone() });
        };
        let pixels = if self.settings.alpha {
            rgba
        } else {
            self.opaque.clear();
            self.opaque.extend(rgba.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]));
            &self.opaque
        };
        if let Err(error) = writer.write_image_data(pixels) {
            self.writer = None;
            drop(self.file.take());
            let what = format!("write frame {}", self.pushed);
            return Err(RecordError::io(&self.path, &what, std::io::Error::other(error)));
        }
        self.pushed += 1;
        Ok(())
    }

    /// Completes the preview and renames it to its final name.
    ///
    /// # Errors
    /// As [`PreviewWriter::push`]; also [`RecordError::Request`] for fewer frames than the settings say.
    pub fn finish(mut self) -> Result<PreviewReport, RecordError> {
        let Some(writer) = self.writer.take() else {
            return Err(RecordError::Stopped { path: self.path.clone() });
        };
        if self.pushed < self.settings.frames {
            return Err(RecordError::request(format!(
                "{}: {} frames; must be the {} of its settings",
                self.path.display(),
                self.pushed,
                self.settings.frames
            )));
        }
        let failed = |error| RecordError::io(&self.path, "finish the preview", error);
        writer.finish().map_err(|error| failed(std::io::Error::other(error)))?;
        let file = self.file.take().ok_or_else(|| RecordError::Stopped { path: self.path.clone() })?;
        file.commit(true).map_err(failed)?;
        let bytes = std::fs::metadata(&self.path).map_or(0, |data| data.len());
        Ok(PreviewReport { path: self.path.clone(), frames: self.pushed, bytes })
    }
}

/// How long a frame is shown, in seconds, as numerator and denominator.
fn delay(rate: FrameRate) -> (u16, u16) {
    match (u16::try_from(rate.den), u16::try_from(rate.num)) {
        (Ok(den), Ok(num)) => (den, num),
        // Rates such as 24000/1001 do not fit into 16 bits: round to 1/65,000 s.
        _ => ((65_000.0 / rate.as_f64()).round().clamp(1.0, 65_000.0) as u16, 65_000),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(frames: u64) -> PreviewSettings {
        PreviewSettings { width: 5, height: 3, fps: 24.0, frames, alpha: false }
    }

    fn frame(number: u8) -> Vec<u8> {
        (0..5 * 3 * 4).map(|i| if i % 4 == 3 { 255 } else { i as u8 * 3 + number * 7 }).collect()
    }

    #[test]
    fn every_frame_and_its_time_come_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/preview.apng");
        let mut writer = PreviewWriter::create(&path, settings(4)).unwrap();
        for number in 0..4 {
            assert!(!path.exists(), "an unfinished file never has the final name");
            writer.push(&frame(number)).unwrap();
        }
        let report = writer.finish().unwrap();
        assert_eq!((report.frames, report.bytes), (4, std::fs::metadata(&path).unwrap().len()));
        let file = std::io::BufReader::new(std::fs::File::open(&path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let animation = reader.info().animation_control().unwrap();
        assert_eq!((animation.num_frames, animation.num_plays), (4, 0));
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        for number in 0..4 {
            reader.next_frame(&mut pixels).unwrap();
            let shown = reader.info().frame_control().unwrap();
            assert_eq!((shown.delay_num, shown.delay_den), (1, 24));
            let wanted: Vec<u8> = frame(number).chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
            assert_eq!(pixels, wanted, "frame {number}");
        }
    }

    #[test]
    fn unfinished_previews_leave_nothing_and_a_wrong_number_of_frames_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("preview.apng");
        let mut writer = PreviewWriter::create(&path, settings(2)).unwrap();
        writer.push(&frame(0)).unwrap();
        assert!(matches!(writer.push(&[0; 3]), Err(RecordError::FrameSize { .. })));
        let error = writer.finish().unwrap_err();
        assert!(error.is_request() && error.to_string().contains("1 frames; must be the 2"), "{error}");
        let mut writer = PreviewWriter::create(&path, settings(1)).unwrap();
        writer.push(&frame(0)).unwrap();
        assert!(writer.push(&frame(1)).unwrap_err().is_request());
        drop(writer);
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn invalid_sizes_and_lengths_are_refused() {
        for wrong in [
            PreviewSettings { width: 0, ..settings(1) },
            PreviewSettings { height: MAX_PREVIEW_SIDE + 1, ..settings(1) },
            PreviewSettings { fps: 0.0, ..settings(1) },
            settings(0),
            settings(MAX_PREVIEW_FRAMES + 1),
        ] {
            assert!(wrong.check().is_err_and(|error| error.is_request()), "{wrong:?}");
        }
        assert_eq!(delay(FrameRate { num: 24_000, den: 1001 }), (1001, 24_000));
        assert_eq!(delay(FrameRate { num: 120_000, den: 1001 }), (542, 65_000));
    }
}
