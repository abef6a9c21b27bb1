//! `SkelAnimation` as clips.

use std::sync::Arc;

use glam::{Quat, Vec3};
use lovelock_usd::{Layer, Value};

use super::mesh::Shapes;
use super::skeleton::{Figure, OneSkeleton, quaternion, scale};
use super::{inherited_target, tokens};
use crate::{Clip, Interpolation, JointTracks, MorphTrack, MotionError, Track};

/// Most values of one attribute over all times: about a gigabyte of memory.
const MAX_VALUES: usize = 1 << 26;

/// Reads the clips of a stage: one of all animations that skeletons are bound to, then one of each other animation.
pub(super) fn read_clips(
    file: &str,
    layer: &mut dyn Layer,
    figure: &Figure,
    shapes: &Shapes,
) -> Result<Vec<Clip>, MotionError> {
    let mut bound: Vec<(usize, &OneSkeleton)> = Vec::new();
    for skeleton in &figure.skeletons {
        if let Some(animation) = inherited_target(layer, skeleton.prim, "skel:animationSource")? {
            bound.push((animation, skeleton));
        }
    }
    let mut groups: Vec<Vec<(usize, &OneSkeleton)>> = Vec::new();
    if !bound.is_empty() {
        groups.push(bound.clone());
    }
    for (animation, _) in layer.prims(&["SkelAnimation"])? {
        if bound.iter().any(|(known, _)| *known == animation) {
            continue;
        }
        let names = tokens(layer, animation, "joints")?;
        let common =
            |skeleton: &&OneSkeleton| skeleton.paths.iter().filter(|path| names.contains(path)).count();
        if let Some(skeleton) = figure.skeletons.iter().max_by_key(common) {
            groups.push(vec![(animation, skeleton)]);
        }
    }
    let mut clips = Vec::new();
    for group in groups {
        let clip = Reader::new(file, layer)?.read(layer, &group, shapes)?;
        if !clip.joints.is_empty() || !clip.morphs.is_empty() {
            clips.push(clip);
        }
    }
    Ok(clips)
}

/// The clock of one clip.
struct Reader<'a> {
    file: &'a str,
    /// The time code at which the stage states to start; 0 where it states none.
    stated: f64,
    codes_per_second: f64,
}

impl<'a> Reader<'a> {
    fn new(file: &'a str, layer: &mut dyn Layer) -> Result<Self, MotionError> {
        let mut number = |name: &str| -> Result<Option<f64>, MotionError> {
            let value = layer.metadata(name)?;
            Ok(value.and_then(|value| value.numbers().first().copied()).filter(|n| n.is_finite()))
        };
        let rate = number("timeCodesPerSecond")?.or(number("framesPerSecond")?);
        let stated = number("startTimeCode")?;
        Ok(Self {
            file,
            stated: stated.unwrap_or(0.0),
            codes_per_second: rate.filter(|rate| (1e-3..=1e6).contains(rate)).unwrap_or(24.0),
        })
    }

    fn read(
        &self,
        layer: &mut dyn Layer,
        group: &[(usize, &OneSkeleton)],
        shapes: &Shapes,
    ) -> Result<Clip, MotionError> {
        let mut clip = Clip::default();
        for &(animation, skeleton) in group {
            if clip.name.is_empty() {
                layer.path(animation).rsplit('/').next().unwrap_or_default().clone_into(&mut clip.name);
            }
            let names = tokens(layer, animation, "joints")?;
            let vectors = |value: Value| value.into_vectors();
            let translations = self.sampled(layer, animation, "translations", names.len(), &vectors)?;
            let scales = self.sampled(layer, animation, "scales", names.len(), &vectors)?;
            let turns = |value: Value| value.into_quaternions().iter().map(quaternion).collect();
            let rotations: Option<Sampled<Quat>> =
                self.sampled(layer, animation, "rotations", names.len(), &turns)?;
            for (k, name) in names.iter().enumerate() {
                let Some(of_skeleton) = skeleton.paths.iter().position(|path| path == name) else { continue };
                let finite = |track: &Track<Vec3>| track.values.iter().all(|v| v.is_finite());
                clip.joints.push(JointTracks {
                    joint: skeleton.joints[of_skeleton],
                    translation: translations.as_ref().map(|all| all.track(k, |v| v)).filter(finite),
                    rotation: rotations.as_ref().map(|all| all.track(k, |q| q)),
                    scale: scales.as_ref().map(|all| all.track(k, scale)),
                });
            }
            let names = tokens(layer, animation, "blendShapes")?;
            let floats = |value: Value| value.into_floats();
            let weights = self.sampled(layer, animation, "blendShapeWeights", names.len(), &floats)?;
            for (k, name) in names.into_iter().enumerate() {
                let morphs = shapes.get(&(skeleton.prim, name)).into_iter().flatten();
                for (&first, weights) in morphs.zip(weights.iter().cycle()) {
                    let track = weights.track(k, |w: f32| if w.is_finite() { w } else { 0.0 });
                    clip.morphs.push(MorphTrack { first, count: 1, track });
                }
            }
        }
        clip.joints.retain(|t| t.translation.is_some() || t.rotation.is_some() || t.scale.is_some());
        clip.joints.sort_by_key(|tracks| tracks.joint);
        clip.joints.dedup_by_key(|tracks| tracks.joint);
        Ok(clip.starting_at_first_key(self.stated / self.codes_per_second))
    }

    /// All samples of an attribute with `lanes` values each; its default as one sample if it has none; `None` if it is missing or of
    /// another length.
    fn sampled<T>(
        &self,
        layer: &mut dyn Layer,
        animation: usize,
        name: &str,
        lanes: usize,
        make: &dyn Fn(Value) -> Vec<T>,
    ) -> Result<Option<Sampled<T>>, MotionError> {
        let codes = layer.sample_times(animation, name)?;
        if codes.len().saturating_mul(lanes) > MAX_VALUES {
            let problem =
                format!("{} samples of {lanes} {name}; must be at most {MAX_VALUES} values", codes.len());
            return Err(MotionError::malformed(self.file, layer.path(animation), problem));
        }
        let (mut times, mut values) = (Vec::new(), Vec::with_capacity(codes.len() * lanes));
        for (k, code) in codes.iter().enumerate() {
            let time = (code / self.codes_per_second) as f32;
            let is_next = time.is_finite() && time.abs() < 1e6 && times.last().is_none_or(|&t| t < time);
            let Some(value) = layer.sample(animation, name, k, lanes)?.filter(|_| is_next) else { continue };
            let value = make(value);
            if value.len() == lanes {
                times.push(time);
                values.extend(value);
            }
        }
        if times.is_empty() {
            let value =
                layer.attribute(animation, name, lanes)?.map(make).filter(|value| value.len() == lanes);
            let Some(value) = value else { return Ok(None) };
            (times, values) = (vec![0.0], value);
        }
        Ok((lanes > 0).then(|| Sampled { times: times.into(), values, lanes }))
    }
}

/// The samples of an array over time, one after another.
struct Sampled<T> {
    times: Arc<[f32]>,
    values: Vec<T>,
    lanes: usize,
}

impl<T: Copy> Sampled<T> {
    /// One element of the array over time.
    fn track(&self, lane: usize, make: impl Fn(T) -> T) -> Track<T> {
        let values = self.values.iter().skip(lane).step_by(self.lanes).map(|&v| make(v)).collect();
        Track { times: self.times.clone(), values, interpolation: Interpolation::Linear }
    }
}
