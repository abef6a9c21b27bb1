//! Motion over time: keyed tracks of joints and morph targets.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{Quat, Vec3};

use crate::LoopBlend;

/// The longest motion, seconds: a wrong time of a key would otherwise give hours of frames.
pub(crate) const LONGEST_SECS: f64 = 7200.0;

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

/// The track of one expression.
#[derive(Clone, Debug, PartialEq)]
pub struct ExpressionTrack {
    /// Index into [`crate::Body::expressions`].
    pub expression: usize,
    /// Its weight over time.
    pub track: Track<f32>,
}

/// The keys of a clip.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Keys {
    /// Number of times at which there are keys.
    pub times: usize,
    /// The time of which all are multiples, counted from the first, seconds: the smallest between two. `None` for keys that are spaced
    /// unevenly.
    pub step_secs: Option<f64>,
}

impl Keys {
    /// Those at some times, in any order, seconds.
    pub(crate) fn at(mut times: Vec<f32>) -> Self {
        times.sort_by(f32::total_cmp);
        // Keys that close are one key that was rounded differently.
        times.dedup_by(|b, a| f64::from(*b) - f64::from(*a) <= SAME_KEY_SECS);
        Self { times: times.len(), step_secs: step_secs(&times) }
    }
}

/// Keys closer to each other than this are one, seconds.
const SAME_KEY_SECS: f64 = 1e-4;

/// The time of which all of some ascending times are multiples, seconds.
fn step_secs(times: &[f32]) -> Option<f64> {
    let gaps = times.windows(2).map(|pair| f64::from(pair[1]) - f64::from(pair[0]));
    let least = gaps.reduce(f64::min)?;
    let first = f64::from(*times.first()?);
    // The smallest gap is rounded; the later a key, the more exact is its share.
    let step = times.iter().fold(least, |step, &time| {
        let count = ((f64::from(time) - first) / step).round();
        if count >= 1.0 { (f64::from(time) - first) / count } else { step }
    });
    let is_multiple = |&time: &f32| {
        let steps = (f64::from(time) - first) / step;
        (steps - steps.round()).abs() < 0.02
    };
    times.iter().all(is_multiple).then_some(step)
}

/// A motion of one body; immutable.
#[derive(Clone, Debug, Default)]
pub struct Clip {
    /// The name shown in the interface.
    pub name: String,
    /// Length of one round, seconds. Shorter than the range of the keys if their start is blended.
    pub duration_secs: f64,
    /// Time of the first key on the clock of the file, seconds. Times of tracks count from the first key.
    pub start_secs: f64,
    /// Seconds that the file's own clock, or the start that the file states, is ahead of the first key; negative if keys lie before it.
    pub lead_secs: f64,
    /// The keys as the file has them, where tracks have others.
    pub file_keys: Option<Keys>,
    /// Length of the step from the last key of the file back to the first pose, which was added to the end of a cycle, seconds.
    pub added_secs: f64,
    /// Whether it repeats without a jump.
    pub loops: bool,
    /// First and last second of the keys that play; all keys if `None`.
    pub part_secs: Option<[f64; 2]>,
    /// Where the ends are blended so that the clip repeats.
    pub loop_blend: LoopBlend,
    /// Length of that blend, seconds; 0 for none.
    pub loop_blend_secs: f64,
    /// Tracks of joints, sorted by joint.
    pub joints: Vec<JointTracks>,
    /// Tracks of morph targets.
    pub morphs: Vec<MorphTrack>,
    /// Tracks of expressions, whose weights are added to those of the morph targets.
    pub expressions: Vec<ExpressionTrack>,
}

impl Clip {
    /// Time of the last key, seconds.
    pub fn keys_end_secs(&self) -> f64 {
        self.times().filter_map(|times| times.last()).fold(0.0_f64, |end, &t| end.max(f64::from(t)))
    }

    /// The times of each track.
    fn times(&self) -> impl Iterator<Item = &Arc<[f32]>> {
        let joints = self.joints.iter().flat_map(|j| {
            [
                j.translation.as_ref().map(|t| &t.times),
                j.rotation.as_ref().map(|t| &t.times),
                j.scale.as_ref().map(|t| &t.times),
            ]
        });
        let morphs = self.morphs.iter().map(|m| &m.track.times);
        joints.flatten().chain(morphs).chain(self.expressions.iter().map(|of| &of.track.times))
    }

