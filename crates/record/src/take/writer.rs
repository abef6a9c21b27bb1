//! Recording of takes.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::JoinHandle;

use super::codec::{META_BYTES, Meta};
use super::disk::{Mount, claim, mount_file, part_path, sync_folder};
use super::layout::Layout;
use super::quantise::quantise;
use super::settings::SettingsLog;
use super::worker::{Job, PendingChunk, TakeFile};
use super::{MAX_PROJECT_BYTES, TAKE_VERSION, TakeError, TakeFrame, TakeHeader};

/// Frames per chunk, if they last a second or less. Chunks twice as long are 4 % smaller, but take twice as long to read
/// for a single frame.
const CHUNK_FRAMES: usize = 30;

/// Chunks in the queue. The disk may pause for two seconds before [`TakeWriter::push`] waits.
const QUEUE: usize = 4;

/// Bytes of frames and of changes after which a chunk ends early, to bound memory for a long project or a very fine
/// hairstyle.
const CHUNK_BYTES: usize = 32 << 20;
const CHUNK_TEXT_BYTES: usize = 16 << 20;

/// What was recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct TakeReport {
    /// The take.
    pub path: PathBuf,
    /// Number of frames.
    pub frames: u64,
    /// Length of the file in bytes.
    pub bytes: u64,
    /// Duration in seconds.
    pub duration_secs: f64,
}

/// A take that is being recorded.
///
/// It is written as `NAME.part`, one second at a time, and [`TakeWriter::finish`] renames it to its final name. If the writer is
/// dropped before, or the program or machine stops, that file stays, and [`super::TakeReader`] can open it.
pub struct TakeWriter {
    path: PathBuf,
    part: PathBuf,
    header: TakeHeader,
    chunk_frames: usize,
    pending: PendingChunk,
    frames: u64,
    kept: Arc<AtomicU64>,
    jobs: Option<SyncSender<Job>>,
    worker: Option<JoinHandle<Result<Option<u64>, TakeError>>>,
}

impl TakeWriter {
    /// Starts a take at `path` and creates its folder if it is missing. An existing take stays until the new one is
    /// complete. An unfinished take of an earlier recording is kept as `NAME-cut1.take.part`.
    ///
    /// # Errors
    /// [`TakeError::Busy`] if another recording is writing it, [`TakeError::Request`] for an invalid header or a `path` that
    /// is a folder, [`TakeError::Io`] and [`TakeError::Write`] if the file cannot be created.
    pub fn create(path: &Path, header: TakeHeader) -> Result<Self, TakeError> {
        Self::create_on(path, header, &mount_file)
    }

    pub(super) fn create_on(path: &Path, mut header: TakeHeader, mount: &Mount) -> Result<Self, TakeError> {
        header.version = TAKE_VERSION;
        let layout = header
            .check()
            .and_then(|()| header.layout())
            .map_err(|(found, wanted)| TakeError::request(path, format!("{found}; must be {wanted}")))?;
        if path.file_name().is_none() || path.is_dir() {
            return Err(TakeError::request(
                path,
                "is a folder; must be the name of a file, such as dance.take",
            ));
        }
        let head = serde_json::to_vec(&header)
            .map_err(|error| TakeError::request(path, format!("a header that cannot be written: {error}")))?;
        let part = part_path(path);
        let disk = mount(claim(path)?);
        let kept = Arc::new(AtomicU64::new(0));
        let file = match TakeFile::start(path, &part, disk, head, Arc::clone(&kept)) {
            Ok(file) => file,
            Err(error) => {
                // Nothing has been recorded yet.
                let _ = fs::remove_file(&part);
                return Err(error);
            }
        };
        sync_folder(&part);
        let (jobs, todo) = sync_channel(QUEUE);
        let worker = std::thread::Builder::new()
            .name("take".to_owned())
            .spawn(move || file.run(&todo))
            .map_err(|error| TakeError::io(path, "start the thread that writes it", error))?;
        let chunk_frames = chunk_frames(&header, layout);
        Ok(Self {
            path: path.to_owned(),
            part,
            chunk_frames,
            pending: PendingChunk::new(header.project.clone(), chunk_frames, layout),
            header,
            frames: 0,
            kept,
            jobs: Some(jobs),
            worker: Some(worker),
        })
    }

    /// Adds a frame. Waits only if the disk is seconds behind.
    ///
    /// # Errors
    /// [`TakeError::Request`] for a frame whose layout differs from the header or [`TakeWriter::set_layout`], or whose positions are
    /// not finite. Nothing is added then, and recording can continue. [`TakeError::Write`] if an earlier frame could not be
    /// written. The recording has then stopped, and the frames written before stay in the file [`TakeWriter::part_path`].
    pub fn push(&mut self, frame: &TakeFrame) -> Result<(), TakeError> {
        self.check_worker()?;
        let layout = self.pending.layout;
        let size = layout.numbers();
        let start = self.pending.numbers.len();
        self.pending.numbers.resize(start + size, 0);
        if let Err(what) = quantise(&frame.guides, layout, &mut self.pending.numbers[start..]) {
            self.pending.numbers.truncate(start);
            return Err(TakeError::request(&self.path, format!("frame {}: {what}", self.frames)));
        }
        self.pending.metas.push(Meta {
            time_secs: frame.guides.time_secs,
            clip_secs: frame.clip_secs,
            wall_frame: frame.wall_frame,
            substeps: frame.substeps,
            jumped: frame.jumped,
            world_from_head: frame.guides.world_from_head,
        });
        self.frames += 1;
        if self.pending.metas.len() >= self.chunk_frames || self.pending.settings.bytes() > CHUNK_TEXT_BYTES {
            self.flush()?;
        }
        Ok(())
    }

