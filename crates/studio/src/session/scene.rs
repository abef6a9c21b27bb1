//! What is simulated and drawn: a body, its motion and its hair.

use std::sync::Arc;

use glam::Vec3;
use lovelock_groom::{Hairstyle, Obstacle};
use lovelock_motion::{Body, Clip, Collider, RestDistance};

use super::HeadPath;

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
    /// What hair collides with.
    pub colliders: Arc<[Collider]>,
    /// The hairstyle.
    pub style: Arc<Hairstyle>,
    /// Where the head goes.
    pub head_path: Arc<HeadPath>,
    /// What the body's file, the motion's file and the hair's file had to say: guesses, and what was dropped.
    pub notes: Arc<[crate::Problem]>,
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

    /// Whether the pose is continuous where the clip starts again.
    pub fn loops_smoothly(&self) -> bool {
        self.looping && self.clip.as_ref().is_none_or(|clip| clip.loops || clip.duration_secs <= 0.0)
    }

    /// Frames that the motion lasts at `fps` frames a second, at least one.
    pub fn frames(&self, fps: f64) -> u64 {
        ((self.duration_secs() * fps - 1e-6).ceil().max(1.0)) as u64
    }
}
