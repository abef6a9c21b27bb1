//! Films: H.264 in MP4.

mod encoder;
pub(crate) mod tables;
mod worker;

use crate::partial::{self, Opener};
use crate::sound::SoundSource;
use crate::{FrameRate, RecordError};
use lovelock_base::settings::Choices;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;
use worker::Job;

/// The largest longer and shorter side of a film in pixels, as the encoder allows.
pub const MAX_FILM_SIDES: (u32, u32) = (3840, 2160);

/// The smallest side in pixels, one macroblock of H.264.
const MIN_FILM_SIDE: u32 = 16;

/// Frames that may wait for the encoder. Few, because each is a whole image.
const QUEUE: usize = 2;

/// Quality of a film. All frames have the same quality, whatever their size in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FilmQuality {
    /// Small files for a quick look; single hairs blur.
    Draft,
    /// Good enough to share.
    Good,
    /// Single hairs stay distinct.
    #[default]
    High,
    /// Hardly distinguishable from the rendered images, for editing and encoding again.
    Best,
}

impl Choices for FilmQuality {
    const ALL: &'static [Self] = &Self::ALL;

    fn names(self) -> (&'static str, &'static str) {
        (self.id(), self.label())
    }
}

impl FilmQuality {
    /// All qualities, from low to high.
    pub const ALL: [Self; 4] = [Self::Draft, Self::Good, Self::High, Self::Best];

    /// Stable name for files and the command line.
    pub fn id(self) -> &'static str {
        match self {
            Self::Draft => "draft",
            Self::Good => "good",
            Self::High => "high",
            Self::Best => "best",
        }
    }

    /// Name for people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Draft => "Draft",
            Self::Good => "Good",
            Self::High => "High",
            Self::Best => "Best",
        }
    }

    /// Bits per second and channel of the sound.
    pub(crate) fn sound_bits(self) -> i32 {
        match self {
            Self::Draft => 48_000,
            Self::Good => 64_000,
            Self::High => 96_000,
            Self::Best => 128_000,
        }
    }

    /// The quantiser of H.264, 0 to 51. Its step doubles every six.
    pub(crate) fn quantiser(self) -> u8 {
        match self {
            Self::Draft => 30,
            Self::Good => 25,
            Self::High => 20,
            Self::Best => 15,
        }
    }
}

/// Settings of a film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmSettings {
    /// Width in pixels. It must be even, because H.264 stores colours for blocks of 2×2 pixels.
    pub width: u32,
    /// Height in pixels. It must be even.
    pub height: u32,
    /// Frames per second, 1 to 240; see [`FrameRate::from_fps`].
    pub fps: f64,
    /// Quality of the encoding.
    pub quality: FilmQuality,
}

impl FilmSettings {
    /// Checks the settings without starting anything.
    ///
    /// # Errors
    /// [`RecordError::Request`] for an odd, too small or too large size, and for a rate outside 1 to 240.
    pub fn check(&self) -> Result<FrameRate, RecordError> {
        let Self { width, height, .. } = *self;
        let (longer, shorter) = (width.max(height), width.min(height));
        if shorter < MIN_FILM_SIDE || longer > MAX_FILM_SIDES.0 || shorter > MAX_FILM_SIDES.1 {
            let (most, least) = MAX_FILM_SIDES;
            return Err(RecordError::request(format!(
                "a film of {width}x{height} pixels: must be {MIN_FILM_SIDE} to {most} on the longer side and at most {least} \
                 on the shorter; a PNG sequence can have any size"
            )));
        }
        if width % 2 != 0 || height % 2 != 0 {
            return Err(RecordError::request(format!(
                "a film of {width}x{height} pixels: width and height must be even, such as {}x{}; \
                 a PNG sequence can have any size",
                width & !1,
                height & !1
            )));
        }
        FrameRate::from_fps(self.fps)
    }
}

/// What was written.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmReport {
    /// The film.
    pub path: PathBuf,
    /// Number of frames.
    pub frames: u64,
    /// Length of the file in bytes.
    pub bytes: u64,
    /// Duration in seconds.
    pub duration_secs: f64,
}

/// A film that is being written. [`FilmWriter::finish`] completes it; if it is dropped before, its file is removed. After an error, what plays
/// is left as by a crash: see [`crate::keep_unfinished`].
pub struct FilmWriter {
    path: PathBuf,
    settings: FilmSettings,
    jobs: Option<SyncSender<Job>>,
    /// Buffers that the worker has returned.
    spent: Receiver<Vec<u8>>,
    worker: Option<JoinHandle<Result<Option<FilmReport>, RecordError>>>,
}

impl FilmWriter {
    /// Starts a film at `path` and creates its folder if it is missing. An existing film stays until the new one is
    /// complete.
    ///
    /// # Errors
    /// [`RecordError::Request`] for invalid settings (see [`FilmSettings::check`]) or a `path` that is a folder;
    /// [`RecordError::Io`] if the file cannot be created.
    pub fn create(path: &Path, settings: FilmSettings) -> Result<Self, RecordError> {
        Self::create_on(path, settings, &partial::open_file)
    }

