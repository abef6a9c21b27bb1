//! Progress and cancellation of a load.

use std::sync::atomic::{AtomicBool, Ordering};

use lovelock_base::watch::Watch;
use lovelock_project::error::ProjectError;

use crate::aside::aside;

/// Progress and cancellation of a load.
pub struct LoadControl<'a> {
    /// Set by any thread to stop the load at the next opportunity.
    pub cancelled: &'a AtomicBool,
    /// Called with the current work, such as `growing the hair`, and the fraction that is done.
    pub progress: &'a mut dyn FnMut(&str, f32),
}

impl LoadControl<'_> {
    /// Reads a file on another thread: reading stops when the load is cancelled. `what` is done, and the part of the load from and to
    /// which this goes.
    pub(super) fn read<T: Send + 'static>(
        &mut self,
        what: &str,
        [from, to]: [f32; 2],
        work: impl FnOnce(&Watch) -> T + Send + 'static,
    ) -> Result<T, ProjectError> {
        aside(self.cancelled, &mut |done| (self.progress)(what, from + (to - from) * done), work)
    }

    pub(super) fn at(&mut self, what: &str, fraction: f32) -> Result<(), ProjectError> {
        if self.cancelled.load(Ordering::Relaxed) {
            return Err(ProjectError::Cancelled);
        }
        (self.progress)(what, fraction);
        Ok(())
    }
}
