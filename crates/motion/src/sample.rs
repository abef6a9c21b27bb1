//! Sampling a clip: the pose of a body at any time.

use glam::{Affine3A, Quat, Vec3};

use crate::{
    Body, Clip, Interpolation, Joint, JointTracks, LoopBlend, MorphTrack, Pose, Track, pose::rigid_head,
};

/// A value that a track can hold.
trait Key: Copy {
    fn linear(a: Self, b: Self, u: f32) -> Self;
    /// Weighted sum of four values.
    fn weighted(values: [Self; 4], weights: [f32; 4]) -> Self;
}

impl Key for Vec3 {
    fn linear(a: Self, b: Self, u: f32) -> Self {
        a + (b - a) * u
    }
    fn weighted(v: [Self; 4], w: [f32; 4]) -> Self {
        v[0] * w[0] + v[1] * w[1] + v[2] * w[2] + v[3] * w[3]
    }
}

impl Key for Quat {
    /// Along the shorter great arc; `Quat::slerp` flips the sign if necessary.
    fn linear(a: Self, b: Self, u: f32) -> Self {
        a.slerp(b, u)
    }
    fn weighted(v: [Self; 4], w: [f32; 4]) -> Self {
        let sum = v[0] * w[0] + v[1] * w[1] + v[2] * w[2] + v[3] * w[3];
        let length = sum.length();
        if length > 1e-6 { sum * (1.0 / length) } else { v[0] }
    }
}

impl Key for f32 {
    fn linear(a: Self, b: Self, u: f32) -> Self {
        a + (b - a) * u
    }
    fn weighted(v: [Self; 4], w: [f32; 4]) -> Self {
        v[0] * w[0] + v[1] * w[1] + v[2] * w[2] + v[3] * w[3]
    }
}

/// Finds the keys around `time`: the index of the key before, the fraction of the way to the next, and their
/// spacing.
fn locate(times: &[f32], time: f64) -> (usize, f32, f32) {
    let after = times.partition_point(|&t| f64::from(t) <= time);
    if after == 0 || times.len() == 1 {
        return (0, 0.0, 0.0);
    }
    if after == times.len() {
        return (times.len() - 2, 1.0, times[after - 1] - times[after - 2]);
    }
    let (t0, t1) = (f64::from(times[after - 1]), f64::from(times[after]));
    (after - 1, ((time - t0) / (t1 - t0)) as f32, (t1 - t0) as f32)
}

/// Samples component `lane` of a track whose keys hold `stride` numbers each.
fn value<T: Key>(track: &Track<T>, stride: usize, lane: usize, time: f64) -> T {
    let (key, u, spacing) = locate(&track.times, time);
    let next = (key + 1).min(track.times.len() - 1);
    match track.interpolation {
        Interpolation::Step => track.values[if u >= 1.0 { next } else { key } * stride + lane],
        Interpolation::Linear => {
            T::linear(track.values[key * stride + lane], track.values[next * stride + lane], u)
        }
        Interpolation::Cubic => {
            // glTF 2.0, appendix C.5: tangents are per second, so they are scaled by the key spacing.
            let at = |key: usize, part: usize| track.values[(key * 3 + part) * stride + lane];
            let (u2, u3) = (u * u, u * u * u);
            T::weighted(
                [at(key, 1), at(key, 2), at(next, 1), at(next, 0)],
                [
                    2.0 * u3 - 3.0 * u2 + 1.0,
                    spacing * (u3 - 2.0 * u2 + u),
                    3.0 * u2 - 2.0 * u3,
                    spacing * (u3 - u2),
                ],
            )
        }
    }
}

impl Track<Vec3> {
    /// The value at a time. It is constant before the first key and after the last.
    pub fn at(&self, time_secs: f64) -> Vec3 {
        value(self, 1, 0, time_secs)
    }
}

impl Track<Quat> {
    /// The value at a time. It is constant before the first key and after the last.
    pub fn at(&self, time_secs: f64) -> Quat {
        value(self, 1, 0, time_secs)
    }
}

impl Track<f32> {
    /// The value at a time. It is constant before the first key and after the last.
    pub fn at(&self, time_secs: f64) -> f32 {
        value(self, 1, 0, time_secs)
    }
}

impl MorphTrack {
    /// Weight of target `lane` of the range at a time.
    pub fn at(&self, lane: usize, time_secs: f64) -> f32 {
        value(&self.track, self.count, lane, time_secs)
    }
}

