//! What is simulated and drawn: a body, its motion and its hair.

mod camera;
mod dancer;
mod head_path;
mod loader;
mod parts;

pub use camera::{camera_at, frame_points};
pub use dancer::dancer;
pub use head_path::HeadPath;
pub use loader::{LoadControl, SceneLoader};

use std::sync::Arc;

use glam::Vec3;
use lovelock_groom::{Hairstyle, Obstacle};
use lovelock_motion::{Body, BodyField, Clip, Collider, RestDistance};
use lovelock_simulation::BodyPart;

/// The resting body as what hair is combed around.
#[derive(Debug)]
pub struct BodyObstacle(pub RestDistance);

impl Obstacle for BodyObstacle {
    fn distance(&self, p: Vec3) -> (f32, Vec3) {
        self.0.distance(p)
    }
}

/// A body, its motion and its hair: immutable, its large parts shared with the scenes before and after.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The body.
    pub body: Arc<Body>,
    /// The body's own clips.
    pub clips: Arc<[Arc<Clip>]>,
    /// The clip that plays; the body rests where there is none.
    pub clip: Option<Arc<Clip>>,
    /// Tempo: clip seconds a second.
    pub speed: f64,
    /// Whether the clip starts again at its end.
    pub looping: bool,
    /// What hair collides with, beside the field.
    pub colliders: Arc<[Collider]>,
    /// The shapes that the field stands for, which keep the wind off.
    pub sheltering: Arc<[Collider]>,
    /// All shapes that were fitted to the body, as they were.
    pub fitted: Arc<[Collider]>,
    /// The skin of head and shoulders, where hair meets it.
    pub field: Option<Arc<BodyField>>,
    /// By how much the skin is moved outward, metres.
    pub field_lift_m: f32,
    /// The hairstyle.
    pub style: Arc<Hairstyle>,
    /// Where the head goes.
    pub head_path: Arc<HeadPath>,
    /// What the body's file, the motion's file and the hair's file had to say: guesses, and what was dropped.
    pub notes: Arc<[lovelock_project::error::Problem]>,
}

impl Scene {
    /// Seconds after which the motion ends or starts again; 0 where the body rests.
    pub fn duration_secs(&self) -> f64 {
        self.clip.as_ref().map_or(0.0, |clip| (clip.duration_secs / self.speed).max(0.0))
    }

    /// The time of the clip at a time of the scene.
    pub fn clip_secs(&self, time_secs: f64) -> f64 {
        let Some(clip) = &self.clip else { return 0.0 };
        let clip_secs = time_secs * self.speed;
        if clip.duration_secs <= 0.0 {
            0.0
        } else if self.looping {
            clip_secs.rem_euclid(clip.duration_secs)
        } else {
            // The clip's end itself would be its start again.
            clip_secs.clamp(0.0, clip.duration_secs.next_down())
        }
    }

    /// Which repetition of the clip a time of the scene falls into; 0 where it does not loop.
    pub fn repetition(&self, time_secs: f64) -> i64 {
        let duration = self.duration_secs();
        if self.looping && duration > 0.0 { (time_secs / duration).floor() as i64 } else { 0 }
    }

    /// A time of the scene brought into the first repetition: where the timeline stands.
    pub fn position_secs(&self, time_secs: f64) -> f64 {
        let duration = self.duration_secs();
        if duration <= 0.0 {
            0.0
        } else if self.looping {
            time_secs.rem_euclid(duration)
        } else {
            time_secs.clamp(0.0, duration)
        }
    }

    /// What a part of the body is called that hair collides with.
    pub fn name_of(&self, part: BodyPart) -> &str {
        match part {
            BodyPart::Field => "head and shoulders",
            BodyPart::Collider(i) => {
                self.colliders.get(i as usize).map_or("the body", |collider| collider.name.as_str())
            }
        }
    }

    /// The earliest time from which the motion goes on to `time_secs` without a jump.
    pub fn lead_in_secs(&self, time_secs: f64) -> f64 {
        if self.loops_smoothly() || !self.looping {
            f64::NEG_INFINITY
        } else {
            self.repetition(time_secs) as f64 * self.duration_secs()
        }
    }

    /// Whether the pose is continuous where the clip starts again.
    pub fn loops_smoothly(&self) -> bool {
        self.looping && self.clip.as_ref().is_none_or(|clip| clip.loops || clip.duration_secs <= 0.0)
    }

    /// Frames that the motion lasts at `fps` frames a second, at least one.
    pub fn frames(&self, fps: f64) -> u64 {
        frames_in(self.duration_secs(), fps)
    }
}

/// Frames that begin before `duration_secs` is over, at least one.
fn frames_in(duration_secs: f64, fps: f64) -> u64 {
    // Files hold times in single precision: 9.6 s is some 4e-7 s more there, which is no frame of its own.
    let rounding = duration_secs * f64::from(f32::EPSILON) + 1e-6 / fps;
    ((duration_secs - rounding) * fps).ceil().max(1.0) as u64
}

#[cfg(test)]
mod collider_tests;
#[cfg(test)]
mod operation_tests;
#[cfg(test)]
mod tests {
    use super::frames_in;

    #[test]
    fn a_time_in_single_precision_makes_no_frame_of_its_own() {
        for secs in [9.6_f32, 0.1, 59.7, 1234.5] {
            for fps in [24.0, 30.0, 60.0, 240.0] {
                // The decimal that was meant, in whole frames.
                let meant = (f64::from(secs) * 10.0).round() * fps / 10.0;
                assert_eq!(frames_in(f64::from(secs), fps), meant.ceil() as u64, "{secs} s at {fps}");
            }
        }
        assert_eq!(frames_in(9.61, 30.0), 289, "a part of a frame is one");
        assert_eq!(frames_in(0.0, 30.0), 1);
    }
}
