//! Runs work on a thread whose waiter can cancel.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::time::Duration;

use lovelock_base::watch::Watch;
use lovelock_project::error::ProjectError;

/// How often the wait looks whether the work was cancelled.
const TICK: Duration = Duration::from_millis(20);

/// Does `work` on another thread and calls `tick` with the part of it that is done, 0 to 1, many times a second.
///
/// Libraries that read files cannot be stopped everywhere. When the work is cancelled this returns at once; the thread ends at the
/// next report to its [`Watch`], or when it is done, and its result is dropped.
///
/// # Errors
/// [`ProjectError::Cancelled`] if `cancelled` is set, and an error of the system if it cannot create a thread.
pub(crate) fn aside<T: Send + 'static>(
    cancelled: &AtomicBool,
    tick: &mut dyn FnMut(f32),
    work: impl FnOnce(&Watch) -> T + Send + 'static,
) -> Result<T, ProjectError> {
    let (watch, (sender, result)) = (Watch::default(), sync_channel(1));
    let inside = watch.clone();
    let thread = std::thread::Builder::new()
        .name("lovelock reader".to_owned())
        .spawn(move || {
            // Nobody may be waiting any more.
            let _ = sender.send(work(&inside));
        })
        .map_err(|error| ProjectError::work(format!("could not start a thread to read: {error}")))?;
    loop {
        match result.recv_timeout(TICK) {
            Ok(result) => return Ok(result),
            Err(RecvTimeoutError::Timeout) => tick(watch.done()),
            Err(RecvTimeoutError::Disconnected) => match thread.join() {
                Err(panic) => resume_unwind(panic),
                Ok(()) => return Err(ProjectError::work("the thread that reads ended without a result")),
            },
        }
        if cancelled.load(Ordering::Relaxed) {
            watch.cancel();
            return Err(ProjectError::Cancelled);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    #[test]
    fn work_that_hangs_is_left_at_once_and_other_work_is_waited_for() {
        let (seen, half_seen) = sync_channel(1);
        let mut tick = |part| {
            if part == 0.5 {
                let _ = seen.try_send(());
            }
        };
        let done = aside(&AtomicBool::new(false), &mut tick, move |watch| {
            watch.at(0.5).expect("not cancelled");
            half_seen.recv().expect("the part that is done is told meanwhile");
            7
        });
        assert!(matches!(done, Ok(7)));

        let cancelled = Arc::new(AtomicBool::new(false));
        let (release, held) = sync_channel::<()>(1);
        let (report, ended) = sync_channel(1);
        let flag = Arc::clone(&cancelled);
        let left = aside(&cancelled, &mut |_| flag.store(true, Ordering::Relaxed), move |watch| {
            // As a library that reads for long without a report: until the wait for it is over.
            let _ = held.recv();
            let _ = report.send(watch.at(0.9));
        });
        assert!(matches!(left, Err(ProjectError::Cancelled)));
        drop(release);
        assert!(ended.recv().expect("an end").is_err(), "the work is told to stop");
    }

    #[test]
    fn a_panic_of_the_work_is_one_of_the_caller() {
        let caught = std::panic::catch_unwind(|| {
            aside(&AtomicBool::new(false), &mut |_| {}, |_| panic!("a broken reader"))
        });
        assert!(caught.is_err());
    }
}
