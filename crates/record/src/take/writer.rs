//! Recording a take.

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
use super::worker::{Job, Load, TakeFile};
use super::{MOST_PROJECT_BYTES, TAKE_VERSION, TakeError, TakeFrame, TakeHeader};

/// Frames in a chunk, where they last a second or less: longer chunks are 4 % smaller, and take twice as long to read
/// where one of their frames is wanted.
const CHUNK_FRAMES: usize = 30;

/// Chunks that may wait for the disk, so that it may pause for two seconds before [`TakeWriter::push`] waits.
const QUEUE: usize = 4;

/// Bytes of frames and of changes after which a chunk ends early, so that a long project or a very fine hairstyle does
/// not pile up.
const CHUNK_BYTES: usize = 32 << 20;
const CHUNK_TEXT_BYTES: usize = 16 << 20;

/// What was recorded.
#[derive(Clone, Debug, PartialEq)]
pub struct TakeReport {
    /// The take.
    pub path: PathBuf,
    /// Frames in it.
    pub frames: u64,
    /// Its length in bytes.
    pub bytes: u64,
    /// Its length in seconds.
    pub duration_secs: f64,
}

/// A take in the making.
///
/// It grows as `NAME.part` beside its name, a second at a time, and [`TakeWriter::finish`] gives it its name. Dropped
/// before, killed or unplugged, it leaves that file, which [`super::TakeReader`] opens.
pub struct TakeWriter {
    path: PathBuf,
    part: PathBuf,
    header: TakeHeader,
    chunk_frames: usize,
    pending: Load,
    frames: u64,
    kept: Arc<AtomicU64>,
    jobs: Option<SyncSender<Job>>,
    worker: Option<JoinHandle<Result<Option<u64>, TakeError>>>,
}

impl TakeWriter {
    /// Starts a take at `path`, creating its folder where missing. A take already there stays until the new one is
    /// whole; an unfinished one that an earlier recording left is kept as `NAME-cut1.take.part`.
    ///
    /// # Errors
    /// [`TakeError::Busy`] where another writer is working on it, [`TakeError::Request`] for a header that no take can
    /// have or a `path` that is a folder, [`TakeError::Io`] and [`TakeError::Write`] where the file cannot be made.
    pub fn create(path: &Path, header: TakeHeader) -> Result<Self, TakeError> {
        Self::create_on(path, header, &mount_file)
    }

