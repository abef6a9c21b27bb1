//! Detection of clips that repeat without a jump.

use glam::{Affine3A, Vec3};

use crate::{Body, Clip, MotionFile, Pose, pose::rotation_of, pose_at};

/// Difference between the last and the first pose of a clip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seam {
    /// Largest distance between the two positions of a joint, metres.
    pub distance: f32,
    /// Largest angle between the two orientations of a joint, radians.
    pub angle: f32,
}

/// Largest jump of a joint with which a clip still counts as looping, as a fraction of the body's height: 2 cm on a person, about the
/// movement of a limb between two frames of a dance.
const LOOP_DISTANCE: f32 = 0.012;

/// An ankle that turns by so many degrees about its own axis moves no joint, but is visible.
const LOOP_DEGREES: f32 = 10.0;

/// A cycle that is stored without the repeated frame: the step from the last pose to the first is at most this many times as long as the
/// one before.
const CYCLE_STEPS: f32 = 1.5;

/// Fewest keys of such a cycle.
const MIN_CYCLE: usize = 8;

impl Seam {
    fn between(first: &[Affine3A], last: &[Affine3A]) -> Self {
        let mut seam = Self::default();
        for (a, b) in first.iter().zip(last) {
            seam.distance = seam.distance.max(Vec3::from(a.translation - b.translation).length());
            let turn = rotation_of(&b.matrix3) * rotation_of(&a.matrix3).conjugate();
            seam.angle = seam.angle.max(2.0 * turn.w.abs().min(1.0).acos());
        }
        seam
    }

    /// Whether it is no jump for a figure of a height, metres.
    fn is_closed(self, height: f32) -> bool {
        self.distance <= height.max(0.1) * LOOP_DISTANCE && self.angle <= LOOP_DEGREES.to_radians()
    }

    /// Whether it is a step like `before`, the one to the last pose.
    pub(crate) fn is_step_like(self, before: Self) -> bool {
        self.distance <= CYCLE_STEPS * before.distance
    }
}

impl Clip {
    /// Measures the jump from the last pose to the first.
    pub fn seam(&self, body: &Body) -> Seam {
        self.seam_from(body, 0.0)
    }

    /// As [`Clip::seam`], from the last pose to the pose `secs` before it.
    pub(crate) fn last_step(&self, body: &Body, secs: f64) -> Seam {
        self.seam_from(body, self.part()[1] - self.part()[0] - secs)
    }

    fn seam_from(&self, body: &Body, from: f64) -> Seam {
        let unfaded = self.clone().played_once();
        let (mut first, mut last) = (Pose::default(), Pose::default());
        pose_at(body, Some(&unfaded), from, &mut first);
        // The end itself would wrap to the start.
        pose_at(body, Some(&unfaded), unfaded.duration_secs.next_down(), &mut last);
        Seam::between(&first.world_from_joint, &last.world_from_joint)
    }

    /// Determines whether the clip repeats without a jump, and sets `loops`.
    pub fn detect_loop(&mut self, body: &Body) {
        self.loops = self.duration_secs > 0.0 && self.seam(body).is_closed(body.height());
    }
}

/// The longest step of a cycle, seconds. Keys further apart were set by hand, and the way from the last to the first is no step.
const LONGEST_STEP_SECS: f64 = 0.11;

impl MotionFile {
    /// Frames of the step that a cycle without its repeated frame leaves out, if the motion may be one.
    pub(crate) fn cycle_step(&self) -> Option<usize> {
        let step = self.frames_per_key();
        let steps = self.frames.saturating_sub(1) / step;
        (steps + 1 >= MIN_CYCLE && step as f64 * self.frame_secs <= LONGEST_STEP_SECS).then_some(step)
    }

    /// Whether the motion repeats without a jump, with or without a last frame that repeats the first.
    pub(crate) fn loops(&self) -> bool {
        let [mut first, mut before, mut last] = [Vec::new(), Vec::new(), Vec::new()];
        self.world(0, &mut first);
        self.world(self.frames.saturating_sub(1), &mut last);
        let seam = Seam::between(&first, &last);
        self.frames > 1 && seam.is_closed(self.height_metres)
            || self.cycle_step().is_some_and(|step| {
                self.world(self.frames.saturating_sub(1 + step), &mut before);
                seam.is_step_like(Seam::between(&before, &last))
            })
    }
}
