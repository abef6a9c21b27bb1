//! Hair that is settled wherever the dance is begun: it lives through the seconds before, aside.
//!
//! The hair of an instant that is gone to comes from rest at an earlier one, a *station*, and has lived through the motion
//! since. Stations lie [`TimelineSection::preroll_secs`] apart, counted from time zero, and hair lives from the last one that is
//! at least that long ago. Instants between two stations therefore have hair of one and the same life: a frame is the same
//! whether it was gone to, stepped back to, or recorded from there.
//!
//! [`TimelineSection::preroll_secs`]: lovelock_project::project::TimelineSection::preroll_secs

use super::Engine;

/// How far the hair of an instant is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrerollProgress {
    /// Steps lived through.
    pub done: u64,
    /// Steps in all.
    pub total: u64,
    /// The instant that they lead to, seconds on the timeline.
    pub to_secs: f64,
    /// How long it has taken until now, seconds.
    pub taken_secs: f64,
}

/// A copy of an engine on its way from rest at a station to the instant where the engine is.
///
/// Made by [`Engine::preroll`] and handed back to [`Engine::take_settled`]; whoever holds it takes as many steps at a time as
/// there is time for, or lets it go.
#[derive(Debug)]
pub struct Preroll {
    aside: Engine,
    /// The step where its life began, and the one that it leads to.
    first: i64,
    target: i64,
    /// The earliest time that leads to the instant without a jump, seconds: before it the body stands as it does then.
    lead_in_secs: f64,
}

impl Preroll {
    /// Of an engine that stands where the life shall lead; the station is that of the step `of`.
    pub(super) fn new(mut aside: Engine, of: i64, preroll_secs: f64) -> Self {
        let target = aside.at_step();
        let first = station_before(of, (preroll_secs / aside.step_secs()).round() as i64).min(target);
        let lead_in_secs = aside.scene().lead_in_secs(aside.time_secs());
        aside.lay_at_rest(first, lead_in_secs);
        Self { aside, first, target, lead_in_secs }
    }

    /// Lives through one step more; returns whether the instant is reached.
    pub fn advance(&mut self) -> bool {
        if self.aside.at_step() < self.target {
            self.aside.live_step(self.lead_in_secs);
        }
        self.aside.at_step() >= self.target
    }

    /// Steps lived through, and steps in all.
    pub fn steps(&self) -> (u64, u64) {
        let steps = |to: i64| (to - self.first).unsigned_abs();
        (steps(self.aside.at_step()), steps(self.target))
    }

    /// The instant that it leads to, seconds on the timeline.
    pub fn to_secs(&self) -> f64 {
        self.aside.scene().position_secs(self.target as f64 * self.aside.step_secs())
    }

    /// What the last step had to say.
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
    fn hair_lives_at_least_as_long_as_was_asked_for_and_less_than_twice() {
        for step in [0, 1, 119, 120, 121, 5000] {
            let lived = step - station_before(step, 120);
            assert!((120..240).contains(&lived), "{step}: {lived}");
        }
        assert_eq!(station_before(0, 120), -120);
        assert_eq!(station_before(119, 120), station_before(0, 120));
        assert_eq!(station_before(77, 0), 77);
    }
}