/// Local transform of one joint.
#[derive(Clone, Copy)]
struct Local {
    translation: Vec3,
    rotation: Quat,
    scale: Vec3,
}

impl Local {
    fn at(rest: &Joint, tracks: &JointTracks, time_secs: f64) -> Self {
        Self {
            translation: tracks.translation.as_ref().map_or(rest.translation, |t| t.at(time_secs)),
            rotation: tracks.rotation.as_ref().map_or(rest.rotation, |t| t.at(time_secs)),
            scale: tracks.scale.as_ref().map_or(rest.scale, |t| t.at(time_secs)),
        }
    }

    fn blend(self, to: Self, u: f32) -> Self {
        Self {
            translation: self.translation.lerp(to.translation, u),
            rotation: self.rotation.slerp(to.rotation, u),
            scale: self.scale.lerp(to.scale, u),
        }
    }

    fn affine(self) -> Affine3A {
        Affine3A::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}

/// The times at which a clip's keys are sampled for one instant: the main time and, during a blend, the time at the other end together
/// with the main one's weight.
struct Instant {
    main: f64,
    fade: Option<(f64, f32)>,
}

impl Instant {
    fn new(clip: &Clip, time_secs: f64) -> Self {
        let time = if time_secs.is_finite() && clip.duration_secs > 0.0 { time_secs } else { 0.0 };
        let main = if clip.duration_secs > 0.0 { time.rem_euclid(clip.duration_secs) } else { 0.0 };
        let start = clip.part_secs.map_or(0.0, |[start, _]| start);
        // At the start the time since, and at the end the time left; both go with the weight of the main time.
        let (within, other) = match clip.loop_blend {
            LoopBlend::Start => (main, start + clip.duration_secs + main),
            LoopBlend::End => (clip.duration_secs - main, start),
        };
        let fade = (within < clip.loop_blend_secs).then(|| {
            let u = (within / clip.loop_blend_secs) as f32;
            (other, u * u * (3.0 - 2.0 * u))
        });
        Self { main: start + main, fade }
    }
}

/// Computes the pose of a body at a time of a clip, or the rest pose without a clip.
///
/// Any time in seconds is valid: the clip repeats every [`Clip::duration_secs`], also for negative times.
/// Nothing is allocated if `pose` was used with this body before.
pub fn pose_at(body: &Body, clip: Option<&Clip>, time_secs: f64, pose: &mut Pose) {
    pose.time_secs = time_secs;
    pose.morph_weights.clear();
    pose.morph_weights.extend(body.skin.morphs.iter().map(|m| m.rest_weight));
    pose.world_from_joint.clear();
    let Some(clip) = clip else {
        pose.world_from_joint.extend_from_slice(&body.skeleton.world_at_rest);
        pose.world_from_head = rigid_head(body, &pose.world_from_joint);
        return;
    };
    let instant = Instant::new(clip, time_secs);
    let mut tracks = clip.joints.iter().peekable();
    for (j, rest) in body.skeleton.joints.iter().enumerate() {
        while tracks.next_if(|t| t.joint < j).is_some() {}
        let local = match tracks.peek().filter(|t| t.joint == j) {
            None => body.skeleton.local_at_rest(j),
            Some(tracks) => {
                let main = Local::at(rest, tracks, instant.main);
                match instant.fade {
                    Some((other, share)) => Local::at(rest, tracks, other).blend(main, share).affine(),
                    None => main.affine(),
                }
            }
        };
        let world = rest.parent.map_or(local, |p| pose.world_from_joint[p] * local);
        pose.world_from_joint.push(world);
    }
    for morph in &clip.morphs {
        for lane in 0..morph.count {
            let Some(weight) = pose.morph_weights.get_mut(morph.first + lane) else { break };
            let main = morph.at(lane, instant.main);
            *weight =
                instant.fade.map_or(main, |(other, share)| f32::linear(morph.at(lane, other), main, share));
        }
    }
    for of in &clip.expressions {
        let Some(expression) = body.expressions.get(of.expression) else { continue };
        let main = of.track.at(instant.main);
        let weight = instant.fade.map_or(main, |(other, share)| f32::linear(of.track.at(other), main, share));
        expression.add(weight, &mut pose.morph_weights);
    }
    pose.world_from_head = rigid_head(body, &pose.world_from_joint);
}
