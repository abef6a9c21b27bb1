//! Detection of clips that repeat without a jump.

use glam::Vec3;

use crate::{Body, Clip, Pose, pose::rotation_of, pose_at};

/// Difference between the last and the first pose of a clip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seam {
    /// Largest distance between the two positions of a joint, metres.
    pub distance: f32,
    /// Largest angle between the two orientations of a joint, radians.
    pub angle: f32,
}

impl Clip {
    /// Largest jump of a joint with which a clip still counts as looping, as a fraction of the body's height:
    /// 2 cm on a person, about the movement of a limb between two frames of a dance.
    const LOOP_DISTANCE: f32 = 0.012;

    /// Measures the jump from the last pose to the first.
    pub fn seam(&self, body: &Body) -> Seam {
        let [start, end] = self.part();
        let unfaded = Self { duration_secs: end - start, loop_blend_secs: 0.0, ..self.clone() };
        let (mut first, mut last) = (Pose::default(), Pose::default());
        pose_at(body, Some(&unfaded), 0.0, &mut first);
        // The end itself would wrap to the start.
        pose_at(body, Some(&unfaded), unfaded.duration_secs.next_down(), &mut last);
        let mut seam = Seam::default();
        for (a, b) in first.world_from_joint.iter().zip(&last.world_from_joint) {
            seam.distance = seam.distance.max(Vec3::from(a.translation - b.translation).length());
            let turn = rotation_of(&b.matrix3) * rotation_of(&a.matrix3).conjugate();
            seam.angle = seam.angle.max(2.0 * turn.w.abs().min(1.0).acos());
        }
        seam
    }

    /// Determines whether the clip repeats without a jump, and sets `loops`.
    pub fn detect_loop(&mut self, body: &Body) {
        let seam = self.seam(body);
        let reach = body.height().max(0.1) * Self::LOOP_DISTANCE;
        // An ankle that turns by 10 degrees about its own axis moves no joint but is visible.
        self.loops = self.duration_secs > 0.0 && seam.distance <= reach && seam.angle <= 10_f32.to_radians();
    }
}
