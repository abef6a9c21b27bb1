//! The scene that is simulated and rendered: a body, its motion and its hair.

mod camera;
mod control;
mod hair_part;
mod hair_slot;
mod head_path;
mod lens;
mod loader;
mod parts;
mod scalp_part;
mod shipped;
mod skin_hair_part;
mod styling;
mod surroundings;

pub use camera::{camera_at, camera_for_size, frame_points};
pub use control::LoadControl;
pub use head_path::HeadPath;
pub use lens::Lens;
pub(crate) use lens::{Figure, radical};
pub use loader::SceneLoader;
pub(crate) use scalp_part::Enlarged;
pub use shipped::dancer;
pub use styling::StyleSource;
pub(crate) use styling::Styling;
pub use surroundings::Surroundings;
pub(crate) use surroundings::SurroundingsLoader;

use std::sync::Arc;

use glam::Vec3;
use lovelock_groom::carried::SkinHair;
use lovelock_groom::{Hairstyle, Obstacle, Scalp};
use lovelock_motion::{Body, BodyField, Clip, Collider, Face, LoopBlend, Pose, RestDistance, Skull, pose_at};
use lovelock_project::error::Problem;
use lovelock_simulation::BodyPart;

/// The body at rest as the obstacle around which hair is combed.
#[derive(Debug)]
pub struct BodyObstacle {
    /// The resting body, head space.
    pub rest: Arc<RestDistance>,
    /// Size of the head as a multiple of that of the shipped dancer. Hair is combed in the size of her head.
    pub scale: f32,
}

impl Obstacle for BodyObstacle {
    fn distance(&self, p: Vec3) -> (f32, Vec3) {
        // A scale of 1 changes no bit.
        let (distance, normal) = self.rest.distance(p * self.scale);
        (distance / self.scale, normal)
    }
}

/// A body, its motion and its hair. Immutable; large parts are shared between successive scenes.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The body.
    pub body: Arc<Body>,
    /// The body's own clips.
    pub clips: Arc<[Arc<Clip>]>,
    /// The clip that is played; the body is at rest if there is none.
    pub clip: Option<Arc<Clip>>,
    /// What is added to the clip's weights of morph targets.
    pub face: Arc<Face>,
    /// Speed: seconds of the clip per second.
    pub speed: f64,
    /// Whether the clip starts again at its end.
    pub looping: bool,
    /// Where the ends of a clip are blended while it loops.
    pub loop_blend: LoopBlend,
    /// The shapes that hair collides with, in addition to the field.
    pub colliders: Arc<[Collider]>,
    /// The shapes that the field replaces for collisions; they still block the wind.
    pub sheltering: Arc<[Collider]>,
    /// All shapes that were fitted to the body, without edits.
    pub fitted: Arc<[Collider]>,
    /// The distance field of head and shoulders, if hair collides with it.
    pub field: Option<Arc<BodyField>>,
    /// Outward offset of the skin, metres.
    pub field_lift_m: f32,
    /// The hairstyle.
    pub style: Arc<Hairstyle>,
    /// Brows and lashes, which the skin carries; none on bodies whose file has no masks of them.
    pub skin_hair: Option<Arc<SkinHair>>,
    /// What the hairstyle is made of, for tracks of layers.
    pub source: Arc<StyleSource>,
    /// Size of the hair as a multiple of that on the shipped dancer: lengths of the project's settings are those on her head.
    pub hair_scale: f32,
    /// The scalp in the size of the shipped dancer's head, in which the project's settings are.
    pub usual_scalp: Arc<Scalp>,
    /// The skull to which the scalp was fitted, head space; `None` for a body without a surface.
    pub skull: Option<Skull>,
    /// The path of the head.
    pub head_path: Arc<HeadPath>,
    /// The pictures around the figure.
    pub surroundings: Surroundings,
    /// Notes about the files of body, motion, hair and surroundings: guesses, and ignored contents.
    pub notes: Arc<[Problem]>,
}

