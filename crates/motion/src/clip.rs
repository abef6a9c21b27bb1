//! Motion over time: keyed tracks of joints and morph targets.

use std::sync::Arc;

use glam::{Quat, Vec3};

/// How values between keys are interpolated (glTF 2.0, section 3.11 and appendix C).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// The value of the previous key.
    Step,
    /// Linear interpolation; for rotations along the shorter great arc.
    #[default]
    Linear,
    /// A cubic Hermite spline. Each key has three values: in-tangent, value, out-tangent, with tangents per
    /// second.
    Cubic,
}

/// One keyed quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Track<T> {
    /// Times of the keys, increasing, seconds. Tracks of one clip often share them.
    pub times: Arc<[f32]>,
    /// One value per key, or three per key for cubic interpolation.
    pub values: Vec<T>,
    /// How values between keys are interpolated.
    pub interpolation: Interpolation,
}

/// The tracks of one joint; a missing track keeps the value of the rest pose.
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

/// The track of a range of morph targets.
#[derive(Clone, Debug, PartialEq)]
pub struct MorphTrack {
    /// The first morph target of the body that it drives.
    pub first: usize,
    /// Number of morph targets; the track has this many values per key (or in-tangents, values,
    /// out-tangents).
    pub count: usize,
    /// Weights, key by key.
    pub track: Track<f32>,
}

/// A motion of one body; immutable.
#[derive(Clone, Debug, Default)]
pub struct Clip {
    /// The name shown in the interface.
    pub name: String,
    /// Length of one round, seconds. Shorter than the range of the keys if the ends are cross-faded.
    pub duration_secs: f64,
    /// Whether it repeats without a jump.
    pub loops: bool,
    /// First and last second of the keys that play; all keys if `None`.
    pub part_secs: Option<[f64; 2]>,
    /// Length of the cross-fade from the end of the keys to their start at each start of a round, seconds; 0
    /// for none.
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

    /// The same clip limited to a range of its keys, without a cross-fade. The range is at least a tenth of a
    /// second. Whether the result loops must be determined again ([`Clip::detect_loop`]).
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

    /// The same clip with its last `blend_secs` cross-faded into its start, so that it repeats without a
    /// jump. It becomes shorter by that time, which is limited to half its length; 0 removes the cross-fade.
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
