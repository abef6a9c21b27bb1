//! One instant of a take.

use glam::Affine3A;
use lovelock_groom::{GuideFrame, Guides};

use super::interpolate::mix_guides;

/// One instant of a recorded simulation.
///
/// The pose of the body follows from the clip at `clip_secs`. Lights, camera, look and methods follow from the project at
/// that frame ([`super::TakeReader::project_at`]).
#[derive(Clone, Debug, PartialEq)]
pub struct TakeFrame {
    /// The guides in world space, with the time of the scene (`guides.time_secs`, which keeps increasing when the clip
    /// loops) and `guides.world_from_head`. Times and the transform are stored exactly, positions to within
    /// [`super::MAX_ERROR_M`].
    pub guides: GuideFrame,
    /// The time of the clip for the body's pose, in seconds.
    pub clip_secs: f64,
    /// Number of simulation steps since the engine started.
    pub wall_frame: u64,
    /// Substeps of the simulator for this frame; 0 if the hair was only moved rigidly.
    pub substeps: u32,
    /// Whether the motion jumped to this frame, so that nothing is interpolated between it and the frame before.
    pub jumped: bool,
}

impl TakeFrame {
    /// Sets `self` to the instant at the fraction `t` (0 to 1) from frame `a` to the next frame `b`. See [`mix_guides`] for the
    /// hair. `clip_secs` is the length of the clip, 0 if there is none; the time of the clip may wrap around its end between
    /// the two frames. If the motion jumped between them, or their guides differ in number, the nearer frame is taken as it is.
    pub fn set_between(&mut self, a: &Self, b: &Self, t: f64, clip_secs: f64) {
        let layout = |frame: &Self| (frame.guides.guides.points_per_guide, frame.guides.guides.x.len());
        if b.jumped || layout(a) != layout(b) {
            self.clone_from(if t < 0.5 { a } else { b });
            return;
        }
        self.clone_from(a);
        self.guides.time_secs = a.guides.time_secs + (b.guides.time_secs - a.guides.time_secs) * t;
        self.clip_secs = mix_clip(a.clip_secs, b.clip_secs, t, clip_secs);
        mix_guides(&a.guides, &b.guides, t, &mut self.guides);
    }
}

/// The time of a clip between two frames. After its end the clip starts again.
fn mix_clip(a: f64, b: f64, t: f64, clip_secs: f64) -> f64 {
    if b >= a || clip_secs <= 0.0 {
        return a + (b - a) * t;
    }
    let on = a + (b + clip_secs - a) * t;
    if on < clip_secs { on } else { on - clip_secs }
}

impl Default for TakeFrame {
    fn default() -> Self {
        Self {
            guides: GuideFrame {
                time_secs: 0.0,
                world_from_head: Affine3A::IDENTITY,
                guides: Guides::default(),
            },
            clip_secs: 0.0,
            wall_frame: 0,
            substeps: 0,
            jumped: false,
        }
    }
}