    /// Records that the project is `project` from the next frame on. An unchanged text takes no space.
    ///
    /// # Errors
    /// [`TakeError::Request`] for a text of more than [`MAX_PROJECT_BYTES`].
    pub fn change(&mut self, project: &str) -> Result<(), TakeError> {
        if project.len() > MAX_PROJECT_BYTES {
            let what = format!("a project of {} bytes; must be at most {MAX_PROJECT_BYTES}", project.len());
            return Err(TakeError::request(&self.path, what));
        }
        self.pending.settings.change(self.pending.metas.len() as u32, project);
        Ok(())
    }

    /// Sets the number of guides and points per guide from the next frame on. A change ends the present chunk.
    ///
    /// # Errors
    /// [`TakeError::Request`] for an invalid layout; [`TakeError::Write`] as [`TakeWriter::push`].
    pub fn set_layout(&mut self, guides: usize, points_per_guide: usize) -> Result<(), TakeError> {
        let words = [guides, points_per_guide].map(|n| u32::try_from(n).unwrap_or(u32::MAX));
        let layout = Layout::new(words[0], words[1]).map_err(|(found, wanted)| {
            TakeError::request(&self.path, format!("{found}; must be {wanted}"))
        })?;
        if layout == self.pending.layout {
            return Ok(());
        }
        self.check_worker()?;
        self.flush()?;
        self.chunk_frames = chunk_frames(&self.header, layout);
        self.pending = PendingChunk::new(self.pending.settings.now().to_owned(), self.chunk_frames, layout);
        Ok(())
    }

    /// Number of frames that were pushed.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Number of frames that are safely on the disk.
    pub fn kept_frames(&self) -> u64 {
        self.kept.load(Ordering::Acquire)
    }

    /// The final path of the take.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Path of the unfinished file.
    pub fn part_path(&self) -> &Path {
        &self.part
    }

    /// Completes the take and renames it to its final name.
    ///
    /// # Errors
    /// [`TakeError::Request`] for a take without frames, whose file is removed; [`TakeError::Write`] if the disk
    /// fails, which leaves the file [`TakeWriter::part_path`].
    pub fn finish(mut self) -> Result<TakeReport, TakeError> {
        self.check_worker()?;
        if self.frames == 0 {
            // Dropping the writer removes the file.
            return Err(TakeError::request(&self.path, "has no frames; must have at least one"));
        }
        self.flush()?;
        self.send(Job::Finish)?;
        match self.join()? {
            Some(bytes) => Ok(TakeReport {
                path: self.path.clone(),
                frames: self.frames,
                bytes,
                duration_secs: self.header.secs_of(self.frames),
            }),
            None => Err(self.stopped()),
        }
    }

    /// Stops the recording and removes its file.
    ///
    /// # Errors
    /// [`TakeError::Io`] if the unfinished file cannot be removed.
    pub fn discard(mut self) -> Result<(), TakeError> {
        self.pending.metas.clear();
        self.send(Job::Discard)?;
        self.join().map(|_| ())
    }

    /// Sends the pending chunk to the worker.
    fn flush(&mut self) -> Result<(), TakeError> {
        if self.pending.metas.is_empty() {
            return Ok(());
        }
        let next =
            PendingChunk::new(self.pending.settings.now().to_owned(), self.chunk_frames, self.pending.layout);
        let pending = std::mem::replace(&mut self.pending, next);
        self.send(Job::Chunk(pending))
    }

    fn send(&mut self, job: Job) -> Result<(), TakeError> {
        let sent = self.jobs.as_ref().is_some_and(|jobs| jobs.send(job).is_ok());
        if sent { Ok(()) } else { self.fail() }
    }

    /// Returns the worker's error if it has ended.
    fn check_worker(&mut self) -> Result<(), TakeError> {
        match &self.worker {
            Some(worker) if !worker.is_finished() => Ok(()),
            _ => self.fail(),
        }
    }

    fn fail(&mut self) -> Result<(), TakeError> {
        self.pending.metas.clear();
        self.join()?;
        Err(self.stopped())
    }

    /// Waits for the worker.
    fn join(&mut self) -> Result<Option<u64>, TakeError> {
        self.jobs = None;
        match self.worker.take().map(JoinHandle::join) {
            Some(Ok(result)) => result,
            Some(Err(_)) | None => Err(self.stopped()),
        }
    }

    fn stopped(&self) -> TakeError {
        TakeError::Stopped { path: self.part.clone(), kept: self.kept_frames() }
    }
}

impl Drop for TakeWriter {
    fn drop(&mut self) {
        if self.worker.is_none() {
            return;
        }
        // Errors cannot be reported from here. Frames that reach the disk are kept.
        let _ = if self.frames == 0 { self.send(Job::Discard) } else { self.flush() };
        if self.worker.is_some() {
            let _ = self.join();
        }
    }
}

/// Frames per chunk for a layout.
fn chunk_frames(header: &TakeHeader, layout: Layout) -> usize {
    let frame_bytes = layout.numbers() * size_of::<i32>() + META_BYTES;
    let a_second = (header.frames_per_second.as_f64() as usize).clamp(1, CHUNK_FRAMES);
    (CHUNK_BYTES / frame_bytes).clamp(1, a_second)
}

impl PendingChunk {
    fn new(project: String, frames: usize, layout: Layout) -> Self {
        Self {
            layout,
            metas: Vec::with_capacity(frames),
            numbers: Vec::with_capacity(frames * layout.numbers()),
            settings: SettingsLog::new(project),
        }
    }
}
