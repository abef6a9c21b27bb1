//! Pre-roll: settles the hair at any instant by simulating the seconds before it.
//!
//! A pre-roll starts from rest at an earlier instant, a *station*. Stations are [`TimelineSection::preroll_secs`] apart, counted
//! from time zero, and a pre-roll starts at the last one that is at least that long ago. Instants between the same two stations
//! share one pre-roll, so a frame is the same after a seek, after stepping back, and in a recording that starts there.
//!
//! [`TimelineSection::preroll_secs`]: lovelock_project::project::TimelineSection::preroll_secs

use super::Engine;

/// Progress of a pre-roll.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrerollProgress {
    /// Simulated steps.
    pub done: u64,
    /// Total number of steps.
    pub total: u64,
    /// The instant that the pre-roll leads to, seconds on the timeline.
    pub to_secs: f64,
    /// Elapsed time, seconds.
    pub taken_secs: f64,
}

/// A copy of an engine that is simulated from rest at a station to the instant of the engine.
///
/// Created by [`Engine::preroll`] and passed to [`Engine::take_settled`] when done. The owner advances it step by step, or drops
/// it.
#[derive(Debug)]
pub struct Preroll {
    aside: Engine,
    /// First step, and the step that the pre-roll leads to.
    first: i64,
    target: i64,
    /// The earliest time that leads to the instant without a jump, seconds. Before it, the body has the pose of that time.
    lead_in_secs: f64,
}

impl Preroll {
    /// A pre-roll that leads to the current step of the copy `aside`, starting at the station of the step `of`.
    pub(super) fn new(mut aside: Engine, of: i64, preroll_secs: f64) -> Self {
        let target = aside.at_step();
        let first = station_before(of, (preroll_secs / aside.step_secs()).round() as i64).min(target);
        let lead_in_secs = aside.scene().lead_in_secs(aside.time_secs());
        aside.reset_to_rest(first, lead_in_secs);
        Self { aside, first, target, lead_in_secs }
    }

    /// Simulates one step. Returns whether the instant is reached.
    pub fn advance(&mut self) -> bool {
        if self.aside.at_step() < self.target {
            self.aside.step_preroll(self.lead_in_secs);
        }
        self.aside.at_step() >= self.target
    }

    /// Simulated steps, and the total number of steps.
    pub fn steps(&self) -> (u64, u64) {
        let steps = |to: i64| (to - self.first).unsigned_abs();
        (steps(self.aside.at_step()), steps(self.target))
    }

    /// The instant that the pre-roll leads to, seconds on the timeline.
    pub fn to_secs(&self) -> f64 {
        self.aside.scene().position_secs(self.target as f64 * self.aside.step_secs())
    }

    /// The report of the last step.
    #[cfg(test)]
    pub(crate) fn report(&self) -> lovelock_simulation::StepReport {
        self.aside.report()
    }

    pub(super) fn into_engine(self) -> Engine {
        self.aside
    }
}

/// The last station at least `apart` steps before `step`.
fn station_before(step: i64, apart: i64) -> i64 {
    if apart <= 0 { step } else { (step.div_euclid(apart) - 1) * apart }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_preroll_is_at_least_as_long_as_requested_and_less_than_twice() {
        for step in [0, 1, 119, 120, 121, 5000] {
            let lived = step - station_before(step, 120);
            assert!((120..240).contains(&lived), "{step}: {lived}");
        }
        assert_eq!(station_before(0, 120), -120);
        assert_eq!(station_before(119, 120), station_before(0, 120));
        assert_eq!(station_before(77, 0), 77);
    }
}
