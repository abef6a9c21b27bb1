//! What the simulation thread is asked to do: a box in which later wishes replace earlier ones.
//!
//! It holds at most one wish of each kind, so it can neither overflow nor make anybody wait, however fast a
//! slider is dragged.

use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

use lovelock_project::Project;
use lovelock_project::files::Access;

use super::load_thread::Loaded;

/// What to do with the recording of a take.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum TakeWish {
    /// Begin one.
    Start(PathBuf),
    /// Make it whole.
    Finish,
}

/// Everything that is asked for and not yet done.
#[derive(Default)]
pub(super) struct Wishes {
    /// The project as it is now, and what it may reach.
    pub(super) project: Option<(Arc<Project>, Access)>,
    /// What the loader has made.
    pub(super) loaded: Option<Loaded>,
    /// Whether time passes.
    pub(super) playing: Option<bool>,
    /// Seconds of the scene a second.
    pub(super) rate: Option<f64>,
    /// Pictures a second that the display shows.
    pub(super) display_hz: Option<f64>,
    /// Whether a take plays from its end to its start.
    pub(super) backwards: Option<bool>,
    /// A time to go to.
    pub(super) seek_secs: Option<f64>,
    /// Whether what was measured before is kept there.
    pub(super) look_back: bool,
    /// Steps to go on (positive) or back, after `seek_secs`.
    pub(super) steps: i64,
    /// Back to the first frame, the hair settled.
    pub(super) restart: bool,
    /// The hair settled where it is; or as it is, where that is under way.
    pub(super) settle: Option<bool>,
    /// A take is to be recorded, or enough of it is.
    pub(super) take: Option<TakeWish>,
    /// The thread shall end.
    pub(super) stop: bool,
}

impl Wishes {
    fn is_empty(&self) -> bool {
        let Self {
            project,
            loaded,
            playing,
            rate,
            display_hz,
            backwards,
            seek_secs,
            // It says how to go there.
            look_back: _,
            steps,
            restart,
            settle,
            take,
            stop,
        } = self;
        project.is_none()
            && loaded.is_none()
            && playing.is_none()
            && rate.is_none()
            && display_hz.is_none()
            && backwards.is_none()
            && seek_secs.is_none()
            && *steps == 0
            && !restart
            && settle.is_none()
            && take.is_none()
            && !stop
    }
}

/// The box, shared by both threads.
#[derive(Clone, Default)]
pub(super) struct Mailbox {
    shared: Arc<(Mutex<Wishes>, Condvar)>,
}

impl Mailbox {
    /// Adds a wish and wakes the reader.
    pub(super) fn ask(&self, wish: impl FnOnce(&mut Wishes)) {
        let (wishes, changed) = &*self.shared;
        wish(&mut wishes.lock().unwrap_or_else(PoisonError::into_inner));
        changed.notify_one();
    }

    /// Takes all wishes; waits for one for at most `timeout`, or for ever.
    pub(super) fn take(&self, timeout: Option<Duration>) -> Wishes {
        let (wishes, changed) = &*self.shared;
        let guard = wishes.lock().unwrap_or_else(PoisonError::into_inner);
        let mut guard = match timeout {
            Some(timeout) => {
                changed
                    .wait_timeout_while(guard, timeout, |wishes| wishes.is_empty())
                    .unwrap_or_else(PoisonError::into_inner)
                    .0
            }
            None => {
                changed.wait_while(guard, |wishes| wishes.is_empty()).unwrap_or_else(PoisonError::into_inner)
            }
        };
        std::mem::take(&mut *guard)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn later_wishes_replace_earlier_ones_and_steps_add_up() {
        let mailbox = Mailbox::default();
        for i in 0..1000 {
            mailbox.ask(|wishes| wishes.seek_secs = Some(f64::from(i)));
            mailbox.ask(|wishes| wishes.steps += 1);
        }
        let wishes = mailbox.take(None);
        assert_eq!((wishes.seek_secs, wishes.steps), (Some(999.0), 1000));
        assert!(mailbox.take(Some(Duration::ZERO)).is_empty());
    }
}
