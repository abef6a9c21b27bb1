//! Playback on the simulation thread.

use super::super::Event;
use super::SimulationThread;
use crate::engine::Engine;

impl SimulationThread {
    pub(super) fn step(&mut self) {
        if self.still {
            self.step_at_rest();
            return;
        }
        if let Some(engine) = &mut self.engine {
            if self.playback.shows_between() {
                self.last_steps.step(engine);
            } else {
                self.last_steps.forget();
                engine.step();
            }
            self.record_step();
        }
    }

    /// Waits for a step that was begun in the last turn, which the device has usually done by now. Returns whether there was one.
    pub(super) fn finish_begun_step(&mut self) -> bool {
        let finished = self.engine.as_mut().is_some_and(Engine::finish_step);
        if finished {
            self.record_step();
        }
        finished
    }

    /// Shows the hair as it is and begins the next step, which a device does meanwhile. Images are a step behind then.
    fn go_ahead(&mut self, between: Option<f64>) {
        let Some(engine) = &mut self.engine else { return };
        match between {
            Some(t) => {
                self.last_steps.follow(engine);
                self.show_between(t);
            }
            None => self.show(),
        }
        if let Some(engine) = &mut self.engine {
            engine.begin_step();
        }
    }

    /// A step of the body alone. There is none while the hair is brushed.
    fn step_at_rest(&mut self) {
        if let Some(engine) = &mut self.engine
            && !self.brushing.is_open()
        {
            self.last_steps.forget();
            engine.step_at_rest();
            self.record_step();
        }
    }

    /// Switches the simulation off or on. Returns whether the hair has changed.
    pub(super) fn set_still(&mut self, still: Option<bool>) -> bool {
        let Some(still) = still.filter(|still| *still != self.still) else { return false };
        self.still = still;
        let Some(engine) = &mut self.engine else { return false };
        if still {
            (self.preroll, self.settling_pending) = (None, false);
            engine.lay_at_rest();
        } else {
            self.begin_preroll();
        }
        true
    }

    /// Shows the last step. The next image continues from it.
    pub(super) fn show(&mut self) {
        if let Some(engine) = &mut self.engine {
            self.last_steps.forget();
            self.playback.begin();
            self.shared.frames.put(engine.snapshot());
            self.outbox.wake();
        }
    }

    /// Shows an instant between the last two steps.
    pub(super) fn show_between(&mut self, t: f64) {
        if let Some(engine) = &mut self.engine {
            self.shared.frames.put(engine.snapshot_between(&mut self.last_steps, t));
            self.outbox.wake();
        }
    }

    /// Advances the hair. `finished` says that a step that was begun before is done.
    pub(super) fn simulate(&mut self, mut changed: bool, finished: bool, elapsed_secs: f64) {
        if changed {
            // After a seek or a change of style, the previous step does not lead to the current one.
            self.last_steps.forget();
            self.playback.begin();
        }
        let due = self.playback.advance(elapsed_secs);
        // It is shown at once, unless images lie between steps.
        changed |= finished && !(self.playback.is_playing() && self.playback.shows_between());
        for left in (0..due.steps).rev() {
            let Some(engine) = &self.engine else { return };
            if engine.is_at_end() {
                self.playback.set_playing(false);
                self.last_steps.forget();
                self.outbox.send(Event::EndReached);
                changed = true;
                break;
            }
            if left == 0 && !self.still && engine.goes_ahead() {
                self.go_ahead(due.between);
                return;
            }
            self.step();
            changed |= due.between.is_none();
        }
        match due.between {
            Some(t) if self.last_steps.are_known() => self.show_between(t),
            _ if changed => self.show(),
            _ => {}
        }
    }

    /// Advances a take by the elapsed time, not by whole frames, so that it is smooth at any rate.
    pub(super) fn play(&mut self, mut changed: bool, elapsed_secs: f64) {
        let Some(take) = &mut self.take else { return };
        if self.playback.is_playing() && elapsed_secs.is_finite() {
            let direction = if self.backwards { -1.0 } else { 1.0 };
            let ended = take.advance(elapsed_secs.clamp(0.0, 0.25) * self.playback.rate() * direction);
            changed = true;
            if ended {
                self.playback.set_playing(false);
                self.outbox.send(Event::EndReached);
            }
        }
        if changed {
            match take.snapshot() {
                Ok(snapshot) => {
                    self.shared.frames.put(snapshot);
                    self.outbox.wake();
                    for message in take.notices() {
                        self.outbox.send(Event::TakeUnreadable { message });
                    }
                }
                Err(error) => {
                    // Report it once, not for every damaged frame.
                    self.playback.set_playing(false);
                    self.outbox.send(Event::TakeUnreadable { message: error.to_string() });
                }
            }
        }
    }
}