    pub(crate) fn create_on(
        path: &Path,
        settings: FilmSettings,
        opener: &Opener,
    ) -> Result<Self, RecordError> {
        let rate = settings.check()?;
        if path.is_dir() || path.file_name().is_none() {
            return Err(RecordError::request(format!(
                "{}: is a folder; a film needs a file name",
                path.display()
            )));
        }
        let create = |error| RecordError::io(path, "create the film", error);
        partial::create_parent(path).map_err(create)?;
        let film = worker::Film::new(path, settings, rate, opener).map_err(create)?;
        let (jobs, todo) = sync_channel(QUEUE);
        let (done, spent) = sync_channel(QUEUE + 2);
        let worker = std::thread::Builder::new()
            .name("lovelock-film".into())
            .spawn(move || film.run(&todo, &done))
            .map_err(|error| RecordError::io(path, "start the encoder's thread", error))?;
        Ok(Self { path: path.to_owned(), settings, jobs: Some(jobs), spent, worker: Some(worker) })
    }

    /// Gives the film a sound, as Opus. It ends with the last frame. Call it before the first [`FilmWriter::push`].
    pub fn set_sound(&mut self, sound: Box<dyn SoundSource>) {
        if let Some(jobs) = &self.jobs {
            // This fails only if the worker has stopped; the next `push` then returns its error.
            let _ = jobs.send(Job::Sound(sound));
        }
    }

    /// Writes the next frame: RGBA, 8-bit sRGB, rows from the top, `width × height × 4` bytes. Alpha is ignored.
    ///
    /// Returns as soon as the frame is in the encoder's queue. An error may therefore belong to an earlier frame, which it
    /// names.
    ///
    /// # Errors
    /// [`RecordError::FrameSize`] for a wrong number of bytes, after which recording can continue. [`RecordError::Io`] for
    /// errors such as a full disk, [`RecordError::Encoder`], and [`RecordError::Stopped`] after either.
    pub fn push(&mut self, rgba: &[u8]) -> Result<(), RecordError> {
        check_frame(rgba, self.settings.width, self.settings.height)?;
        let Some(jobs) = &self.jobs else {
            return Err(RecordError::Stopped { path: self.path.clone() });
        };
        let mut buffer = self.spent.try_recv().unwrap_or_default();
        buffer.clear();
        buffer.extend_from_slice(rgba);
        if jobs.send(Job::Frame(buffer)).is_ok() { Ok(()) } else { self.join().map(drop) }
    }

    /// Encodes the frames in the queue, writes the film's tables, and renames the file to its final name.
    ///
    /// # Errors
    /// As [`FilmWriter::push`]; also [`RecordError::Request`] for a film of no frames.
    pub fn finish(mut self) -> Result<FilmReport, RecordError> {
        if let Some(jobs) = &self.jobs {
            // This fails only if the worker has stopped; `join` then returns its error.
            let _ = jobs.send(Job::Finish);
        }
        self.join()
    }

    /// A writer that leaves nothing if the recording fails, for films that nobody would be asked about.
    #[must_use]
    pub fn leaving_nothing(self) -> Self {
        if let Some(jobs) = &self.jobs {
            // This fails only if the worker has stopped; the next `push` then returns its error.
            let _ = jobs.send(Job::LeaveNothing);
        }
        self
    }

    /// Cancels the recording. This is the same as dropping the writer.
    pub fn cancel(self) {}

    /// Ends a recording that cannot go on, for example because nothing draws its frames any more. What plays is left, as after an error.
    pub fn leave(mut self) {
        self.send_leave();
        let _ = self.join();
    }

    fn send_leave(&self) {
        if let Some(jobs) = &self.jobs {
            // This fails only if the worker has stopped.
            let _ = jobs.send(Job::Leave);
        }
    }

    /// Ends the worker and returns its result.
    fn join(&mut self) -> Result<FilmReport, RecordError> {
        self.jobs = None;
        let ended = self.worker.take().map(JoinHandle::join);
        match ended {
            Some(Ok(Ok(Some(report)))) => Ok(report),
            Some(Ok(Err(error))) => Err(error),
            _ => Err(RecordError::Stopped { path: self.path.clone() }),
        }
    }
}

impl Drop for FilmWriter {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.send_leave();
        }
        // Otherwise the worker sees the channel close and removes its unfinished file.
        let _ = self.join();
    }
}

impl std::fmt::Debug for FilmWriter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("FilmWriter")
            .field("path", &self.path)
            .field("settings", &self.settings)
            .finish_non_exhaustive()
    }
}

/// Checks that an image has `width × height` pixels of RGBA.
pub(crate) fn check_frame(rgba: &[u8], width: u32, height: u32) -> Result<(), RecordError> {
    let wanted = width as usize * height as usize * 4;
    if rgba.len() == wanted {
        return Ok(());
    }
    Err(RecordError::FrameSize { found: rgba.len(), wanted, width, height })
}

/// Returns a used buffer to the writer, unless enough buffers are waiting there already.
pub(crate) fn give_back(done: &SyncSender<Vec<u8>>, buffer: Vec<u8>) {
    match done.try_send(buffer) {
        Ok(()) | Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => {}
    }
}

#[cfg(test)]
mod banding_tests;
#[cfg(test)]
mod tests;
