//! A recording on its own thread, for a window that goes on.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use lovelock_project::Project;
use lovelock_project::error::StudioError;
use lovelock_session::progress::Progress;
use lovelock_session::worker::Wake;

use super::curves::{is_curves, record_curves};
use super::pictures::record;
use super::request::RecordRequest;

/// What a [`RecordJob`] has written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recorded {
    /// The film, the folder or the file of curves.
    pub out: PathBuf,
    /// Frames in it.
    pub frames: u64,
    /// Those of them that an earlier recording had left whole.
    pub frames_kept: u64,
}

/// A recording that runs on its own thread. Dropping it cancels it and waits until nothing unfinished is left.
pub struct RecordJob {
    cancelled: Arc<AtomicBool>,
    progress: Arc<Mutex<Option<Progress>>>,
    thread: Option<JoinHandle<Result<Recorded, StudioError>>>,
}

impl RecordJob {
    /// Starts to record pictures, or curves where the output's name asks for them; `wake` is called with every progress and at the end.
    ///
    /// # Errors
    /// Where the system gives no thread.
    pub fn start(project: Arc<Project>, request: RecordRequest, wake: Wake) -> Result<Self, StudioError> {
        let cancelled = Arc::new(AtomicBool::new(false));
        let progress = Arc::new(Mutex::new(None));
        let (stop, shown) = (Arc::clone(&cancelled), Arc::clone(&progress));
        let thread = std::thread::Builder::new()
            .name("lovelock recording".to_owned())
            .spawn(move || {
                let mut tell = |what| {
                    *shown.lock().unwrap_or_else(PoisonError::into_inner) = Some(what);
                    wake();
                    if stop.load(Ordering::Relaxed) {
                        ControlFlow::Break(())
                    } else {
                        ControlFlow::Continue(())
                    }
                };
                let done = catch_unwind(AssertUnwindSafe(|| {
                    let (frames, frames_kept) = if is_curves(&request.out) {
                        (record_curves(&project, &request, &mut tell)?.frames, 0)
                    } else {
                        let report = record(&project, &request, &mut tell)?;
                        (report.frames, report.frames_kept)
                    };
                    Ok(Recorded { out: request.out.clone(), frames, frames_kept })
                }));
                wake();
                done.unwrap_or_else(|_| {
                    Err(StudioError::work("the recording met a defect of the program and stopped"))
                })
            })
            .map_err(|error| StudioError::work(format!("the recording thread could not start: {error}")))?;
        Ok(Self { cancelled, progress, thread: Some(thread) })
    }

    /// How far it is; none before it has begun.
    pub fn progress(&self) -> Option<Progress> {
        self.progress.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Asks it to stop; it ends with [`StudioError::Cancelled`] within a frame.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether it has ended: [`RecordJob::finish`] does not wait then.
    pub fn is_finished(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Waits for its end and says how it went.
    ///
    /// # Errors
    /// As [`record`] and [`record_curves`].
    pub fn finish(mut self) -> Result<Recorded, StudioError> {
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(result)) => result,
            Some(Err(_)) | None => Err(StudioError::work("the recording thread ended without a word")),
        }
    }
}

impl Drop for RecordJob {
    fn drop(&mut self) {
        self.cancel();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
