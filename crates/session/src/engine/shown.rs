//! Instants for drawing: steps as they are, and what lies between the last two.

use std::sync::Arc;

use glam::Affine3A;
use lovelock_groom::GuideFrame;
use lovelock_motion::{Pose, Skin, pose_at, skin};
use lovelock_record::TakeFrame;

use super::Engine;
use crate::clock::Stopwatch;
use crate::snapshot::FrameSnapshot;
use crate::stats::StageTimes;

/// The last two steps of a simulation, and what lies between them. It reads the simulation alone: its states are the same whether
/// this is asked for or not.
#[derive(Debug, Default)]
pub(crate) struct LastSteps {
    before: TakeFrame,
    now: TakeFrame,
    mixed: TakeFrame,
    known: bool,
}

impl LastSteps {
    /// Whether there are two.
    pub(crate) fn are_known(&self) -> bool {
        self.known
    }

    /// Nothing lies before the present instant: time or the hair has jumped to it, or it has been seen.
    pub(crate) fn forget(&mut self) {
        self.known = false;
    }

    /// One step on.
    pub(crate) fn step(&mut self, engine: &mut Engine) {
        // Not what was kept of the step before: the hair may have settled, or be another style, since.
        engine.take_frame(&mut self.before);
        engine.step();
        engine.take_frame(&mut self.now);
        // A jump that led to the instant before does not lie between the two.
        self.now.jumped = engine.report.jumped;
        self.known = true;
    }
}

impl Engine {
    /// The instant as it is, for drawing. Resets the times that it carries.
    pub fn snapshot(&mut self) -> Arc<FrameSnapshot> {
        self.snapshot_of(None)
    }

    /// The instant at the fraction `t` (0 to 1) of the way from the step before the last one to the last one, for drawing: mixed as
    /// between two frames of a take. What was measured is that of the last step. Where only one step is known, it is that one.
    pub(crate) fn snapshot_between(&mut self, steps: &mut LastSteps, t: f64) -> Arc<FrameSnapshot> {
        if !steps.known {
            return self.snapshot();
        }
        let clip_secs = self.scene.clip.as_ref().map_or(0.0, |clip| clip.duration_secs);
        steps.mixed.set_between(&steps.before, &steps.now, t, clip_secs);
        self.snapshot_of(Some((&steps.mixed, t)))
    }

    /// The instant as it is, or one that lies so far on the way to it.
    fn snapshot_of(&mut self, between: Option<(&TakeFrame, f64)>) -> Arc<FrameSnapshot> {
        let watch = Stopwatch::start();
        let ago_secs = between.map_or(0.0, |(_, t)| (1.0 - t) * self.step_secs);
        let combed = self.combing.as_ref().map(|combing| combing.scene(&self.scene, ago_secs));
        let (scene, times) = (combed.as_ref().unwrap_or(&self.scene), &mut self.times);
        let (simulation, own_pose, report, totals) = (&self.simulation, &self.pose, self.report, self.totals);
        let rest_inside = self.rest_inside;
        let own_secs = self.at_step as f64 * self.step_secs;
        let (step, time_secs) = (self.taken, between.map_or(own_secs, |(frame, _)| frame.guides.time_secs));
        let new = || FrameSnapshot {
            scene: Arc::clone(scene),
            step,
            time_secs,
            position_secs: 0.0,
            duration_secs: 0.0,
            pose: Pose::default(),
            skin: Skin::default(),
            guides: GuideFrame {
                time_secs,
                world_from_head: Affine3A::IDENTITY,
                guides: scene.style.guides.clone(),
            },
            report,
            rest_inside,
            totals,
            times: StageTimes::default(),
        };
        self.pool.make(new, |frame| {
            if !Arc::ptr_eq(&frame.scene, scene) {
                frame.scene = Arc::clone(scene);
            }
            (frame.step, frame.time_secs, frame.position_secs) =
                (step, time_secs, scene.position_secs(time_secs));
            frame.duration_secs = scene.duration_secs();
            if let Some((mixed, _)) = between {
                pose_at(&scene.body, scene.clip.as_deref(), mixed.clip_secs, &mut frame.pose);
                frame.guides.clone_from(&mixed.guides);
            } else {
                frame.pose.clone_from(own_pose);
                simulation.frame(&mut frame.guides);
            }
            skin(&scene.body, &frame.pose, &mut frame.skin);
            // The simulator's clock has jumps in it; the frame's is the scene's.
            frame.guides.time_secs = time_secs;
            (frame.report, frame.totals, frame.rest_inside) = (report, totals, rest_inside);
            times.motion += watch.ms();
            frame.times = std::mem::take(times);
        })
    }
}