impl Scene {
    /// Seconds after which the motion ends or starts again; 0 if the body is at rest.
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
            // The end of the clip is the start of its next repetition.
            clip_secs.clamp(0.0, clip.duration_secs.next_down())
        }
    }

    /// Poses the body at a time of the clip.
    pub fn pose_at(&self, clip_secs: f64, pose: &mut Pose) {
        pose_at(&self.body, self.clip.as_deref(), clip_secs, pose);
        self.face.apply(&mut pose.morph_weights);
    }

    /// The repetition of the clip at a time of the scene; 0 if it does not loop.
    pub fn repetition(&self, time_secs: f64) -> i64 {
        let duration = self.duration_secs();
        if self.looping && duration > 0.0 { (time_secs / duration).floor() as i64 } else { 0 }
    }

    /// Position on the timeline at a time of the scene: the time within the first repetition.
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

    /// Name of a part of the body that hair collides with.
    pub fn name_of(&self, part: BodyPart) -> &str {
        match part {
            BodyPart::Field => "head and shoulders",
            BodyPart::Collider(i) => {
                self.colliders.get(i as usize).map_or("the body", |collider| collider.name.as_str())
            }
        }
    }

    /// The earliest time from which the motion continues to `time_secs` without a jump.
    pub fn lead_in_secs(&self, time_secs: f64) -> f64 {
        if self.loops_smoothly() || !self.looping {
            f64::NEG_INFINITY
        } else {
            self.repetition(time_secs) as f64 * self.duration_secs()
        }
    }

    /// Whether the pose is continuous when the clip starts again.
    pub fn loops_smoothly(&self) -> bool {
        self.looping && self.clip.as_ref().is_none_or(|clip| clip.loops || clip.duration_secs <= 0.0)
    }

    /// Number of frames of a film of the motion at `fps` frames per second, at least one: one round of a motion that repeats by itself,
    /// otherwise all frames up to the one that shows the last pose.
    pub fn frames(&self, fps: f64) -> u64 {
        let secs = self.duration_secs();
        if secs > 0.0 && self.ends_with_last_pose() {
            frames_to(secs, fps)
        } else {
            self.frames_of_round(fps)
        }
    }

    /// Number of frames of one round of the motion at `fps` frames per second, at least one. The first pose of the next round is not one
    /// of them.
    pub fn frames_of_round(&self, fps: f64) -> u64 {
        frames_in(self.duration_secs(), fps)
    }

    /// Whether a film of the motion ends with its last pose, instead of before the pose with which it repeats.
    fn ends_with_last_pose(&self) -> bool {
        let repeats =
            self.looping && self.clip.as_ref().is_none_or(|clip| clip.loops && clip.loop_blend_secs <= 0.0);
        self.loop_blend == LoopBlend::End && !repeats
    }

    /// The scene for a film of `frames` that need no second round of a motion whose last pose is not its first: it plays once, without the
    /// blend by which it loops. `None` if the scene is right for them as it is.
    pub fn played_once(&self, frames: &std::ops::Range<u64>, fps: f64) -> Option<Self> {
        let clip = self.clip.as_ref().filter(|_| self.looping && self.ends_with_last_pose())?;
        if frames.end > self.frames(fps) {
            return None;
        }
        let clip = Arc::new((**clip).clone().played_once());
        let head_path = Arc::new(HeadPath::new(&self.body, Some(&clip), false));
        let notes = self.notes.iter().filter(|note| !self.is_loop_note(note)).cloned().collect();
        Some(Self { clip: Some(clip), looping: false, head_path, notes, ..self.clone() })
    }

    /// Whether a note is that about the ends of the looping motion.
    pub fn is_loop_note(&self, note: &Problem) -> bool {
        self.clip.as_ref().is_some_and(|clip| parts::loop_note(clip) == *note)
    }
}

/// Number of frames up to the first that is not before `end_secs`.
fn frames_to(end_secs: f64, fps: f64) -> u64 {
    // Times of frames are rounded in files: 0.033333 s is meant as a thirtieth. The last pose does not differ within so little of a frame.
    const ROUNDING: f64 = 0.05;
    (end_secs * fps - ROUNDING).ceil().max(0.0) as u64 + 1
}

/// Number of frames that start before `duration_secs`, at least one.
fn frames_in(duration_secs: f64, fps: f64) -> u64 {
    // Files store times in single precision, where 9.6 s becomes about 4e-7 s more. That must not add a frame.
    let rounding = duration_secs * f64::from(f32::EPSILON) + 1e-6 / fps;
    ((duration_secs - rounding) * fps).ceil().max(1.0) as u64
}

#[cfg(test)]
mod axis_tests;
#[cfg(test)]
mod collider_tests;
#[cfg(test)]
mod head_tests;
#[cfg(test)]
mod morph_tests;
#[cfg(test)]
mod operation_tests;
#[cfg(test)]
mod skin_hair_tests;
#[cfg(test)]
mod styling_tests;
#[cfg(test)]
mod surroundings_tests;
#[cfg(test)]
mod tests {
    use super::{frames_in, frames_to};

    #[test]
    fn the_last_pose_has_a_frame_at_any_rate() {
        for (rows, row_secs, fps, frames) in [
            (59, 0.033_333, 30.0, 59),
            (59, 0.033_333_4, 30.0, 59),
            (59, 0.033_333, 60.0, 117),
            // The end lies between two frames.
            (59, 0.033_333, 24.0, 48),
            (1007, 0.01, 100.0, 1007),
            (3000, 0.008_333, 120.0, 3000),
            (1, 0.04, 30.0, 1),
        ] {
            let end = f64::from(rows - 1) * row_secs;
            assert_eq!(frames_to(end, fps), frames, "{rows} rows of {row_secs} s at {fps}");
            let last = (frames - 1) as f64 / fps;
            assert!(last > end - 0.1 / fps, "{last} s of {end} s");
        }
    }

    #[test]
    fn rounding_to_single_precision_adds_no_frame() {
        for secs in [9.6_f32, 0.1, 59.7, 1234.5] {
            for fps in [24.0, 30.0, 60.0, 240.0] {
                // The intended decimal, in whole frames.
                let meant = (f64::from(secs) * 10.0).round() * fps / 10.0;
                assert_eq!(frames_in(f64::from(secs), fps), meant.ceil() as u64, "{secs} s at {fps}");
            }
        }
        assert_eq!(frames_in(9.61, 30.0), 289, "a partial frame counts");
        assert_eq!(frames_in(0.0, 30.0), 1);
    }
}
