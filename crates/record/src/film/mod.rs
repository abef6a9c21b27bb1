//! Films: H.264 in MP4.

mod encoder;
mod worker;

use crate::partial::{self, Opener};
use crate::{FrameRate, RecordError};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, TrySendError, sync_channel};
use std::thread::JoinHandle;
use worker::Job;

/// The largest film, longer and shorter side in pixels: what the encoder takes.
pub const MAX_FILM_SIDES: (u32, u32) = (3840, 2160);

/// The smallest side, one block of the coding.
const MIN_FILM_SIDE: u32 = 16;

/// Frames that may wait for the encoder. Each is a whole picture, so few.
const QUEUE: usize = 2;

/// How finely a film is coded. Every frame has the same fineness, however many bytes that takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FilmQuality {
    /// Small files to look at once; single hairs blur.
    Draft,
    /// Good for sending around.
    Good,
    /// Single hairs stay apart.
    #[default]
    High,
    /// Hardly told from the picture, for cutting and coding again.
    Best,
}

impl FilmQuality {
    /// All, from coarse to fine.
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

    /// The quantiser of H.264, 0 to 51: the step doubles every six.
    pub(crate) fn quantiser(self) -> u8 {
        match self {
            Self::Draft => 30,
            Self::Good => 25,
            Self::High => 20,
            Self::Best => 15,
        }
    }
}

/// What a film is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmSettings {
    /// Width in pixels, even: the coding stores colours for blocks of 2×2.
    pub width: u32,
    /// Height in pixels, even.
    pub height: u32,
    /// Frames per second, 1 to 240; see [`FrameRate::from_fps`].
    pub fps: f64,
    /// How finely it is coded.
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
                "a film of {width}x{height} pixels: wanted {MIN_FILM_SIDE} to {most} on the longer side and at most {least} \
                 on the shorter; a PNG sequence takes any size"
            )));
        }
        if width % 2 != 0 || height % 2 != 0 {
            return Err(RecordError::request(format!(
                "a film of {width}x{height} pixels: width and height must be even, such as {}x{}; \
                 a PNG sequence takes any size",
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
    /// Frames in it.
    pub frames: u64,
    /// Its length in bytes.
    pub bytes: u64,
    /// Its length in seconds.
    pub duration_secs: f64,
}

/// A film in the making. [`FilmWriter::finish`] makes it whole; dropped before, it leaves nothing.
pub struct FilmWriter {
    path: PathBuf,
    settings: FilmSettings,
    jobs: Option<SyncSender<Job>>,
    /// Buffers that the worker is done with.
    spent: Receiver<Vec<u8>>,
    worker: Option<JoinHandle<Result<Option<FilmReport>, RecordError>>>,
}

impl FilmWriter {
    /// Starts a film at `path`, creating its folder where missing. A film already there stays until the new one is
    /// whole.
    ///
    /// # Errors
    /// [`RecordError::Request`] for settings that no film can have (see [`FilmSettings::check`]) or a `path` that is a
    /// folder; [`RecordError::Io`] where the file cannot be created.
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
                "{}: is a folder, a film needs a file name",
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

    /// Hands over the next frame: RGBA, 8 bits sRGB, rows from the top, `width × height × 4` bytes. Alpha is ignored.
    ///
    /// Returns as soon as the frame waits for the encoder; an error may therefore belong to an earlier frame, and
    /// names it.
    ///
    /// # Errors
    /// [`RecordError::FrameSize`] for another number of bytes (the film goes on); [`RecordError::Io`] for a full disk and
    /// the like, [`RecordError::Encoder`], and [`RecordError::Stopped`] after either: the unfinished file is gone.
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

    /// Codes what still waits, writes the film's tables, and gives it its name.
    ///
    /// # Errors
    /// As [`FilmWriter::push`]; also [`RecordError::Request`] for a film of no frames.
    pub fn finish(mut self) -> Result<FilmReport, RecordError> {
        if let Some(jobs) = &self.jobs {
            // Refused only if the worker has stopped, and then joining tells why.
            let _ = jobs.send(Job::Finish);
        }
        self.join()
    }

    /// Gives up: the same as dropping, for the reader's sake.
    pub fn cancel(self) {}

    /// Ends the worker and says how it ended.
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
        // The worker sees the channel close, and takes its unfinished file with it.
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

/// Refuses a picture that is not `width × height` pixels of RGBA.
pub(crate) fn check_frame(rgba: &[u8], width: u32, height: u32) -> Result<(), RecordError> {
    let wanted = width as usize * height as usize * 4;
    if rgba.len() == wanted {
        return Ok(());
    }
    Err(RecordError::FrameSize { found: rgba.len(), wanted, width, height })
}

/// Gives a spent buffer back, unless enough of them lie about.
pub(crate) fn give_back(done: &SyncSender<Vec<u8>>, buffer: Vec<u8>) {
    match done.try_send(buffer) {
        Ok(()) | Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => {}
    }
}

#[cfg(test)]
mod banding_tests;
#[cfg(test)]
mod tests;
