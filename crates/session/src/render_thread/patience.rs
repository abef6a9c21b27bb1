//! Which images are given up for newer input, and which show first what has moved.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use lovelock_base::clock::Stopwatch;
use lovelock_render::Interrupt;

/// Weight of the newest image in the usual time.
const NEWEST: f64 = 0.3;
/// Images that usually take longer than this show first what has moved, seconds: quicker ones follow a hand as they are.
const HURRIED_FROM_SECS: f64 = 0.04;
/// The longest time for which images show only what has moved, before a whole one must be finished.
const LONGEST_LATE: Duration = Duration::from_secs(1);

/// What of an image is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Part {
    /// The image, or first what has moved.
    Image,
    /// The whole of an image that shows only what has moved.
    Whole,
    /// A further sample of an image that is shown already.
    Sample,
}

/// Gives up an image for a newer input while it has taken less than a third of the usual time: later, it is finished sooner than another
/// one would be. No two images in a row are given up, so that input which never stops is seen too. What only completes an image that is shown
/// already is given up at any time.
#[derive(Debug)]
pub(super) struct Patience {
    /// See [`HURRIED_FROM_SECS`] and [`LONGEST_LATE`].
    hurried_from_secs: f64,
    longest_late: Duration,
    /// The average time of an image, seconds; 0 before the first.
    usual_secs: f64,
    watch: Option<Stopwatch>,
    /// Since when images show only what has moved.
    late: Option<Stopwatch>,
    /// The input of the last whole image.
    whole_of: Option<u64>,
    /// Whether the image that was begun last has been given up.
    gave_up: Arc<AtomicBool>,
}

impl Default for Patience {
    fn default() -> Self {
        Self::with_limits(HURRIED_FROM_SECS, LONGEST_LATE)
    }
}

impl Patience {
    /// One with other limits than the usual ones.
    pub(super) fn with_limits(hurried_from_secs: f64, longest_late: Duration) -> Self {
        Self {
            hurried_from_secs,
            longest_late,
            usual_secs: 0.0,
            watch: None,
            late: None,
            whole_of: None,
            gave_up: Arc::default(),
        }
    }

    /// Whether the next image, of `input`, may show first what has moved. Hair that moves on after a whole image of the same input is
    /// simulated, and nobody waits for it.
    pub(super) fn hurries(&self, input: u64) -> bool {
        let is_late = self.late.is_some_and(|since| since.elapsed() >= self.longest_late);
        self.usual_secs > self.hurried_from_secs && !is_late && self.whole_of != Some(input)
    }

    /// What ends a part of an image of `input` early, which begins now; `None` if it must be finished. `waiting` returns the input of the
    /// request that waits, if any.
    pub(super) fn interrupt(
        &mut self,
        (input, part): (u64, Part),
        waiting: impl Fn() -> Option<u64> + Send + Sync + 'static,
    ) -> Option<Interrupt> {
        let watch = Stopwatch::start();
        self.watch = Some(watch).filter(|_| part != Part::Sample);
        let after_another = self.gave_up.swap(false, Ordering::Relaxed);
        match part {
            Part::Image => {}
            // Frames of the same input would not be finished sooner.
            Part::Whole => {
                return Some(Interrupt::new(move || waiting().is_some_and(|waiting| waiting != input)));
            }
            Part::Sample => return Some(Interrupt::new(move || waiting().is_some())),
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

    /// Takes the time of the image of `input` that was finished, unless it shows only what has moved.
    pub(super) fn finished(&mut self, input: u64, is_partial: bool) {
        self.gave_up.store(false, Ordering::Relaxed);
        let watch = self.watch.take();
        if is_partial {
            self.late.get_or_insert_with(Stopwatch::start);
            return;
        }
        (self.late, self.whole_of) = (None, Some(input));
        let Some(watch) = watch else { return };
        let secs = watch.secs();
        self.usual_secs =
            if self.usual_secs > 0.0 { self.usual_secs + NEWEST * (secs - self.usual_secs) } else { secs };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whether a part of an image of input 1 is given up while `waiting` waits.
    fn is_due(patience: &mut Patience, part: Part, waiting: Option<u64>) -> bool {
        patience.interrupt((1, part), move || waiting).is_some_and(|interrupt| interrupt.is_due())
    }

    #[test]
    fn an_image_is_given_up_early_for_other_input_and_not_twice_in_a_row() {
        let mut patience = Patience::default();
        assert!(patience.interrupt((1, Part::Image), || Some(2)).is_none(), "the first image");
        patience.finished(1, false);
        patience.usual_secs = 3600.0;
        assert!(!is_due(&mut patience, Part::Image, None), "nothing waits");
        assert!(!is_due(&mut patience, Part::Image, Some(1)), "a frame of the same input waits");
        assert!(is_due(&mut patience, Part::Sample, Some(1)), "a sample");
        assert!(!is_due(&mut patience, Part::Sample, None));
        assert!(is_due(&mut patience, Part::Image, Some(2)));
        assert!(!is_due(&mut patience, Part::Image, Some(2)), "the one after it is finished");
        patience.finished(1, false);
        assert!(is_due(&mut patience, Part::Image, Some(3)), "and the next is not");
        patience.finished(1, false);
        patience.usual_secs = 1e-9;
        assert!(!is_due(&mut patience, Part::Image, Some(2)), "too late");
        // What completes an image is given up at any time, and again and again.
        for _ in 0..2 {
            assert!(is_due(&mut patience, Part::Whole, Some(2)));
        }
        assert!(!is_due(&mut patience, Part::Whole, Some(1)) && !is_due(&mut patience, Part::Whole, None));
    }

    #[test]
    fn slow_images_show_first_what_has_moved_but_not_for_long() {
        let mut patience = Patience::default();
        assert!(!patience.hurries(1), "nothing is known yet");
        patience.usual_secs = 0.9 * HURRIED_FROM_SECS;
        assert!(!patience.hurries(1), "quick images");
        patience.usual_secs = 1.1 * HURRIED_FROM_SECS;
        assert!(patience.hurries(1));
        let usual = patience.usual_secs;
        patience.finished(1, true);
        assert!(patience.hurries(1) && patience.usual_secs == usual, "a part has no usual time");
        patience.longest_late = Duration::ZERO;
        assert!(!patience.hurries(1) && !patience.hurries(2), "too late");
        patience.finished(1, false);
        assert!(!patience.hurries(1) && patience.hurries(2), "after a whole image, for newer input");
    }
}
