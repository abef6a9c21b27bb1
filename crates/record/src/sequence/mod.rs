//! Image sequences: a folder of PNG or EXR files with a manifest.

mod exr;
mod journal;
mod left;
mod settings;
mod sound_file;
mod worker;

pub use self::exr::FrameLayers;
pub(crate) use left::{discard_unfinished, is_left, journal_path, keep_unfinished};
pub use settings::{SequenceFormat, SequenceReport, SequenceSettings, frame_name};
pub use sound_file::SOUND_NAME;
pub(crate) use sound_file::remove_own;

use crate::film::check_frame;
use crate::manifest::{MANIFEST_NAME, Manifest, ManifestFrame, ManifestSound, VERSION, read_manifest};
use crate::partial::{Opener, open_file};
use crate::sound::{SoundSource, samples_of};
use crate::{FrameRate, RecordError};
use journal::{Journal, Recorded};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use worker::{Job, Pixels, Worker};

/// Most threads that encode frames. A PNG takes some milliseconds, and rendering needs the other cores.
const MAX_THREADS: usize = 4;

/// The largest side in pixels, to catch typing errors.
const LARGEST_SIDE: u32 = 16_384;

/// Number of pixels of an EXR file above which only two threads encode, because each needs 14 bytes per pixel and more.
const LARGE: u64 = 4_000_000;

/// A sequence that is being written.
///
/// Each frame gets its final name when its file is complete, so frames can be used while later ones are rendered. The manifest
/// is written last. Until then `manifest.partial` lists the frames and keeps a second recording out of the folder. After a
/// cancel (dropping without [`SequenceWriter::finish`]) or an error, complete frames are kept, and the manifest has
/// `"complete": false`; without any frame, the manifest of the sequence before is restored.
pub struct SequenceWriter {
    folder: PathBuf,
    settings: SequenceSettings,
    rate: FrameRate,
    /// Frames written or kept so far.
    at: u64,
    /// Complete frames of an earlier recording.
    kept: BTreeMap<u64, ManifestFrame>,
    jobs: Option<SyncSender<Job>>,
    spent: Receiver<Vec<u8>>,
    threads: Vec<JoinHandle<()>>,
    shared: Arc<Mutex<Progress>>,
    /// Files of the sequence that was in the folder before.
    old_files: Vec<String>,
    sound: Option<Box<dyn SoundSource>>,
    /// The sound that this recording has written.
    new_sound: Option<ManifestSound>,
    /// The sound of the sequence that was in the folder before.
    old_sound: Option<ManifestSound>,
    /// The whole manifest of that sequence.
    old: Option<Manifest>,
    ended: bool,
}

/// What the threads have written so far.
#[derive(Default)]
struct Progress {
    frames: BTreeMap<u64, ManifestFrame>,
    error: Option<RecordError>,
    /// Present until the end.
    journal: Option<Journal>,
}

impl SequenceWriter {
    /// Starts a sequence in `folder`, which is created if it is missing.
    ///
    /// The manifest of an existing sequence is removed at once, and its frames are replaced by new frames with the same
    /// numbers. Frames of the old sequence that the new one lacks are removed at the end, so that the folder contains one
    /// sequence. With [`SequenceSettings::resume`] complete frames are kept instead: see [`SequenceWriter::next_is_kept`].
    ///
    /// # Errors
    /// [`RecordError::Request`] for an invalid size or rate, for a `folder` that is a file, and for an existing sequence with
    /// other settings if it should be resumed; [`RecordError::Io`] if the folder cannot be written or another recording
    /// writes to it.
    pub fn create(folder: &Path, settings: SequenceSettings) -> Result<Self, RecordError> {
        Self::create_on(folder, settings, &(Arc::new(open_file) as Arc<Opener>))
    }

