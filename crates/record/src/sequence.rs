//! Picture sequences: a folder of PNG files and a manifest.

use crate::film::{check_frame, give_back};
use crate::manifest::{MANIFEST_NAME, Manifest, ManifestFrame, VERSION, read_manifest};
use crate::partial::{Opener, PartialFile, open_file};
use crate::{FrameRate, RecordError};
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

/// Threads that code frames: PNG takes some milliseconds each, and drawing needs the other cores.
const MOST_THREADS: usize = 4;

/// The largest side in pixels, a guard against slips of the finger.
const LARGEST_SIDE: u32 = 16_384;

/// What a sequence is.
#[derive(Debug, Clone, PartialEq)]
pub struct SequenceSettings {
    /// Width in pixels, 1 to 16,384.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// Frames per second, 1 to 240; for the manifest.
    pub fps: f64,
    /// Number of the first frame, which names its file.
    pub first_frame: u64,
    /// Whether the files keep the alpha channel (not premultiplied). Without, they are smaller.
    pub alpha: bool,
    /// What drew the frames, for the manifest; anything.
    pub settings: serde_json::Value,
}

/// What was written.
#[derive(Debug, Clone, PartialEq)]
pub struct SequenceReport {
    /// The folder.
    pub folder: PathBuf,
    /// Frames in it.
    pub frames: u64,
    /// Length of all frames together, in bytes.
    pub bytes: u64,
}

/// The file name of a frame: `frame_000042.png`.
pub fn frame_name(number: u64) -> String {
    format!("frame_{number:06}.png")
}

/// A sequence in the making.
///
/// Each frame gets its name when its file is whole, so frames can be used while later ones are drawn. The manifest comes
/// last. A cancel (dropping without [`SequenceWriter::finish`]) or an error keeps the frames that are whole, and
/// the manifest says `"complete": false`.
pub struct SequenceWriter {
    folder: PathBuf,
    settings: SequenceSettings,
    pushed: u64,
    jobs: Option<SyncSender<(u64, Vec<u8>)>>,
    spent: Receiver<Vec<u8>>,
    threads: Vec<JoinHandle<()>>,
    shared: Arc<Mutex<Progress>>,
    /// Files of the sequence that lay in the folder before.
    old_files: Vec<String>,
    ended: bool,
}

/// What the threads have done so far.
#[derive(Default)]
struct Progress {
    frames: BTreeMap<u64, ManifestFrame>,
    error: Option<RecordError>,
}

impl SequenceWriter {
    /// Starts a sequence in `folder`, which is created where missing.
    ///
    /// Frames of the same numbers are replaced as the new ones come, and the manifest of a sequence already there goes
    /// at once. The frames that it lists and the new sequence lacks go at the end, so that the folder holds one sequence.
    ///
    /// # Errors
    /// [`RecordError::Request`] for a size, a rate or a `folder` that cannot be (it is a file); [`RecordError::Io`] where the
    /// folder cannot be written.
    pub fn create(folder: &Path, settings: SequenceSettings) -> Result<Self, RecordError> {
        Self::create_on(folder, settings, &(Arc::new(open_file) as Arc<Opener>))
    }

