//! Long work on a background thread, with progress, for the window.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

use lovelock_project::error::ProjectError;

use crate::progress::Progress;
use crate::worker::Wake;

/// Work on a background thread. Dropping it cancels the work and waits until unfinished files are removed.
pub struct BackgroundJob<T> {
    cancelled: Arc<AtomicBool>,
    progress: Arc<Mutex<Option<Progress>>>,
    thread: Option<JoinHandle<Result<T, ProjectError>>>,
}

impl<T: Send + 'static> BackgroundJob<T> {
    /// Starts `work`, a noun such as `recording` in messages. `wake` is called for every progress report and at the end.
    ///
    /// # Errors
    /// If the system cannot create a thread.
    pub fn start(
        name: &'static str,
        wake: Wake,
        work: impl FnOnce(&mut dyn FnMut(Progress) -> ControlFlow<()>) -> Result<T, ProjectError> + Send + 'static,
    ) -> Result<Self, ProjectError> {
        let cancelled = Arc::new(AtomicBool::new(false));
        let progress = Arc::new(Mutex::new(None));
        let (stop, shown) = (Arc::clone(&cancelled), Arc::clone(&progress));
        let thread = std::thread::Builder::new()
            .name(format!("lovelock {name}"))
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
                let done = catch_unwind(AssertUnwindSafe(|| work(&mut tell)));
                wake();
                done.unwrap_or_else(|_| {
                    Err(ProjectError::work(format!("the {name} stopped because of an internal error")))
                })
            })
            .map_err(|error| ProjectError::work(format!("the {name} thread could not start: {error}")))?;
        Ok(Self { cancelled, progress, thread: Some(thread) })
    }
}

impl<T> BackgroundJob<T> {
    /// Progress; `None` before the start.
    pub fn progress(&self) -> Option<Progress> {
        self.progress.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Cancels the work, which ends with [`ProjectError::Cancelled`] after its next report of progress.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether it has ended, so that [`BackgroundJob::finish`] does not wait.
    pub fn is_finished(&self) -> bool {
        self.thread.as_ref().is_none_or(JoinHandle::is_finished)
    }

    /// Waits for the end and returns the result.
    ///
    /// # Errors
    /// As the work.
    pub fn finish(mut self) -> Result<T, ProjectError> {
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(result)) => result,
            Some(Err(_)) | None => Err(ProjectError::work("the thread ended without a result")),
        }
    }
}

impl<T> Drop for BackgroundJob<T> {
    fn drop(&mut self) {
        self.cancel();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}
