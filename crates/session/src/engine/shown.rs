//! Snapshots for rendering: of a step, or interpolated between the last two steps.

use std::sync::Arc;

use lovelock_record::TakeFrame;

use super::Engine;
use crate::snapshot::FrameSnapshot;
use lovelock_base::clock::Stopwatch;

/// The last two steps of a simulation, for interpolation. It only reads the simulation, so it does not affect its state.
#[derive(Debug, Default)]
pub(crate) struct LastSteps {
    before: TakeFrame,
    now: TakeFrame,
    mixed: TakeFrame,
    known: bool,
}

impl LastSteps {
    /// Whether two steps are stored.
    pub(crate) fn are_known(&self) -> bool {
        self.known
    }

    /// Drops the stored steps, because time or the hair has jumped, or the current instant has been shown.
    pub(crate) fn forget(&mut self) {
        self.known = false;
    }

    /// Advances the engine by one step and stores both states.
    pub(crate) fn step(&mut self, engine: &mut Engine) {
        // Read the state again, because the hair may have been settled or replaced since the last step.
        engine.take_frame(&mut self.before);
        engine.step();
        engine.take_frame(&mut self.now);
        // A jump before the first of the two steps does not matter between them.
        self.now.jumped = engine.report.jumped;
        self.known = true;
    }
}

impl Engine {
    /// The current instant for rendering. Resets the measured times.
    pub fn snapshot(&mut self) -> Arc<FrameSnapshot> {
        self.snapshot_of(None)
    }

    /// The instant at the fraction `t` (0 to 1) between the last two steps, interpolated like frames of a take. Measurements are those
    /// of the last step. If only one step is known, returns that step.
    pub(crate) fn snapshot_between(&mut self, steps: &mut LastSteps, t: f64) -> Arc<FrameSnapshot> {
        if !steps.known {
            return self.snapshot();
        }
        let clip_secs = self.scene.clip.as_ref().map_or(0.0, |clip| clip.duration_secs);
        steps.mixed.set_between(&steps.before, &steps.now, t, clip_secs);
        self.snapshot_of(Some((&steps.mixed, t)))
    }

    /// The current instant, or one between the given frame and it.
    fn snapshot_of(&mut self, between: Option<(&TakeFrame, f64)>) -> Arc<FrameSnapshot> {
        let watch = Stopwatch::start();
        let ago_secs = between.map_or(0.0, |(_, t)| (1.0 - t) * self.step_secs);
        let combed = self.combing.as_ref().map(|combing| combing.scene(&self.scene, ago_secs));
        let (scene, times) = (combed.as_ref().unwrap_or(&self.scene), &mut self.times);
        let (simulation, own_pose, report, totals) = (&self.simulation, &self.pose, self.report, self.totals);
        let rest_inside = self.rest_inside;
        let (on_device, refusal) = self.stepper.state();
        let refusal = refusal.cloned();
        let own_secs = self.at_step as f64 * self.step_secs;
        let (step, time_secs) = (self.taken, between.map_or(own_secs, |(frame, _)| frame.guides.time_secs));
        self.pool.make(scene, |frame| {
            (frame.step, frame.time_secs, frame.position_secs) =
                (step, time_secs, scene.position_secs(time_secs));
            frame.duration_secs = scene.duration_secs();
            if let Some((mixed, _)) = between {
                scene.pose_at(mixed.clip_secs, &mut frame.pose);
                frame.guides.clone_from(&mixed.guides);
            } else {
                frame.pose.clone_from(own_pose);
                simulation.frame(&mut frame.guides);
            }
            frame.follow_pose();
            // The simulator's clock contains jumps; frames use the time of the scene.
            frame.guides.time_secs = time_secs;
            (frame.report, frame.totals, frame.rest_inside) = (report, totals, rest_inside);
            (frame.on_device, frame.device_refusal) = (on_device, refusal);
            times.motion += watch.ms();
            frame.times = std::mem::take(times);
        })
    }
}