    pub(crate) fn create_on(
        folder: &Path,
        settings: SequenceSettings,
        opener: &Arc<Opener>,
    ) -> Result<Self, RecordError> {
        let SequenceSettings { width, height, fps, .. } = settings;
        if width.min(height) == 0 || width.max(height) > LARGEST_SIDE {
            return Err(RecordError::request(format!(
                "a sequence of {width}x{height} pixels: wanted sides of 1 to {LARGEST_SIDE}"
            )));
        }
        FrameRate::from_fps(fps)?;
        if folder.is_file() {
            return Err(RecordError::request(format!(
                "{}: is a file, a sequence needs a folder",
                folder.display()
            )));
        }
        fs::create_dir_all(folder).map_err(|error| RecordError::io(folder, "create the folder", error))?;
        let manifest_path = folder.join(MANIFEST_NAME);
        let mut old_files = Vec::new();
        if let Ok(old) = read_manifest(folder) {
            old_files =
                old.frames.into_iter().filter(|f| f.file == frame_name(f.number)).map(|f| f.file).collect();
            fs::remove_file(&manifest_path)
                .map_err(|error| RecordError::io(&manifest_path, "remove the old manifest", error))?;
        }

        let count = std::thread::available_parallelism().map_or(1, usize::from).min(MOST_THREADS);
        let (jobs, todo) = sync_channel(count);
        let (done, spent) = sync_channel(2 * count + 2);
        let todo = Arc::new(Mutex::new(todo));
        let shared = Arc::new(Mutex::new(Progress::default()));
        let mut writer = Self {
            folder: folder.to_owned(),
            settings,
            pushed: 0,
            jobs: Some(jobs),
            spent,
            threads: Vec::new(),
            shared,
            old_files,
            ended: false,
        };
        for index in 0..count {
            let worker = Worker {
                folder: folder.to_owned(),
                width,
                height,
                alpha: writer.settings.alpha,
                opener: opener.clone(),
                shared: writer.shared.clone(),
            };
            let (todo, done) = (todo.clone(), done.clone());
            let thread = std::thread::Builder::new()
                .name(format!("lovelock-frames-{index}"))
                .spawn(move || worker.run(&todo, &done))
                .map_err(|error| RecordError::io(folder, "start a thread for its frames", error))?;
            writer.threads.push(thread);
        }
        Ok(writer)
    }

    /// Hands over the next frame: RGBA, 8 bits sRGB, rows from the top, `width × height × 4` bytes.
    ///
    /// Returns as soon as the frame waits to be coded; an error may therefore belong to an earlier frame, and names it.
    ///
    /// # Errors
    /// [`RecordError::FrameSize`] for another number of bytes (the sequence goes on); [`RecordError::Io`] for a full disk and
    /// the like, and [`RecordError::Stopped`] after that.
    pub fn push(&mut self, rgba: &[u8]) -> Result<(), RecordError> {
        check_frame(rgba, self.settings.width, self.settings.height)?;
        let Some(jobs) = &self.jobs else {
            return Err(RecordError::Stopped { path: self.folder.clone() });
        };
        let number = self.settings.first_frame + self.pushed;
        let mut buffer = self.spent.try_recv().unwrap_or_default();
        buffer.clear();
        buffer.extend_from_slice(rgba);
        if jobs.send((number, buffer)).is_ok() && lock(&self.shared).error.is_none() {
            self.pushed += 1;
            return Ok(());
        }
        self.end(false).map(drop)
    }

    /// Codes what still waits, writes the manifest, and removes frames of an older sequence that this one lacks.
    ///
    /// # Errors
    /// As [`SequenceWriter::push`]; also [`RecordError::Request`] for a sequence of no frames.
    pub fn finish(mut self) -> Result<SequenceReport, RecordError> {
        if self.pushed == 0 && self.jobs.is_some() {
            let what = format!("{}: a sequence needs one frame or more", self.folder.display());
            return Err(RecordError::request(what));
        }
        self.end(true)
    }

    /// Gives up: the same as dropping, for the reader's sake.
    pub fn cancel(self) {}

    /// Ends the threads and writes the manifest.
    fn end(&mut self, finished: bool) -> Result<SequenceReport, RecordError> {
        if std::mem::replace(&mut self.ended, true) {
            return Err(RecordError::Stopped { path: self.folder.clone() });
        }
        self.jobs = None;
        let panicked = self.threads.drain(..).map(JoinHandle::join).filter(Result::is_err).count() > 0;
        let Progress { frames, error } = std::mem::take(&mut *lock(&self.shared));
        let whole = finished && error.is_none() && !panicked && frames.len() as u64 == self.pushed;
        let manifest = Manifest {
            format: "lovelock-sequence".into(),
            version: VERSION,
            complete: whole,
            width: self.settings.width,
            height: self.settings.height,
            fps: self.settings.fps,
            first_frame: self.settings.first_frame,
            frames: frames.into_values().collect(),
            settings: self.settings.settings.clone(),
        };
        // A folder without a single frame needs no manifest, and after an error there may be no room for one: the error
        // that came first is the one to tell.
        let written = if manifest.frames.is_empty() { Ok(()) } else { self.write_manifest(&manifest) };
        match error {
            Some(error) => return Err(error),
            None if panicked => {
                return Err(RecordError::Stopped { path: self.folder.clone() });
            }
            None => written?,
        }
        if whole {
            self.remove_old_frames(&manifest);
        }
        let bytes = manifest.frames.iter().map(|frame| frame.bytes).sum();
        Ok(SequenceReport { folder: self.folder.clone(), frames: manifest.frames.len() as u64, bytes })
    }

