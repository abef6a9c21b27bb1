//! Snapshots for rendering: of a step, or interpolated between the last two steps.

use std::sync::Arc;

use lovelock_record::TakeFrame;
use lovelock_render::{PooledBuffer, ResidentGuides};

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
    /// The guides of both steps on the device of the window, if they are there.
    resident: [Option<PooledBuffer>; 2],
}

impl LastSteps {
    /// Whether two steps are stored.
    pub(crate) fn are_known(&self) -> bool {
        self.known
    }

    /// Drops the stored steps, because time or the hair has jumped, or the current instant has been shown.
    pub(crate) fn forget(&mut self) {
        (self.known, self.resident) = (false, [None, None]);
    }

    /// Advances the engine by one step and stores both states.
    pub(crate) fn step(&mut self, engine: &mut Engine) {
        // Read the state again, because the hair may have been settled or replaced since the last step.
        engine.take_frame(&mut self.before);
        let before = engine.resident();
        engine.step();
        engine.take_frame(&mut self.now);
        self.resident = [before, engine.resident()];
        // A jump before the first of the two steps does not matter between them.
        self.now.jumped = engine.report.jumped;
        self.known = true;
    }

    /// Takes the engine's instant for the later of the two, if it is not that already, before it begins the next step.
    pub(crate) fn follow(&mut self, engine: &Engine) {
        if self.known && self.now.wall_frame == engine.taken {
            return;
        }
        if self.known {
            std::mem::swap(&mut self.before, &mut self.now);
            self.resident.swap(0, 1);
        } else {
            engine.take_frame(&mut self.before);
            self.resident[0] = engine.resident();
        }
        engine.take_frame(&mut self.now);
        self.resident[1] = engine.resident();
        self.now.jumped = engine.report.jumped;
        self.known = true;
    }

    /// The guides at the fraction `t` between the two steps on the device of the window.
    fn resident(&self, t: f64) -> Option<ResidentGuides> {
        let heads = [&self.before, &self.now].map(|frame| frame.guides.world_from_head);
        match &self.resident {
            [before, now] if self.now.jumped => {
                if t < 0.5 { before } else { now }.clone().map(ResidentGuides::of_step)
            }
            [Some(before), Some(now)] => {
                Some(ResidentGuides::between([(before, heads[0]), (now, heads[1])], t as f32))
            }
            _ => None,
        }
    }
}

impl Engine {
    /// The current instant for rendering. Resets the measured times.
    pub fn snapshot(&mut self) -> Arc<FrameSnapshot> {
        let resident = self.resident().map(ResidentGuides::of_step);
        self.snapshot_of(None, resident)
    }

    /// The instant at the fraction `t` (0 to 1) between the last two steps, interpolated like frames of a take. Measurements are those
    /// of the last step. If only one step is known, returns that step.
    pub(crate) fn snapshot_between(&mut self, steps: &mut LastSteps, t: f64) -> Arc<FrameSnapshot> {
        if !steps.known {
            return self.snapshot();
        }
        let clip_secs = self.scene.clip.as_ref().map_or(0.0, |clip| clip.duration_secs);
        steps.mixed.set_between(&steps.before, &steps.now, t, clip_secs);
        let resident = steps.resident(t);
        self.snapshot_of(Some((&steps.mixed, t)), resident)
    }

    /// The guides on the device of the window, if they are there.
    fn resident(&self) -> Option<PooledBuffer> {
        self.stepper.guides(&self.simulation)
    }

    /// The current instant, or one between the given frame and it, with its guides on the device of the window.
    fn snapshot_of(
        &mut self,
        between: Option<(&TakeFrame, f64)>,
        resident: Option<ResidentGuides>,
    ) -> Arc<FrameSnapshot> {
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
            frame.resident = resident;
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
