//! Hair that is given the shape that it has at an instant.

use std::sync::Arc;

use lovelock_motion::{FieldPose, Pose};
use lovelock_simulation::StepReport;

use super::preroll::Preroll;
use super::{Engine, JUMP_SECS, body_at};
use crate::snapshot::SnapshotPool;
use crate::stats::StageTimes;
use crate::totals::Totals;

impl Engine {
    /// Back to the first frame, the hair settled.
    pub fn restart(&mut self) {
        self.at_step = 0;
        self.settle();
    }

    /// Gives the hair the shape that it has at this time: see [`Engine::preroll`].
    pub fn settle(&mut self) {
        let mut preroll = self.preroll();
        while !preroll.advance() {}
        self.take_settled(preroll);
    }

    /// A copy that lives through the seconds before this instant, from the style at rest. A motion that cannot be reached
    /// from before (the start of a clip that does not loop, or whose end does not go over into its start) is waited for in
    /// its first pose.
    pub fn preroll(&self) -> Preroll {
        self.preroll_of(self.at_step)
    }

    /// The life of the hair of a later step, as far as this instant.
    pub(crate) fn preroll_of(&self, step: i64) -> Preroll {
        Preroll::new(self.beside(), step, self.preroll_secs)
    }

    /// A copy that lives on by itself.
    pub fn beside(&self) -> Self {
        Self {
            scene: Arc::clone(&self.scene),
            animation: self.animation.clone(),
            simulation: self.simulation.clone(),
            combing: None,
            pose: Pose::default(),
            colliders: Vec::new(),
            sheltering: Vec::new(),
            field: FieldPose::default(),
            pool: SnapshotPool::default(),
            ..*self
        }
    }

    /// Takes the hair of a copy that has arrived where this engine still is; returns whether it was taken.
    pub fn take_settled(&mut self, preroll: Preroll) -> bool {
        let aside = preroll.into_engine();
        if !Arc::ptr_eq(&aside.scene, &self.scene) || aside.at_step != self.at_step {
            return false;
        }
        self.jumped_since = true;
        self.combing = None;
        (self.simulation, self.simulated_secs) = (aside.simulation, aside.simulated_secs);
        (self.pose, self.colliders, self.field) = (aside.pose, aside.colliders, aside.field);
        self.sheltering = aside.sheltering;
        self.report = aside.report;
        (self.rest_inside, self.rest_is_new) = (aside.rest_inside, aside.rest_is_new);
        self.totals = Totals::default();
        self.times = StageTimes::default();
        true
    }

    /// What is recorded begins here: the next step follows this instant without a jump.
    pub(crate) fn begin_here(&mut self) {
        self.jumped_since = false;
    }

    /// Puts the hair into its style at a step. Before `lead_in_secs` the body stands as it does then.
    pub(crate) fn lay_at_rest(&mut self, step: i64, lead_in_secs: f64) {
        self.jumped_since = true;
        self.combing = None;
        self.at_step = step;
        self.simulated_secs += JUMP_SECS;
        self.place_body(lead_in_secs);
        let placed = [&self.colliders[..], &self.sheltering];
        let input = body_at(self.simulated_secs, &self.scene, &self.pose, placed, &self.field);
        self.simulation.reset(&input);
        self.report = StepReport::default();
    }
}