    pub(super) fn create_on(path: &Path, mut header: TakeHeader, mount: &Mount) -> Result<Self, TakeError> {
        header.version = TAKE_VERSION;
        let layout = header
            .check()
            .and_then(|()| header.layout())
            .map_err(|(found, wanted)| TakeError::request(path, format!("{found}; wanted {wanted}")))?;
        if path.file_name().is_none() || path.is_dir() {
            return Err(TakeError::request(
                path,
                "is a folder; wanted the name of a file, such as dance.take",
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
                // Nothing was recorded yet.
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
            pending: Load::new(header.project.clone(), chunk_frames, layout),
            header,
            frames: 0,
            kept,
            jobs: Some(jobs),
            worker: Some(worker),
        })
    }

    /// Adds a frame. Waits only where the disk is seconds behind.
    ///
    /// # Errors
    /// [`TakeError::Request`] for a frame of another size than the header or [`TakeWriter::set_layout`] says or with a place that is not a number:
    /// nothing is added then, and the take goes on. [`TakeError::Write`] where the disk refused an earlier frame: what
    /// is kept stays in the file of [`TakeWriter::part_path`], and the take has stopped.
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

    /// Says that from the next frame on the project is `project`. A text that is as before costs nothing.
    ///
    /// # Errors
    /// [`TakeError::Request`] for a text of more than [`MOST_PROJECT_BYTES`].
    pub fn change(&mut self, project: &str) -> Result<(), TakeError> {
        if project.len() > MOST_PROJECT_BYTES {
            let what = format!("a project of {} bytes; wanted {MOST_PROJECT_BYTES} at most", project.len());
            return Err(TakeError::request(&self.path, what));
        }
        self.pending.settings.change(self.pending.metas.len() as u32, project);
        Ok(())
    }

    /// Says that from the next frame on there are so many guides of so many points. Ends the chunk where they are others
    /// than before.
    ///
    /// # Errors
    /// [`TakeError::Request`] for a size that no take can hold; [`TakeError::Write`] as [`TakeWriter::push`].
    pub fn set_layout(&mut self, guides: usize, points_per_guide: usize) -> Result<(), TakeError> {
        let words = [guides, points_per_guide].map(|n| u32::try_from(n).unwrap_or(u32::MAX));
        let layout = Layout::new(words[0], words[1])
            .map_err(|(found, wanted)| TakeError::request(&self.path, format!("{found}; wanted {wanted}")))?;
        if layout == self.pending.layout {
            return Ok(());
        }
        self.check_worker()?;
        self.flush()?;
        self.chunk_frames = chunk_frames(&self.header, layout);
        self.pending = Load::new(self.pending.settings.now().to_owned(), self.chunk_frames, layout);
        Ok(())
    }

    /// Frames pushed.
    pub fn frames(&self) -> u64 {
        self.frames
    }

    /// Frames that are on the disk, whatever happens now.
    pub fn kept_frames(&self) -> u64 {
        self.kept.load(Ordering::Acquire)
    }

    /// The take's name when it is finished.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The file that it grows in.
    pub fn part_path(&self) -> &Path {
        &self.part
    }

    /// Makes the take whole and gives it its name.
    ///
    /// # Errors
    /// [`TakeError::Request`] for a take without frames, which leaves nothing; [`TakeError::Write`] where the disk
    /// refused, which leaves [`TakeWriter::part_path`].
    pub fn finish(mut self) -> Result<TakeReport, TakeError> {
        self.check_worker()?;
        if self.frames == 0 {
            // Dropping removes what there is.
            return Err(TakeError::request(&self.path, "has no frame; wanted one frame or more"));
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

    /// Stops and removes what was written.
    ///
    /// # Errors
    /// [`TakeError::Io`] where the unfinished file cannot be removed.
    pub fn discard(mut self) -> Result<(), TakeError> {
        self.pending.metas.clear();
        self.send(Job::Discard)?;
        self.join().map(|_| ())
    }

    /// Hands the pending chunk to the worker.
    fn flush(&mut self) -> Result<(), TakeError> {
        if self.pending.metas.is_empty() {
            return Ok(());
        }
        let next = Load::new(self.pending.settings.now().to_owned(), self.chunk_frames, self.pending.layout);
        let load = std::mem::replace(&mut self.pending, next);
        self.send(Job::Chunk(load))
    }

    fn send(&mut self, job: Job) -> Result<(), TakeError> {
        let sent = self.jobs.as_ref().is_some_and(|jobs| jobs.send(job).is_ok());
        if sent { Ok(()) } else { self.fail() }
    }

    /// Reports what ended the worker, as soon as it has ended.
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
        // There is no one to tell: what reaches the disk is kept.
        let _ = if self.frames == 0 { self.send(Job::Discard) } else { self.flush() };
        if self.worker.is_some() {
            let _ = self.join();
        }
    }
}

/// Frames in a chunk of frames of that size.
fn chunk_frames(header: &TakeHeader, layout: Layout) -> usize {
    let frame_bytes = layout.numbers() * size_of::<i32>() + META_BYTES;
    let a_second = (header.frames_per_second.as_f64() as usize).clamp(1, CHUNK_FRAMES);
    (CHUNK_BYTES / frame_bytes).clamp(1, a_second)
}

impl Load {
    fn new(project: String, frames: usize, layout: Layout) -> Self {
        Self {
            layout,
            metas: Vec::with_capacity(frames),
            numbers: Vec::with_capacity(frames * layout.numbers()),
            settings: SettingsLog::new(project),
        }
    }
}