    /// The keys of the file.
    pub(crate) fn keys(&self) -> Keys {
        if let Some(keys) = self.file_keys {
            return keys;
        }
        let mut all: Vec<f32> = Vec::new();
        let mut seen: Vec<*const f32> = Vec::new();
        let mut single = None;
        for times in self.times() {
            // A track with one key holds at all times.
            if times.len() < 2 {
                single = single.or(times.first().copied());
            } else if !seen.contains(&times.as_ptr()) && !all.ends_with(times) {
                // Most tracks share their times, or have the same ones.
                seen.push(times.as_ptr());
                all.extend(times.iter());
            }
        }
        Keys::at(if all.is_empty() { single.into_iter().collect() } else { all })
    }

    /// Times of the first and the last key, seconds. A track with one key holds at all times, so it does not count beside others.
    fn range(&self) -> Option<[f32; 2]> {
        let over = |least: usize| {
            let ends = self.times().filter(|times| times.len() >= least).filter_map(|times| {
                let (first, last) = (times.first()?, times.last()?);
                Some([*first, *last])
            });
            ends.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
        };
        over(2).or_else(|| over(1))
    }

    /// The same clip with all times later by `secs`. Tracks go on to share their times.
    fn shifted(mut self, secs: f64) -> Self {
        let mut known: HashMap<*const f32, Arc<[f32]>> = HashMap::new();
        let mut shift = |times: &mut Arc<[f32]>| {
            let new = known.entry(times.as_ptr()).or_insert_with(|| {
                let single = times.len() == 1;
                let later = |&t: &f32| if single { 0.0 } else { (f64::from(t) + secs) as f32 };
                times.iter().map(later).collect()
            });
            // The old times are kept by the entry of `kept`, so that no new ones can have their address.
            std::mem::replace(times, Arc::clone(new))
        };
        let mut kept = Vec::new();
        for joint in &mut self.joints {
            kept.extend(joint.translation.as_mut().map(|track| shift(&mut track.times)));
            kept.extend(joint.rotation.as_mut().map(|track| shift(&mut track.times)));
            kept.extend(joint.scale.as_mut().map(|track| shift(&mut track.times)));
        }
        for morph in &mut self.morphs {
            kept.push(shift(&mut morph.track.times));
        }
        for expression in &mut self.expressions {
            kept.push(shift(&mut expression.track.times));
        }
        drop(kept);
        self.duration_secs = self.keys_end_secs();
        self
    }

    /// The same clip from its first key on, whatever the time of that is. `stated_secs` is the start that the file states on its clock.
    #[must_use]
    pub(crate) fn starting_at_first_key(self, stated_secs: f64) -> Self {
        let first = self.range().map_or(0.0, |[first, _]| f64::from(first));
        let clip = Self { start_secs: first, lead_secs: first - stated_secs, ..self };
        clip.shifted(-first)
    }

    /// The same clip from the start of the file's clock on: it holds its first pose before the first key, and keys before that start
    /// do not play.
    #[must_use]
    pub fn on_file_clock(self) -> Self {
        let lead = self.lead_secs;
        if lead == 0.0 { self } else { Self { lead_secs: 0.0, ..self }.shifted(lead) }
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

    /// The same clip with its ends blended over `blend_secs`, which is limited to half its length, so that it repeats without a jump. At
    /// [`LoopBlend::Start`] it becomes shorter by that time. 0 removes the blend.
    #[must_use]
    pub fn with_loop_blend(mut self, blend_secs: f64, at: LoopBlend) -> Self {
        let [start, end] = self.part();
        let length = end - start;
        self.loop_blend = at;
        self.loop_blend_secs = if blend_secs.is_finite() { blend_secs.clamp(0.0, length / 2.0) } else { 0.0 };
        self.duration_secs = length - if at == LoopBlend::Start { self.loop_blend_secs } else { 0.0 };
        self.loops |= self.loop_blend_secs > 0.0;
        self
    }

    /// The same clip for a single round, which ends with its last pose.
    #[must_use]
    pub fn played_once(mut self) -> Self {
        let [start, end] = self.part();
        (self.duration_secs, self.loop_blend_secs, self.loops) = (end - start, 0.0, false);
        self
    }
}
