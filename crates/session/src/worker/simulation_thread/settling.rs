//! Settling on the simulation thread: pre-rolls in time slices, while playback waits.

use std::sync::PoisonError;
use std::time::Duration;

use lovelock_base::clock::Stopwatch;
use lovelock_project::Project;
use lovelock_project::animation::{Animation, StyleTracks};

use super::SimulationThread;
use crate::engine::{Preroll, PrerollProgress};
use crate::totals::Totals;

/// Length of a time slice of a pre-roll between two checks for requests, milliseconds.
const SLICE_MS: f64 = 8.0;

/// Time without changes of settings after which paused hair settles, seconds. A dragged slider changes them at every frame.
const CALM_SECS: f64 = 0.15;

/// Whether a pre-roll with the settings of `b` differs from one with those of `a`.
pub(super) fn preroll_differs(a: &Project, b: &Project) -> bool {
    a.simulation != b.simulation
        || a.timeline.preroll_secs.to_bits() != b.timeline.preroll_secs.to_bits()
        || Animation::of(a) != Animation::of(b)
        || StyleTracks::of(a) != StyleTracks::of(b)
}

/// A pre-roll in progress.
pub(super) struct PendingPreroll {
    preroll: Box<Preroll>,
    since: Stopwatch,
    /// Steps to simulate after the pre-roll.
    pub(super) steps: u32,
    /// Earlier totals, if they are kept.
    pub(super) measured: Option<Totals>,
}

impl SimulationThread {
    /// Starts a pre-roll that leads to the engine's instant, and replaces a running one.
    pub(super) fn begin_preroll(&mut self) {
        self.settling_pending = false;
        if self.still {
            if let Some(engine) = &mut self.engine {
                engine.lay_at_rest();
            }
            return;
        }
        self.preroll = self.engine.as_ref().map(|engine| PendingPreroll {
            preroll: Box::new(engine.preroll()),
            since: Stopwatch::start(),
            steps: 0,
            measured: None,
        });
    }

    /// Simulates one time slice of the pre-roll. Until it is done, the hair is shown as it was moved rigidly.
    pub(super) fn advance_preroll(&mut self, changed: bool) {
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

    /// Takes the hair of the finished pre-roll and the steps requested meanwhile.
    pub(super) fn arrive(&mut self) {
        let (Some(aside), Some(engine)) = (self.preroll.take(), &mut self.engine) else { return };
        engine.take_settled(*aside.preroll);
        if let Some(measured) = aside.measured {
            engine.set_totals(&measured);
        }
        // Do not catch up with the time that the pre-roll took.
        self.playback.set_playing(self.playback.is_playing());
        for _ in 0..aside.steps {
            self.step();
        }
    }

    /// Completes the pre-roll at once, because the hair is about to be recorded.
    pub(super) fn finish_preroll(&mut self) {
        if self.settling_pending {
            self.begin_preroll();
        }
        while self.preroll.as_mut().is_some_and(|aside| !aside.preroll.advance()) {}
        if self.preroll.is_some() {
            self.arrive();
            self.show();
        }
    }

    /// Starts settling of loaded hair when no newer hair is being loaded. A dragged control requests new hair at every frame.
    pub(super) fn settle_loaded(&mut self) {
        self.preroll = None;
        self.settling_pending = true;
    }

    /// Restarts the hair settling after settings have changed while playback is paused. During playback the simulation continues
    /// with the new settings.
    pub(super) fn settle_when_calm(&mut self) {
        if self.settling_pending && !self.shared.loader.is_busy() {
            self.begin_preroll();
        }
        if self.playback.is_playing() || self.take.is_some() || self.preroll.is_some() {
            self.settings_changed = None;
        } else if self.settings_changed.as_ref().is_some_and(|since| since.secs() >= CALM_SECS) {
            self.settings_changed = None;
            self.begin_preroll();
        }
    }

    /// `timeout`, or the time until settling starts if that is less.
    pub(super) fn until_calm(&self, timeout: Option<Duration>) -> Option<Duration> {
        let left = match &self.settings_changed {
            Some(since) => Duration::from_secs_f64((CALM_SECS - since.secs()).max(0.0)),
            // A failed or cancelled load sends nothing, so check again soon.
            None if self.settling_pending => Duration::from_secs_f64(CALM_SECS),
            None => return timeout,
        };
        Some(timeout.map_or(left, |timeout| timeout.min(left)))
    }

    /// Restarts a running pre-roll with the current settings.
    pub(super) fn restart_preroll(&mut self) {
        if let Some(PendingPreroll { steps, .. }) = self.preroll.take() {
            self.begin_preroll();
            if let Some(aside) = &mut self.preroll {
                aside.steps = steps;
            }
        }
    }

    pub(super) fn publish_settling(&mut self) {
        let progress = self.preroll.as_ref().map(|aside| {
            let (done, total) = aside.preroll.steps();
            let (to_secs, taken_secs) = (aside.preroll.to_secs(), aside.since.secs());
            PrerollProgress { done, total, to_secs, taken_secs }
        });
        let to_come = self.engine.as_ref().filter(|_| self.settling_pending).map(|engine| {
            let to_secs = engine.position_secs();
            PrerollProgress { done: 0, total: 1, to_secs, taken_secs: 0.0 }
        });
        let progress = progress.or(to_come);
        let mut told = self.shared.settling.lock().unwrap_or_else(PoisonError::into_inner);
        if progress.is_some() || told.is_some() {
            *told = progress;
            self.outbox.wake();
        }
    }
}
