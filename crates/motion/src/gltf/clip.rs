//! Reads the animations of a glTF file as clips.

use std::{
    collections::{BTreeMap, HashMap, hash_map::Entry},
    sync::Arc,
};

use glam::{Quat, Vec3};

use lovelock_gltf::Accessors;
use lovelock_gltf::document::Animation;

use super::expressions::MorphsOfNodes;
use crate::{Clip, ExpressionTrack, Interpolation, JointTracks, MorphTrack, MotionError, Track};

/// The count of channels whose keys are at times that do not ascend, are not finite, or are too far from 0.
pub(crate) const UNTIMED: &str = "channels_with_wrong_times";

/// Times further from 0 are errors, seconds.
const LATEST_SECS: f32 = 1e6;

/// What the nodes of a file have become.
#[expect(clippy::struct_field_names, reason = "each is what a node has become")]
pub(super) struct Targets<'a> {
    pub(super) joint_of_node: &'a [Option<usize>],
    /// First morph target and number of morph targets of each node that has some.
    pub(super) morphs_of_node: &'a MorphsOfNodes,
    /// The expression of each node whose way along x is the weight of one.
    pub(super) expression_of_node: &'a BTreeMap<usize, usize>,
}

/// Reads one animation. Invalid channels are dropped and counted; channels of nodes that move nothing
/// (cameras, lights) are ignored.
pub(super) fn read_clip(
    accessors: &Accessors,
    number: usize,
    animation: &Animation,
    targets: &Targets,
    times: &mut HashMap<usize, Option<Arc<[f32]>>>,
    dropped: &mut BTreeMap<String, u64>,
) -> Result<Clip, MotionError> {
    let mut joints: BTreeMap<usize, JointTracks> = BTreeMap::new();
    let mut clip = Clip {
        name: animation.name.clone().unwrap_or_else(|| format!("clip {}", number + 1)),
        ..Clip::default()
    };
    for channel in &animation.channels {
        let Some(node) = channel.target.node else { continue };
        if let Some(&expression) = targets.expression_of_node.get(&node) {
            let source = Source::open(accessors, animation, channel.sampler, times)?;
            let track = source.map(|source| source.vectors()).transpose()?.flatten();
            if let Some(track) = track.filter(|_| channel.target.path == "translation") {
                clip.expressions.push(ExpressionTrack { expression, track: along_x(track) });
            } else {
                *dropped.entry("channels".into()).or_default() += 1;
            }
            continue;
        }
        let joint = targets.joint_of_node.get(node).copied().flatten();
        let entry = joint
            .map(|j| joints.entry(j).or_insert_with(|| JointTracks { joint: j, ..JointTracks::default() }));
        let morphs = targets.morphs_of_node.get(&node).copied();
        let source = Source::open(accessors, animation, channel.sampler, times)?;
        let followed = match (channel.target.path.as_str(), source, entry, morphs) {
            ("translation" | "rotation" | "scale", Some(_), None, _) | ("weights", Some(_), _, None) => {
                node < accessors.document.nodes.len()
            }
            ("translation", Some(source), Some(tracks), _) => {
                tracks.translation = source.vectors()?;
                tracks.translation.is_some()
            }
            ("scale", Some(source), Some(tracks), _) => {
                tracks.scale = source.vectors()?;
                tracks.scale.is_some()
            }
            ("rotation", Some(source), Some(tracks), _) => {
                tracks.rotation = source.rotations()?;
                tracks.rotation.is_some()
            }
            ("weights", Some(source), _, Some((first, count))) => match source.weights(count)? {
                Some(track) => {
                    clip.morphs.push(MorphTrack { first, count, track });
                    true
                }
                None => false,
            },
            _ => false,
        };
        if !followed {
            let input = animation.samplers.get(channel.sampler).map(|sampler| sampler.input);
            let is_untimed = input.is_some_and(|input| matches!(times.get(&input), Some(None)));
            let what = if is_untimed { UNTIMED } else { "channels" };
            *dropped.entry(what.into()).or_default() += 1;
        }
    }
    clip.joints = joints
        .into_values()
        .filter(|t| t.translation.is_some() || t.rotation.is_some() || t.scale.is_some())
        .collect();
    // The clock of glTF starts at 0, but files of animations with a pre-roll have keys before that.
    Ok(clip.starting_at_first_key(0.0))
}

/// The weights that a way along x says.
fn along_x(track: Track<Vec3>) -> Track<f32> {
    let values = track.values.iter().map(|way| way.x).collect();
    Track { times: track.times, values, interpolation: track.interpolation }
}

/// One sampler with verified times.
struct Source<'a> {
    accessors: &'a Accessors<'a>,
    times: Arc<[f32]>,
    output: usize,
    interpolation: Interpolation,
}

impl<'a> Source<'a> {
    fn open(
        accessors: &'a Accessors<'a>,
        animation: &Animation,
        sampler: usize,
        times: &mut HashMap<usize, Option<Arc<[f32]>>>,
    ) -> Result<Option<Self>, MotionError> {
        let Some(sampler) = animation.samplers.get(sampler) else { return Ok(None) };
        let interpolation = match sampler.interpolation.as_deref() {
            None | Some("LINEAR") => Interpolation::Linear,
            Some("STEP") => Interpolation::Step,
            Some("CUBICSPLINE") => Interpolation::Cubic,
            Some(_) => return Ok(None),
        };
        let times = match times.entry(sampler.input) {
            Entry::Occupied(known) => known.get().clone(),
            Entry::Vacant(new) => {
                let keys: Vec<f32> = accessors.read::<1>(sampler.input)?.into_iter().map(|[t]| t).collect();
                let usable = !keys.is_empty()
                    && keys.iter().all(|t| t.is_finite() && t.abs() < LATEST_SECS)
                    && keys.is_sorted();
                new.insert(usable.then(|| keys.into())).clone()
            }
        };
        Ok(times.map(|times| Self { accessors, times, output: sampler.output, interpolation }))
    }

    /// Values per key: three for cubic interpolation.
    fn values_per_key(&self) -> usize {
        if self.interpolation == Interpolation::Cubic { 3 } else { 1 }
    }

    fn track<T, const N: usize>(
        &self,
        lanes: usize,
        make: impl Fn(usize, [f32; N]) -> T,
    ) -> Result<Option<Track<T>>, MotionError> {
        let values = self.accessors.read::<N>(self.output)?;
        if values.len() != self.times.len() * self.values_per_key() * lanes
            || !values.iter().flatten().all(|v| v.is_finite() && v.abs() < 1e9)
        {
            return Ok(None);
        }
        let values = values.into_iter().enumerate().map(|(i, v)| make(i, v)).collect();
        Ok(Some(Track { times: self.times.clone(), values, interpolation: self.interpolation }))
    }

    fn vectors(&self) -> Result<Option<Track<Vec3>>, MotionError> {
        self.track::<_, 3>(1, |_, v| Vec3::from(v))
    }

    /// Rotations of unit length; the tangents of a cubic track are left unchanged.
    fn rotations(&self) -> Result<Option<Track<Quat>>, MotionError> {
        let cubic = self.interpolation == Interpolation::Cubic;
        self.track::<_, 4>(1, |i, v| {
            let q = Quat::from_array(v);
            let length = q.length();
            match (cubic && i % 3 != 1, length > 1e-6) {
                (true, _) => q,
                (false, true) => q * (1.0 / length),
                (false, false) => Quat::IDENTITY,
            }
        })
    }

    fn weights(&self, lanes: usize) -> Result<Option<Track<f32>>, MotionError> {
        self.track::<_, 1>(lanes, |_, [w]| w)
    }
}
