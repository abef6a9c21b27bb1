//! Motion over time: keyed tracks of joints and morph targets.

use std::sync::Arc;

use glam::{Quat, Vec3};

/// How values between keys are found (glTF 2.0, section 3.11 and appendix C).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// The value of the key before.
    Step,
    /// A straight line; for rotations the shorter great arc.
    #[default]
    Linear,
    /// A cubic Hermite spline. Values come three a key: in-tangent, value, out-tangent, tangents per second.
    Cubic,
}

/// One keyed quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Track<T> {
    /// Times of the keys, increasing, seconds. Tracks of one clip often share them.
    pub times: Arc<[f32]>,
    /// Values: one a key, or three a key where the interpolation is cubic.
    pub values: Vec<T>,
    /// How values between keys are found.
    pub interpolation: Interpolation,
}

/// What moves one joint; a missing track leaves the rest pose's value.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct JointTracks {
    /// Index of the joint in the skeleton.
    pub joint: usize,
    /// Translation relative to the parent, metres.
    pub translation: Option<Track<Vec3>>,
    /// Rotation relative to the parent.
    pub rotation: Option<Track<Quat>>,
    /// Scale relative to the parent.
    pub scale: Option<Track<Vec3>>,
}

/// What drives a run of morph targets.
#[derive(Clone, Debug, PartialEq)]
pub struct MorphTrack {
    /// The first morph target of the body that it drives.
    pub first: usize,
    /// How many it drives; `values` holds this many numbers a key (or in-tangents, values, out-tangents).
    pub count: usize,
    /// Weights, key after key.
    pub track: Track<f32>,
}

/// A motion of one body, immutable once made.
#[derive(Clone, Debug, Default)]
pub struct Clip {
    /// What the interface calls it.
    pub name: String,
    /// After this time it starts again, seconds. Shorter than the keys last where ends are cross-faded.
    pub duration_secs: f64,
    /// True where it starts again without a jump.
    pub loops: bool,
    /// The part of the keys that plays, first and last second; all of them where none.
    pub part_secs: Option<[f64; 2]>,
    /// For this long after each start the end of the keys fades into their beginning, seconds; 0 for no fade.
    pub loop_blend_secs: f64,
    /// Tracks of joints, sorted by joint.
    pub joints: Vec<JointTracks>,
    /// Tracks of morph targets.
    pub morphs: Vec<MorphTrack>,
}

impl Clip {
    /// Time of the last key, seconds.
    pub fn keys_end_secs(&self) -> f64 {
        let joints = self.joints.iter().flat_map(|j| {
            [
                j.translation.as_ref().map(|t| &t.times),
                j.rotation.as_ref().map(|t| &t.times),
                j.scale.as_ref().map(|t| &t.times),
            ]
        });
        let morphs = self.morphs.iter().map(|m| Some(&m.track.times));
        joints
            .chain(morphs)
            .flatten()
            .filter_map(|times| times.last())
            .fold(0.0_f64, |end, &t| end.max(f64::from(t)))
    }

    /// First and last second of the keys that play.
    pub fn part(&self) -> [f64; 2] {
        self.part_secs.unwrap_or([0.0, self.keys_end_secs()])
    }

    /// The same clip from one second of its keys to another, without a fade: at least a tenth of a second of what there is.
    /// Whether it loops has to be found out anew ([`Clip::detect_loop`]).
    #[must_use]
    pub fn trimmed(mut self, start_secs: f64, end_secs: Option<f64>) -> Self {
        const LEAST_SECS: f64 = 0.1;
        let whole = self.keys_end_secs();
        let finite = |secs: f64, otherwise: f64| if secs.is_finite() { secs } else { otherwise };
        let start = finite(start_secs, 0.0).clamp(0.0, (whole - LEAST_SECS).max(0.0));
        let end = finite(end_secs.unwrap_or(whole), whole).clamp((start + LEAST_SECS).min(whole), whole);
        self.part_secs = Some([start, end]);
        (self.duration_secs, self.loop_blend_secs, self.loops) = (end - start, 0.0, false);
        self
    }

    /// The same clip with its last `blend_secs` faded into its first, so that it starts again without a jump. It
    /// gets shorter by that time, of which at most half its length is taken; 0 removes the fade.
    #[must_use]
    pub fn with_loop_blend(mut self, blend_secs: f64) -> Self {
        let [start, end] = self.part();
        let length = end - start;
        self.loop_blend_secs = if blend_secs.is_finite() { blend_secs.clamp(0.0, length / 2.0) } else { 0.0 };
        self.duration_secs = length - self.loop_blend_secs;
        self.loops |= self.loop_blend_secs > 0.0;
        self
    }
}
