//! Which images are given up for newer input.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use lovelock_base::clock::Stopwatch;
use lovelock_render::Interrupt;

/// Weight of the newest image in the usual time.
const NEWEST: f64 = 0.3;

/// Gives up an image for a newer input while it has taken less than a third of the usual time: later, it is finished sooner than another
/// one would be. No two images in a row are given up, so that input which never stops is seen too. A further sample of an image that
/// is shown already is given up at any time.
#[derive(Debug, Default)]
pub(super) struct Patience {
    /// The average time of an image, seconds; 0 before the first.
    usual_secs: f64,
    watch: Option<Stopwatch>,
    /// Whether the image that was begun last has been given up.
    gave_up: Arc<AtomicBool>,
}

impl Patience {
    /// What ends an image of `input` early, or a further sample of it, which begins now; `None` if it must be finished. `waiting` returns
    /// the input of the request that waits, if any.
    pub(super) fn interrupt(
        &mut self,
        (input, is_sample): (u64, bool),
        waiting: impl Fn() -> Option<u64> + Send + Sync + 'static,
    ) -> Option<Interrupt> {
        let watch = Stopwatch::start();
        self.watch = Some(watch).filter(|_| !is_sample);
        let after_another = self.gave_up.swap(false, Ordering::Relaxed);
        if is_sample {
            return Some(Interrupt::new(move || waiting().is_some()));
        }
        if after_another || self.usual_secs <= 0.0 {
            return None;
        }
        let most = Duration::from_secs_f64(self.usual_secs / 3.0);
        let gave_up = Arc::clone(&self.gave_up);
        Some(Interrupt::new(move || {
            let is_due = gave_up.load(Ordering::Relaxed)
                || watch.elapsed() < most && waiting().is_some_and(|waiting| waiting != input);
            if is_due {
                gave_up.store(true, Ordering::Relaxed);
            }
            is_due
        }))
    }

    /// Takes the time of the image that was finished.
    pub(super) fn finished(&mut self) {
        self.gave_up.store(false, Ordering::Relaxed);
        let Some(watch) = self.watch.take() else { return };
        let secs = watch.secs();
        self.usual_secs =
            if self.usual_secs > 0.0 { self.usual_secs + NEWEST * (secs - self.usual_secs) } else { secs };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_image_is_given_up_early_for_other_input_and_not_twice_in_a_row() {
        let mut patience = Patience::default();
        assert!(patience.interrupt((1, false), || Some(2)).is_none(), "the first image");
        patience.finished();
        patience.usual_secs = 3600.0;
        // Whether an image of input 1 is given up while `waiting` waits.
        let due = |patience: &mut Patience, is_sample: bool, waiting: Option<u64>| {
            patience.interrupt((1, is_sample), move || waiting).is_some_and(|interrupt| interrupt.is_due())
        };
        assert!(!due(&mut patience, false, None), "nothing waits");
        assert!(!due(&mut patience, false, Some(1)), "a frame of the same input waits");
        assert!(due(&mut patience, true, Some(1)) && !due(&mut patience, true, None), "a sample");
        assert!(due(&mut patience, false, Some(2)));
        assert!(!due(&mut patience, false, Some(2)), "the one after it is finished");
        patience.finished();
        assert!(due(&mut patience, false, Some(3)), "and the next is not");
        patience.finished();
        patience.usual_secs = 1e-9;
        assert!(!due(&mut patience, false, Some(2)), "too late");
    }
}