    pub(crate) fn create_on(
        folder: &Path,
        settings: SequenceSettings,
        opener: &Arc<Opener>,
    ) -> Result<Self, RecordError> {
        let SequenceSettings { width, height, fps, format, .. } = settings;
        if width.min(height) == 0 || width.max(height) > LARGEST_SIDE {
            return Err(RecordError::request(format!(
                "a sequence of {width}x{height} pixels: each side must be 1 to {LARGEST_SIDE}"
            )));
        }
        let rate = FrameRate::from_fps(fps)?;
        if folder.is_file() {
            return Err(RecordError::request(format!(
                "{}: is a file; a sequence needs a folder",
                folder.display()
            )));
        }
        fs::create_dir_all(folder).map_err(|error| RecordError::io(folder, "create the folder", error))?;
        let mut writer = Self {
            folder: folder.to_owned(),
            settings,
            rate,
            at: 0,
            kept: BTreeMap::new(),
            jobs: None,
            spent: sync_channel(0).1,
            threads: Vec::new(),
            shared: Arc::new(Mutex::new(Progress::default())),
            old_files: Vec::new(),
            sound: None,
            new_sound: None,
            old_sound: None,
            old: None,
            ended: true,
        };
        let journal = writer.begin()?;
        lock(&writer.shared).journal = Some(journal);
        (writer.ended, lock(&writer.shared).frames) = (false, writer.kept.clone());
        writer.start_threads(format, opener)?;
        Ok(writer)
    }

    /// Locks the folder and determines which of its frames are kept.
    fn begin(&mut self) -> Result<Journal, RecordError> {
        let folder = self.folder.clone();
        let mut journal = Journal::claim(&folder)?;
        let there = journal.earlier(&folder);
        let before: BTreeSet<u64> =
            there.iter().flat_map(Recorded::listed).map(|frame| frame.number).collect();
        let there = there.map(|there| there.manifest);
        if let Some(there) = &there {
            self.old_sound.clone_from(&there.sound);
            self.old = Some(there.clone());
        }
        let head = self.manifest(false, Vec::new());
        if let Some(there) = there {
            let listed = there.frames.iter();
            // A file whose name is not that of a frame is never removed or kept as a frame.
            let ours = |f: &&ManifestFrame| {
                SequenceFormat::ALL.iter().any(|&format| f.file == frame_name(f.number, format))
            };
            self.old_files = listed.filter(ours).map(|f| f.file.clone()).collect();
            if self.settings.resume {
                match self.kept_of(there, &head) {
                    Ok(kept) => self.kept = kept,
                    Err(error) => {
                        journal.release();
                        return Err(error);
                    }
                }
            }
        }
        let (listed, kept): (BTreeMap<_, _>, BTreeMap<_, _>) =
            self.kept.clone().into_iter().partition(|(number, _)| before.contains(number));
        let head = Manifest { frames: listed.into_values().collect(), ..head };
        if let Err(error) = journal.begin(&head, &kept) {
            journal.release();
            return Err(RecordError::io(&folder, "start a sequence in the folder", error));
        }
        let manifest_path = folder.join(MANIFEST_NAME);
        if read_manifest(&folder).is_ok() {
            fs::remove_file(&manifest_path)
                .map_err(|error| RecordError::io(&manifest_path, "remove the old manifest", error))?;
        }
        Ok(journal)
    }

    /// The frames of an existing sequence that are kept when it is resumed.
    fn kept_of(
        &self,
        there: Manifest,
        wanted: &Manifest,
    ) -> Result<BTreeMap<u64, ManifestFrame>, RecordError> {
        let refuse = |what: String| {
            Err(RecordError::request(format!(
                "{}: cannot resume the sequence in this folder: {what}; record without resuming to replace it, or to \
                 another folder",
                self.folder.display()
            )))
        };
        let differences = journal::differences(&there, wanted);
        if !differences.is_empty() {
            return refuse(differences.join("; "));
        }
        let format = self.settings.format;
        let own = |frame: &ManifestFrame| frame.file == frame_name(frame.number, format);
        let frames: Vec<_> = there.frames.into_iter().filter(own).collect();
        if let Some(early) = frames.iter().find(|frame| frame.number < self.settings.first_frame) {
            return refuse(format!(
                "it contains frame {}, which is before the first requested frame {}",
                early.number, self.settings.first_frame
            ));
        }
        Ok(journal::whole_frames(&self.folder, frames))
    }

