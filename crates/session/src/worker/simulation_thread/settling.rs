//! Hair that settles aside on the simulation thread, a slice at a time, while time waits for it.

use std::sync::PoisonError;
use std::time::Duration;

use lovelock_project::Project;
use lovelock_project::animation::Animation;

use super::Inside;
use crate::clock::Stopwatch;
use crate::engine::{Preroll, PrerollProgress};
use crate::totals::Totals;

/// How long the life before an instant goes on before wishes are looked at again, milliseconds.
const SLICE_MS: f64 = 8.0;

/// How long settings are to be left alone before hair that stands still settles by them, seconds: a slider that is dragged
/// changes them at every frame.
const CALM_SECS: f64 = 0.15;

/// Whether hair has another life by the settings of `b` than by those of `a`.
pub(super) fn lives_otherwise(a: &Project, b: &Project) -> bool {
    a.simulation != b.simulation
        || a.timeline.preroll_secs.to_bits() != b.timeline.preroll_secs.to_bits()
        || Animation::of(a) != Animation::of(b)
}

/// A life on its way.
pub(super) struct Aside {
    preroll: Box<Preroll>,
    since: Stopwatch,
    /// Steps to go on once it has arrived.
    pub(super) steps: u32,
    /// What was measured before, where it is kept.
    pub(super) measured: Option<Totals>,
}

impl Inside {
    /// Begins the life before the instant where the engine stands, in place of another that is under way.
    pub(super) fn begin_preroll(&mut self) {
        self.owes_settling = false;
        self.preroll = self.engine.as_ref().map(|engine| Aside {
            preroll: Box::new(engine.preroll()),
            since: Stopwatch::start(),
            steps: 0,
            measured: None,
        });
    }

    /// A slice of the life aside. Before it is over the hair is seen as it was carried here.
    pub(super) fn live_aside(&mut self, changed: bool) {
        if changed {
            self.show();
        }
        let slice = Stopwatch::start();
        while let Some(aside) = &mut self.preroll {
            if aside.preroll.advance() {
                self.arrive();
                self.show();
            } else if slice.ms() > SLICE_MS {
                break;
            }
        }
    }

    /// Takes over the hair that has arrived, and goes on as was asked for meanwhile.
    pub(super) fn arrive(&mut self) {
        let (Some(aside), Some(engine)) = (self.preroll.take(), &mut self.engine) else { return };
        engine.take_settled(*aside.preroll);
        if let Some(measured) = aside.measured {
            engine.set_totals(&measured);
        }
        // The time that it took is not to be caught up with.
        self.playback.set_playing(self.playback.is_playing());
        for _ in 0..aside.steps {
            self.step();
        }
    }

    /// Lives through what is left of it at once: where hair is about to be written down.
    pub(super) fn finish_preroll(&mut self) {
        if self.owes_settling {
            self.begin_preroll();
        }
        while self.preroll.as_mut().is_some_and(|aside| !aside.preroll.advance()) {}
        if self.preroll.is_some() {
            self.arrive();
            self.show();
        }
    }

    /// Hair that has been loaded settles once no newer one is on its way: what is dragged asks for another one at every frame.
    pub(super) fn settle_loaded(&mut self) {
        self.preroll = None;
        self.owes_settling = true;
    }

    /// Hair that stands still settles by other settings once they are left alone; hair that moves lives on by them.
    pub(super) fn settle_when_calm(&mut self) {
        if self.owes_settling && !self.loader.is_busy() {
            self.begin_preroll();
        }
        if self.playback.is_playing() || self.take.is_some() || self.preroll.is_some() {
            self.unsettled = None;
        } else if self.unsettled.as_ref().is_some_and(|since| since.secs() >= CALM_SECS) {
            self.unsettled = None;
            self.begin_preroll();
        }
    }

    /// `timeout`, or how long it is until then, where that is less.
    pub(super) fn until_calm(&self, timeout: Option<Duration>) -> Option<Duration> {
        let left = match &self.unsettled {
            Some(since) => Duration::from_secs_f64((CALM_SECS - since.secs()).max(0.0)),
            // A load that fails or is given up sends nothing.
            None if self.owes_settling => Duration::from_secs_f64(CALM_SECS),
            None => return timeout,
        };
        Some(timeout.map_or(left, |timeout| timeout.min(left)))
    }

    /// The same anew, where one is under way: it is a life of the settings as they are now.
    pub(super) fn begin_preroll_anew(&mut self) {
        if let Some(Aside { steps, .. }) = self.preroll.take() {
            self.begin_preroll();
            if let Some(aside) = &mut self.preroll {
                aside.steps = steps;
            }
        }
    }

    pub(super) fn tell_settling(&mut self) {
        let progress = self.preroll.as_ref().map(|aside| {
            let (done, total) = aside.preroll.steps();
            let (to_secs, taken_secs) = (aside.preroll.to_secs(), aside.since.secs());
            PrerollProgress { done, total, to_secs, taken_secs }
        });
        let to_come = self.engine.as_ref().filter(|_| self.owes_settling).map(|engine| {
            let to_secs = engine.position_secs();
            PrerollProgress { done: 0, total: 1, to_secs, taken_secs: 0.0 }
        });
        let progress = progress.or(to_come);
        let mut told = self.settling.lock().unwrap_or_else(PoisonError::into_inner);
        if progress.is_some() || told.is_some() {
            *told = progress;
            self.outbox.wake();
        }
    }
}
