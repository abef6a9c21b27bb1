//! Animation stacks as clips.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{Quat, Vec3};
use ufbx::{AllocatorOpts, AnimStack, BakeOpts, BakedAnim, ElementType, Scene};

use super::mesh::{MorphsOfChannels, weights_of_shapes};
use super::nodes::Nodes;
use super::{quat, vec3};
use crate::{Clip, Interpolation, JointTracks, Keys, MorphTrack, Track};

/// Samples per second of curves that are not linear.
const RATE: f64 = 60.0;

/// Most memory of the keys of one clip, bytes.
const MEMORY_LIMIT: usize = 2 << 30;

/// Reads every animation stack that moves a joint or a morph target.
pub(super) fn read_clips(
    scene: &Scene,
    nodes: &Nodes,
    morphs: &MorphsOfChannels,
    notes: &mut Vec<String>,
) -> Vec<Clip> {
    let mut clips = Vec::new();
    for stack in &scene.anim_stacks {
        let allocator = || AllocatorOpts { memory_limit: MEMORY_LIMIT, ..AllocatorOpts::default() };
        let options = BakeOpts {
            temp_allocator: allocator(),
            result_allocator: allocator(),
            resample_rate: RATE,
            ..BakeOpts::default()
        };
        let baked = match ufbx::bake_anim(scene, &stack.anim, options) {
            Ok(baked) => baked,
            Err(error) => {
                let why = error.description.to_string().to_lowercase();
                notes.push(format!("the animation `{}` could not be read ({why})", stack.element.name));
                continue;
            }
        };
        let mut clip = Clip { name: stack.element.name.to_string(), ..Clip::default() };
        let keys = key_times(stack, nodes, morphs);
        let ends = keys.iter().copied().map(|time| [time, time]);
        let keyed = ends
            .reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
            .unwrap_or([baked.playback_time_begin, baked.playback_time_end].map(|secs| secs as f32));
        // Curves of angles are sampled, so that tracks have more keys than the file.
        clip.file_keys = (!keys.is_empty()).then(|| Keys::at(keys));
        clip.joints = joints(&baked, nodes, keyed);
        clip.morphs = morph_tracks(&baked, morphs);
        if clip.joints.is_empty() && clip.morphs.is_empty() {
            notes.push(format!("the animation `{}` moves nothing", clip.name));
            continue;
        }
        // The start of a stack is where a timeline begins to show it; only one after 0 was a choice.
        clips.push(clip.starting_at_first_key(stack.time_begin.max(0.0)));
    }
    clips
}

/// Times of the keys of the curves that move joints or morph targets, seconds, in no order. What does not change is sampled at the ends
/// of the stack's timeline, where no key needs to be.
fn key_times(stack: &AnimStack, nodes: &Nodes, morphs: &MorphsOfChannels) -> Vec<f32> {
    let props = stack.layers.iter().flat_map(|layer| &layer.anim_props);
    let moving = props.filter(|prop| {
        nodes.joint(prop.element.typed_id).is_some() && prop.element.type_ == ElementType::Node
            || morphs.contains_key(&prop.element.element_id)
    });
    let mut times: Vec<f32> = Vec::new();
    for curve in moving.flat_map(|prop| prop.anim_value.curves.iter().flatten()) {
        let is_late = |key: Option<&ufbx::Keyframe>| key.is_some_and(|key| key.time.abs() >= LATEST_SECS);
        if is_late(curve.keyframes.first()) || is_late(curve.keyframes.last()) {
            continue;
        }
        let keys = || curve.keyframes.iter().map(|key| key.time as f32);
        // Most curves have the same times.
        let before = times.len().checked_sub(keys().count());
        if before.is_none_or(|before| !times[before..].iter().copied().eq(keys())) {
            times.extend(keys());
        }
    }
    times
}

fn joints(baked: &BakedAnim, nodes: &Nodes, keyed: [f32; 2]) -> Vec<JointTracks> {
    let mut joints = BTreeMap::new();
    for node in &baked.nodes {
        let Some(joint) = nodes.joint(node.typed_id) else { continue };
        let vectors = |keys: &[ufbx::BakedVec3], is_constant: bool| {
            let track = track(keys.iter().map(|key| (key.time, vec3(key.value))))?;
            let track = if is_constant { held(&track, keyed) } else { track };
            track.values.iter().all(|v: &Vec3| v.is_finite()).then_some(track)
        };
        let rotation = track(node.rotation_keys.iter().map(|key| (key.time, quat(key.value))));
        let tracks = JointTracks {
            joint,
            translation: vectors(&node.translation_keys, node.constant_translation),
            rotation: rotation.map(
                |track: Track<Quat>| {
                    if node.constant_rotation { held(&track, keyed) } else { track }
                },
            ),
            scale: vectors(&node.scale_keys, node.constant_scale),
        };
        joints.insert(joint, tracks);
    }
    joints.into_values().collect()
}

fn morph_tracks(baked: &BakedAnim, morphs: &MorphsOfChannels) -> Vec<MorphTrack> {
    let mut tracks = Vec::new();
    for element in &baked.elements {
        let Some(lists) = morphs.get(&element.element_id) else { continue };
        let driven = element.props.iter().filter(|prop| &*prop.name == "DeformPercent");
        for (prop, shapes) in driven.flat_map(|prop| lists.iter().map(move |shapes| (prop, shapes))) {
            for (k, shape) in shapes.iter().enumerate() {
                // The property is a percentage.
                let weight = |percent: f64| weights_of_shapes(shapes, percent / 100.0)[k];
                let keys = prop.keys.iter().map(|key| (key.time, weight(key.value.x)));
                if let Some(track) = track(keys).filter(|track| track.values.iter().all(|w| w.is_finite())) {
                    tracks.push(MorphTrack { first: shape.morph, count: 1, track });
                }
            }
        }
    }
    tracks
}

/// Times further from 0 are errors, seconds.
const LATEST_SECS: f64 = 1e6;

/// A track of one value over the range of the keys.
fn held<T: Copy>(track: &Track<T>, keyed: [f32; 2]) -> Track<T> {
    let values = track.values.iter().take(1).cycle().take(2).copied().collect();
    Track { times: keyed.into(), values, interpolation: track.interpolation }
}

/// Keys as a track: times increasing.
fn track<T>(keys: impl Iterator<Item = (f64, T)>) -> Option<Track<T>> {
    let (mut times, mut values): (Vec<f32>, Vec<T>) = (Vec::new(), Vec::new());
    for (time, value) in keys.filter(|(time, _)| time.is_finite() && time.abs() < LATEST_SECS) {
        let time = time as f32;
        // Two keys at one time are a step; the later holds.
        if times.last().is_some_and(|&last| time < last) {
            continue;
        }
        times.push(time);
        values.push(value);
    }
    let times: Arc<[f32]> = times.into();
    (!values.is_empty()).then_some(Track { times, values, interpolation: Interpolation::Linear })
}