    fn start_threads(&mut self, format: SequenceFormat, opener: &Arc<Opener>) -> Result<(), RecordError> {
        let SequenceSettings { width, height, .. } = self.settings;
        let is_large = format == SequenceFormat::Exr && u64::from(width) * u64::from(height) > LARGE;
        let most = if is_large { 2 } else { MAX_THREADS };
        let count = std::thread::available_parallelism().map_or(1, usize::from).min(most);
        let (jobs, todo) = sync_channel(if is_large { 1 } else { count });
        let (done, spent) = sync_channel(2 * count + 2);
        (self.jobs, self.spent) = (Some(jobs), spent);
        let todo = Arc::new(Mutex::new(todo));
        for index in 0..count {
            let worker = Worker {
                folder: self.folder.clone(),
                width,
                height,
                rate: self.rate,
                format,
                alpha: self.settings.alpha,
                comments: self.comments(),
                opener: opener.clone(),
                shared: self.shared.clone(),
            };
            let (todo, done) = (todo.clone(), done.clone());
            let thread = std::thread::Builder::new()
                .name(format!("lovelock-frames-{index}"))
                .spawn(move || worker.run(&todo, &done))
                .map_err(|error| RecordError::io(&self.folder, "start a thread for its frames", error))?;
            self.threads.push(thread);
        }
        Ok(())
    }

    /// How the frames were rendered, in one line of ASCII for the files' comments.
    fn comments(&self) -> String {
        let texts = self.settings.settings.as_object().into_iter().flatten();
        let said = texts.filter_map(|(key, value)| Some(format!("{key} {}", value.as_str()?)));
        said.collect::<Vec<_>>().join(", ").replace(|c: char| !c.is_ascii(), "?")
    }

    /// Gives the sequence a sound, which [`SequenceWriter::finish`] writes as [`SOUND_NAME`] into the folder. It ends with the last frame.
    ///
    /// # Errors
    /// [`RecordError::Request`] if there is a file of this name that the recording before did not write.
    pub fn set_sound(&mut self, sound: Box<dyn SoundSource>) -> Result<(), RecordError> {
        sound_file::check_place(&self.folder, self.old_sound.as_ref())?;
        self.sound = Some(sound);
        Ok(())
    }

    /// Whether the next frame already exists and is complete, so that it can be skipped with [`SequenceWriter::keep_next`].
    pub fn next_is_kept(&self) -> bool {
        self.kept.contains_key(&(self.settings.first_frame + self.at))
    }

    /// Skips the next frame if it is kept; otherwise does nothing.
    pub fn keep_next(&mut self) {
        self.at += u64::from(self.next_is_kept());
    }

    /// Writes the next frame: RGBA, 8-bit sRGB, rows from the top, `width × height × 4` bytes.
    ///
    /// Returns as soon as the frame is in the queue. An error may therefore belong to an earlier frame, which it names.
    ///
    /// # Errors
    /// [`RecordError::FrameSize`] for a wrong number of bytes, after which recording can continue; [`RecordError::Request`] if
    /// the files are EXR; [`RecordError::Io`] for errors such as a full disk, and [`RecordError::Stopped`] after that.
    pub fn push(&mut self, rgba: &[u8]) -> Result<(), RecordError> {
        check_frame(rgba, self.settings.width, self.settings.height)?;
        self.check_format(SequenceFormat::Png)?;
        let mut buffer = self.spent.try_recv().unwrap_or_default();
        buffer.clear();
        buffer.extend_from_slice(rgba);
        self.hand_over(Pixels::Rgba(buffer))
    }

    /// Writes the next frame of a sequence of EXR files: `width × height` items of each layer.
    ///
    /// # Errors
    /// As [`SequenceWriter::push`].
    pub fn push_layers(&mut self, layers: &FrameLayers) -> Result<(), RecordError> {
        self.check_format(SequenceFormat::Exr)?;
        let SequenceSettings { width, height, .. } = self.settings;
        let wanted = width as usize * height as usize;
        for found in [layers.light.len(), layers.depth.len(), layers.transmittance.len()] {
            if found != wanted {
                let (found, wanted) = (found * 16, wanted * 16);
                return Err(RecordError::FrameSize { found, wanted, width, height });
            }
        }
        self.hand_over(Pixels::Layers(Box::new(exr::Planes::new(layers))))
    }

    fn check_format(&self, given: SequenceFormat) -> Result<(), RecordError> {
        if self.settings.format == given {
            return Ok(());
        }
        let wanted = self.settings.format.label();
        Err(RecordError::request(format!(
            "a frame for {} cannot be written to a sequence of {wanted}",
            given.label()
        )))
    }

    fn hand_over(&mut self, pixels: Pixels) -> Result<(), RecordError> {
        let Some(jobs) = &self.jobs else {
            return Err(RecordError::Stopped { path: self.folder.clone() });
        };
        let number = self.settings.first_frame + self.at;
        if jobs.send(Job { number, pixels }).is_ok() && lock(&self.shared).error.is_none() {
            self.at += 1;
            return Ok(());
        }
        self.end(false).map(drop)
    }

