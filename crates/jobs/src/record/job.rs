//! A recording on a background thread, for the window.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_session::progress::Progress;
use lovelock_session::worker::Wake;

use super::curves::{is_curves, record_curves};
use super::pictures::record;
use super::request::RecordRequest;

/// The result of a [`RecordJob`].
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Recorded {
    /// The film, the folder or the file of curves.
    pub out: PathBuf,
    /// Number of frames.
    pub frames: u64,
    /// Number of frames kept from an earlier recording.
    pub frames_kept: u64,
}

/// A recording on a background thread. Dropping it cancels the recording and waits until unfinished files are removed.
pub struct RecordJob {
    cancelled: Arc<AtomicBool>,
    progress: Arc<Mutex<Option<Progress>>>,
    thread: Option<JoinHandle<Result<Recorded, ProjectError>>>,
}

impl RecordJob {
    /// Starts recording images, or curves if the output name has such an extension. `wake` is called for every progress report and
    /// at the end.
    ///
    /// # Errors
    /// If the system cannot create a thread.
    pub fn start(project: Arc<Project>, request: RecordRequest, wake: Wake) -> Result<Self, ProjectError> {
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
                    Err(ProjectError::work("the recording stopped because of an internal error"))
                })
            })
            .map_err(|error| ProjectError::work(format!("the recording thread could not start: {error}")))?;
        Ok(Self { cancelled, progress, thread: Some(thread) })
    }

    /// Progress; `None` before the start.
    pub fn progress(&self) -> Option<Progress> {
        self.progress.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Cancels the recording, which ends with [`ProjectError::Cancelled`] within a frame.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether it has ended, so that [`RecordJob::finish`] does not wait.
    pub fn is_finished(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Waits for the end and returns the result.
    ///
    /// # Errors
    /// As [`record`] and [`record_curves`].
    pub fn finish(mut self) -> Result<Recorded, ProjectError> {
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(result)) => result,
            Some(Err(_)) | None => Err(ProjectError::work("the recording thread ended without a result")),
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
