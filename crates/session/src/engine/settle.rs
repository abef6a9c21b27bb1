//! Settling the hair at an instant.

use std::sync::Arc;

use lovelock_motion::{FieldPose, Pose};
use lovelock_simulation::StepReport;

use super::preroll::Preroll;
use super::{Engine, JUMP_SECS, body_at};
use crate::snapshot::SnapshotPool;
use crate::stats::StageTimes;
use crate::totals::Totals;

impl Engine {
    /// Moves to the first frame with settled hair.
    pub fn restart(&mut self) {
        self.at_step = 0;
        self.settle();
    }

    /// Settles the hair at the current time by a pre-roll; see [`Engine::preroll`].
    pub fn settle(&mut self) {
        let mut preroll = self.preroll();
        while !preroll.advance() {}
        self.take_settled(preroll);
    }

    /// A pre-roll that simulates the seconds before this instant, from the style at rest. Before the start of a clip that does not
    /// loop smoothly, the body stays in its first pose.
    pub fn preroll(&self) -> Preroll {
        self.preroll_of(self.at_step)
    }

    /// The pre-roll of a later step, up to this instant.
    pub(crate) fn preroll_of(&self, step: i64) -> Preroll {
        Preroll::new(self.copy(), step, self.preroll_secs)
    }

    /// An independent copy.
    pub fn copy(&self) -> Self {
        Self {
            scene: Arc::clone(&self.scene),
            loaded: Arc::clone(&self.loaded),
            styling: self.styling.clone(),
            animation: self.animation.clone(),
            simulation: self.simulation.clone(),
            stepper: self.stepper.copy(),
            combing: None,
            pose: Pose::default(),
            colliders: Vec::new(),
            sheltering: Vec::new(),
            field: FieldPose::default(),
            pool: SnapshotPool::default(),
            ..*self
        }
    }

    /// Takes the hair of a finished pre-roll if it leads to the current instant. Returns whether it was taken.
    pub fn take_settled(&mut self, preroll: Preroll) -> bool {
        let aside = preroll.into_engine();
        if !Arc::ptr_eq(&aside.loaded, &self.loaded) || aside.at_step != self.at_step {
            return false;
        }
        self.jumped_since = true;
        self.combing = None;
        (self.scene, self.styling) = (aside.scene, aside.styling);
        (self.simulation, self.simulated_secs) = (aside.simulation, aside.simulated_secs);
        self.stepper.take_settled(aside.stepper);
        (self.pose, self.colliders, self.field) = (aside.pose, aside.colliders, aside.field);
        self.sheltering = aside.sheltering;
        self.report = aside.report;
        (self.rest_inside, self.rest_is_new) = (aside.rest_inside, aside.rest_is_new);
        self.totals = Totals::default();
        self.times = StageTimes::default();
        true
    }

    /// Marks the start of a recording: the next step follows this instant without a jump.
    pub(crate) fn begin_here(&mut self) {
        self.jumped_since = false;
    }

    /// Resets the hair to its rest style at a step. Before `lead_in_secs` the body has the pose of that time.
    pub(crate) fn reset_to_rest(&mut self, step: i64, lead_in_secs: f64) {
        self.jumped_since = true;
        self.combing = None;
        self.at_step = step;
        self.simulated_secs += JUMP_SECS;
        self.restyle(lead_in_secs);
        self.place_body(lead_in_secs);
        let placed = [&self.colliders[..], &self.sheltering];
        let input = body_at(self.simulated_secs, &self.scene, &self.pose, placed, &self.field);
        self.simulation.reset(&input);
        self.report = StepReport::default();
    }
}