    /// Encodes the frames in the queue, writes the sound and the manifest, and removes frames of the old sequence that this one lacks,
    /// and its sound.
    ///
    /// # Errors
    /// As [`SequenceWriter::push`]; also [`RecordError::Request`] for a sequence of no frames.
    pub fn finish(mut self) -> Result<SequenceReport, RecordError> {
        if self.at == 0 && self.jobs.is_some() {
            let what = format!("{}: a sequence needs at least one frame", self.folder.display());
            return Err(RecordError::request(what));
        }
        // Before the manifest, which lists it.
        if let Some(mut sound) = self.sound.take().filter(|_| !self.ended) {
            let samples = samples_of(self.at, self.rate);
            let written = sound_file::write(&self.folder, sound.as_mut(), samples);
            self.new_sound =
                Some(written.map_err(|error| {
                    RecordError::io(self.folder.join(SOUND_NAME), "write the sound", error)
                })?);
        }
        self.end(true)
    }

    /// Cancels the recording. This is the same as dropping the writer.
    pub fn cancel(self) {}

    /// Ends the threads and writes the manifest.
    fn end(&mut self, finished: bool) -> Result<SequenceReport, RecordError> {
        if std::mem::replace(&mut self.ended, true) {
            return Err(RecordError::Stopped { path: self.folder.clone() });
        }
        self.jobs = None;
        let panicked = self.threads.drain(..).map(JoinHandle::join).filter(Result::is_err).count() > 0;
        let Progress { frames, error, journal } = std::mem::take(&mut *lock(&self.shared));
        let first = self.settings.first_frame;
        let all = (first..first + self.at).all(|number| frames.contains_key(&number));
        let whole = finished && error.is_none() && !panicked && all;
        let manifest = self.manifest(whole, frames.into_values().collect());
        // After an error there may be no room for a manifest; the first error is then returned.
        let written = match &self.old {
            _ if !manifest.frames.is_empty() => self.write_manifest(&manifest),
            // No frame was replaced, so the folder holds what it held before.
            Some(old) => self.write_manifest(old),
            // A folder without frames needs no manifest.
            None => Ok(()),
        };
        // If the manifest could not be written, the journal stays.
        if let Some(journal) = journal.filter(|_| written.is_ok()) {
            journal.remove();
        }
        match error {
            Some(error) => return Err(error),
            None if panicked => {
                return Err(RecordError::Stopped { path: self.folder.clone() });
            }
            None => written?,
        }
        if whole {
            self.remove_old_files(&manifest);
        }
        let of_sound = self.new_sound.as_ref().map(|sound| sound.bytes);
        let bytes = manifest.frames.iter().map(|frame| frame.bytes).chain(of_sound).sum();
        let (frames, kept) = (manifest.frames.len() as u64, self.kept.len() as u64);
        Ok(SequenceReport { folder: self.folder.clone(), frames, kept, bytes })
    }

    /// The manifest. Until the sequence is complete, it lists the sound of the one before.
    fn manifest(&self, complete: bool, frames: Vec<ManifestFrame>) -> Manifest {
        let old_sound = self.old_sound.as_ref().filter(|_| !complete);
        Manifest {
            format: "lovelock-sequence".into(),
            version: VERSION,
            complete,
            width: self.settings.width,
            height: self.settings.height,
            fps: self.settings.fps,
            first_frame: self.settings.first_frame,
            frames,
            sound: self.new_sound.as_ref().or(old_sound).cloned(),
            settings: self.settings.settings.clone(),
        }
    }

    fn write_manifest(&self, manifest: &Manifest) -> Result<(), RecordError> {
        left::write_manifest(&self.folder, manifest)
    }

    fn remove_old_files(&self, manifest: &Manifest) {
        if let (Some(old), None) = (&self.old_sound, &self.new_sound) {
            remove_own(&self.folder, old);
        }
        for file in &self.old_files {
            if manifest.frames.iter().all(|frame| frame.file != *file) {
                // Errors do no harm, because the manifest does not list the file.
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

/// Locks the progress, also after a thread has panicked with the lock: every change is a single step.
fn lock(shared: &Mutex<Progress>) -> std::sync::MutexGuard<'_, Progress> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests;
