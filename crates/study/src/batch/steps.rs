//! The steps of a comparison, with an estimate of the time that is left.

use std::collections::VecDeque;

use lovelock_base::clock::Stopwatch;

/// A kind of step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    /// The ground truth for the map of one entrant; those of equal maps take no time.
    Truth,
    /// The ground truth at points.
    Points,
    /// The reference images.
    Picture,
    /// The ground truth of all frames.
    Film,
    /// The ground truth under a turning light.
    LightSweep,
    /// The probes' rays.
    Probes,
    /// All measurements of one entrant.
    Entrant,
    /// The films of all entrants.
    Sequence,
}

impl Step {
    /// The usual time, as a multiple of that of [`Step::Truth`]: until a step of the kind was measured.
    fn weight(self) -> f64 {
        match self {
            Self::Points | Self::Probes => 0.5,
            Self::Truth => 1.0,
            Self::Picture => 2.0,
            Self::Film | Self::LightSweep | Self::Entrant => 4.0,
            Self::Sequence => 20.0,
        }
    }
}

/// The steps of a run.
pub(super) struct Steps {
    /// Finished ones, with the seconds that they took.
    done: Vec<(Step, f64)>,
    now: Option<(Step, Stopwatch)>,
    ahead: VecDeque<Step>,
}

impl Steps {
    /// Nothing has begun.
    pub(super) fn new(steps: impl IntoIterator<Item = Step>) -> Self {
        Self { done: Vec::new(), now: None, ahead: steps.into_iter().collect() }
    }

    /// Ends the step that runs and begins the next one.
    pub(super) fn begin(&mut self) {
        self.done.extend(self.now.take().map(|(step, since)| (step, since.secs())));
        self.now = self.ahead.pop_front().map(|step| (step, Stopwatch::start()));
    }

    /// The numbers of finished steps and of all steps.
    pub(super) fn count(&self) -> [u64; 2] {
        let all = self.done.len() + usize::from(self.now.is_some()) + self.ahead.len();
        [self.done.len(), all].map(|count| count as u64)
    }

    /// Estimated seconds until the end; `None` before the first step is finished.
    pub(super) fn left_secs(&self) -> Option<f64> {
        let now = self.now.as_ref().map(|(step, since)| (*step, since.secs()));
        left(&self.done, now, self.ahead.iter().copied())
    }
}

/// The time left: that of steps of the same kind, or if there are none, their weight at the pace so far.
fn left(done: &[(Step, f64)], now: Option<(Step, f64)>, ahead: impl Iterator<Item = Step>) -> Option<f64> {
    let sum = |of: &mut dyn Iterator<Item = f64>| of.fold(0.0, |sum, value| sum + value);
    let weight = sum(&mut done.iter().map(|(step, _)| step.weight()));
    if weight <= 0.0 {
        return None;
    }
    let pace = sum(&mut done.iter().map(|(_, secs)| *secs)) / weight;
    let expected = |step: Step| {
        let same = || done.iter().filter(|(of, _)| *of == step).map(|(_, secs)| *secs);
        let count = same().count();
        if count > 0 { sum(&mut same()) / count as f64 } else { step.weight() * pace }
    };
    let rest = now.map_or(0.0, |(step, secs)| (expected(step) - secs).max(0.0));
    Some(rest + sum(&mut ahead.map(expected)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_comes_from_the_steps_that_were_measured() {
        use Step::{Entrant, Points, Truth};
        assert_eq!(left(&[], Some((Truth, 3.0)), [Entrant].into_iter()), None, "nothing is known");
        // By weight: a truth took 2 s, so an entrant takes 8.
        assert_eq!(left(&[(Truth, 2.0)], None, [Entrant; 3].into_iter()), Some(24.0));
        // By its kind, once one was measured.
        let done = [(Truth, 2.0), (Entrant, 10.0), (Entrant, 14.0)];
        assert_eq!(left(&done, Some((Entrant, 2.0)), [Entrant; 2].into_iter()), Some(10.0 + 24.0));
        assert_eq!(left(&done, Some((Entrant, 50.0)), [].into_iter()), Some(0.0), "longer than expected");
        assert_eq!(left(&[(Truth, 0.0)], None, [Points].into_iter()), Some(0.0));
    }

    #[test]
    fn finished_steps_are_counted() {
        let mut steps = Steps::new([Step::Truth, Step::Entrant]);
        let mut counts = vec![steps.count()];
        for _ in 0..3 {
            steps.begin();
            counts.push(steps.count());
        }
        assert_eq!(counts, [[0, 2], [0, 2], [1, 2], [2, 2]]);
        assert_eq!(steps.left_secs(), Some(0.0));
    }
}