    fn write_manifest(&self, manifest: &Manifest) -> Result<(), RecordError> {
        let path = self.folder.join(MANIFEST_NAME);
        let write = || {
            let mut file = PartialFile::create(&path, &open_file)?;
            serde_json::to_writer_pretty(&mut file, manifest)?;
            file.write_all(b"\n")?;
            file.commit(true)
        };
        write().map_err(|error| RecordError::io(&path, "write the manifest", error))
    }

    fn remove_old_frames(&self, manifest: &Manifest) {
        for file in &self.old_files {
            if manifest.frames.iter().all(|frame| frame.file != *file) {
                // One that is gone already, or cannot go, does no harm: the manifest is what counts.
                let _ = fs::remove_file(self.folder.join(file));
            }
        }
    }
}

impl Drop for SequenceWriter {
    fn drop(&mut self) {
        let _ = self.end(false);
    }
}

impl std::fmt::Debug for SequenceWriter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("SequenceWriter").field("folder", &self.folder).finish_non_exhaustive()
    }
}

/// The progress, also after a thread has died holding it: every change to it is a single step.
fn lock(shared: &Mutex<Progress>) -> std::sync::MutexGuard<'_, Progress> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// One thread that codes frames.
struct Worker {
    folder: PathBuf,
    width: u32,
    height: u32,
    alpha: bool,
    opener: Arc<Opener>,
    shared: Arc<Mutex<Progress>>,
}

impl Worker {
    fn run(&self, todo: &Mutex<Receiver<(u64, Vec<u8>)>>, done: &SyncSender<Vec<u8>>) {
        let (mut opaque, mut file) = (Vec::new(), Vec::new());
        loop {
            let job = todo.lock().unwrap_or_else(PoisonError::into_inner).recv();
            let Ok((number, rgba)) = job else { return };
            if lock(&self.shared).error.is_none() {
                match self.write(number, &rgba, &mut opaque, &mut file) {
                    Ok(frame) => drop(lock(&self.shared).frames.insert(number, frame)),
                    Err(error) => drop(lock(&self.shared).error.get_or_insert(error)),
                }
            }
            give_back(done, rgba);
        }
    }

    fn write(
        &self,
        number: u64,
        rgba: &[u8],
        opaque: &mut Vec<u8>,
        file: &mut Vec<u8>,
    ) -> Result<ManifestFrame, RecordError> {
        let name = frame_name(number);
        let path = self.folder.join(&name);
        let failed = |error| RecordError::io(&path, format!("write frame {number}"), error);
        let (pixels, kind) = if self.alpha {
            (rgba, ExtendedColorType::Rgba8)
        } else {
            opaque.clear();
            opaque.extend(rgba.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]));
            (&opaque[..], ExtendedColorType::Rgb8)
        };
        file.clear();
        PngEncoder::new_with_quality(&mut *file, CompressionType::Fast, FilterType::Adaptive)
            .write_image(pixels, self.width, self.height, kind)
            .map_err(|error| failed(std::io::Error::other(error)))?;
        let mut partial = PartialFile::create(&path, &*self.opener).map_err(failed)?;
        partial.write_all(file).map_err(failed)?;
        partial.commit(false).map_err(failed)?;
        let crc32 = format!("{:08x}", crc32fast::hash(file));
        Ok(ManifestFrame { number, file: name, bytes: file.len() as u64, crc32 })
    }
}

#[cfg(test)]
mod tests;
