//! Progress and cancellation of work on another thread.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// The work was cancelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cancelled;

impl std::fmt::Display for Cancelled {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("cancelled")
    }
}

impl std::error::Error for Cancelled {}

impl From<Cancelled> for std::io::Error {
    fn from(cancelled: Cancelled) -> Self {
        Self::other(cancelled)
    }
}

/// What a reader and its caller share: how much is read, and whether it must stop. Clones are the same watch.
#[derive(Clone, Debug, Default)]
pub struct Watch(Arc<(AtomicBool, AtomicU32)>);

impl Watch {
    /// Reports that the part `done` of the work, 0 to 1, is done.
    ///
    /// # Errors
    /// If the work must stop.
    pub fn at(&self, done: f32) -> Result<(), Cancelled> {
        self.0.1.store(done.clamp(0.0, 1.0).to_bits(), Ordering::Relaxed);
        if self.0.0.load(Ordering::Relaxed) { Err(Cancelled) } else { Ok(()) }
    }

    /// The part that is done, 0 to 1.
    pub fn done(&self) -> f32 {
        f32::from_bits(self.0.1.load(Ordering::Relaxed))
    }

    /// Lets the work stop at its next report.
    pub fn cancel(&self) {
        self.0.0.store(true, Ordering::Relaxed);
    }
}
