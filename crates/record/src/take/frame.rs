//! One instant of a take.

use glam::Affine3A;
use lovelock_groom::{GuideFrame, Guides};

/// One instant of a recorded simulation: all that a picture needs of it.
///
/// The pose of the body follows from the clip at `clip_secs`; lights, camera, look and methods from the project at
/// that frame ([`super::TakeReader::project_at`]).
#[derive(Clone, Debug, PartialEq)]
pub struct TakeFrame {
    /// The guides in world space, with the time of the scene (`guides.time_secs`, which goes on rising where the clip
    /// loops) and `guides.world_from_head`. Times and transform come back bit by bit, positions to within
    /// [`super::MOST_ERROR_M`].
    pub guides: GuideFrame,
    /// The time of the clip that the body's pose was taken at, seconds.
    pub clip_secs: f64,
    /// Steps since the engine started: which step of the simulation this was.
    pub wall_frame: u64,
    /// Substeps that the simulator took for it; 0 where it only moved the hair along.
    pub substeps: u32,
    /// The motion jumped to this frame from the one before: nothing lies between the two.
    pub jumped: bool,
}

impl TakeFrame {
    /// Becomes the instant at the fraction `t` (0 to 1) from `a` to `b`, which follows it, as a take shows it: heads turn, and
    /// hair is mixed as the head sees it and keeps its length. `clip_secs` is the length of the clip, over whose end the time of
    /// the clip may run between the two; 0 where it has none. Of frames between which the motion jumped, or whose guides are
    /// others, it is the nearer one.
    pub fn set_between(&mut self, a: &Self, b: &Self, t: f64, clip_secs: f64) {
        super::interpolate::between(a, b, t, clip_secs, self);
    }
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
