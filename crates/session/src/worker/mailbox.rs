//! The mailbox of the simulation thread, in which later requests replace earlier ones.
//!
//! It holds at most one request of each kind, so it cannot overflow and nobody waits, however fast a slider is dragged. Only what brushes
//! do is kept in order.

use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

use lovelock_brush::StrokeSample;
use lovelock_project::Project;
use lovelock_project::files::Access;

use super::load_thread::Loaded;
use crate::strokes::StrokeStart;

/// A request about recording a take.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum TakeRequest {
    /// Start recording.
    Start(PathBuf),
    /// Complete the take.
    Finish,
}

/// A request of a brush.
#[derive(Debug)]
pub(super) enum BrushRequest {
    /// A stroke begins.
    Begin(Box<StrokeStart>),
    /// The brush of a stroke moves.
    To(u64, Vec<StrokeSample>),
    /// A stroke ends.
    End(u64),
    /// All strokes are forgotten.
    Cancel,
    /// No hair is protected any more.
    Thaw,
}

/// All pending requests.
#[derive(Default)]
pub(super) struct Requests {
    /// The current project, and the files that it may read.
    pub(super) project: Option<(Arc<Project>, Access)>,
    /// The result of the loader.
    pub(super) loaded: Option<Loaded>,
    /// Play or pause.
    pub(super) playing: Option<bool>,
    /// Scene seconds per second.
    pub(super) rate: Option<f64>,
    /// Refresh rate of the display, Hz.
    pub(super) display_hz: Option<f64>,
    /// Whether a take is played backwards.
    pub(super) backwards: Option<bool>,
    /// A time to seek to, seconds.
    pub(super) seek_secs: Option<f64>,
    /// Whether the totals are kept after the seek.
    pub(super) look_back: bool,
    /// Steps forward (positive) or backward, after `seek_secs`.
    pub(super) steps: i64,
    /// Move to the first frame and settle the hair.
    pub(super) restart: bool,
    /// Settle the hair at the current time (true), or cancel settling (false).
    pub(super) settle: Option<bool>,
    /// Start or complete the recording of a take.
    pub(super) take: Option<TakeRequest>,
    /// What brushes do, in this order.
    pub(super) brushes: Vec<BrushRequest>,
    /// Whether the hair stays in its rest shape.
    pub(super) still: Option<bool>,
    /// End the thread.
    pub(super) stop: bool,
}

/// The requests since the reader took the last ones; `None` if there are none.
type Pending = Option<Requests>;

/// The mailbox, shared between threads.
#[derive(Clone, Default)]
pub(super) struct Mailbox {
    shared: Arc<(Mutex<Pending>, Condvar)>,
}

impl Mailbox {
    /// Adds a request and wakes the reader.
    pub(super) fn post(&self, request: impl FnOnce(&mut Requests)) {
        let (pending, changed) = &*self.shared;
        request(pending.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert_default());
        changed.notify_one();
    }

    /// Whether a project or the result of a load waits to be taken.
    pub(super) fn has_changes(&self) -> bool {
        let pending = self.shared.0.lock().unwrap_or_else(PoisonError::into_inner);
        pending.as_ref().is_some_and(|requests| requests.project.is_some() || requests.loaded.is_some())
    }

    /// Takes all requests. Waits for one for at most `timeout`, or without limit if there is none.
    pub(super) fn take(&self, timeout: Option<Duration>) -> Requests {
        let (pending, changed) = &*self.shared;
        let guard = pending.lock().unwrap_or_else(PoisonError::into_inner);
        let mut guard = match timeout {
            Some(timeout) => {
                changed
                    .wait_timeout_while(guard, timeout, |pending| pending.is_none())
                    .unwrap_or_else(PoisonError::into_inner)
                    .0
            }
            None => {
                changed.wait_while(guard, |pending| pending.is_none()).unwrap_or_else(PoisonError::into_inner)
            }
        };
        guard.take().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn later_requests_replace_earlier_ones_and_steps_add_up() {
        let mailbox = Mailbox::default();
        for i in 0..1000 {
            mailbox.post(|requests| requests.seek_secs = Some(f64::from(i)));
            mailbox.post(|requests| requests.steps += 1);
        }
        assert!(!mailbox.has_changes());
        mailbox.post(|requests| requests.project = Some((Arc::default(), Access::new())));
        assert!(mailbox.has_changes());
        let requests = mailbox.take(None);
        assert_eq!((requests.seek_secs, requests.steps), (Some(999.0), 1000));
        assert!(!mailbox.has_changes());
        let none = mailbox.take(Some(Duration::ZERO));
        assert_eq!((none.seek_secs, none.steps), (None, 0));
    }
}
