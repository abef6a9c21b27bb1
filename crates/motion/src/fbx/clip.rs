//! Animation stacks as clips.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{Quat, Vec3};
use ufbx::{AllocatorOpts, BakeOpts, BakedAnim, Scene};

use super::mesh::{MorphsOfChannels, weights_of_shapes};
use super::nodes::Nodes;
use super::{quat, vec3};
use crate::{Clip, Interpolation, JointTracks, MorphTrack, Track};

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
            trim_start_time: true,
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
        clip.joints = joints(&baked, nodes);
        clip.morphs = morph_tracks(&baked, morphs);
        if clip.joints.is_empty() && clip.morphs.is_empty() {
            notes.push(format!("the animation `{}` moves nothing", clip.name));
            continue;
        }
        clip.duration_secs = clip.keys_end_secs();
        clips.push(clip);
    }
    clips
}

fn joints(baked: &BakedAnim, nodes: &Nodes) -> Vec<JointTracks> {
    let mut joints = BTreeMap::new();
    for node in &baked.nodes {
        let Some(joint) = nodes.joint(node.typed_id) else { continue };
        let vectors = |keys: &[ufbx::BakedVec3]| {
            track(keys.iter().map(|key| (key.time, vec3(key.value))))
                .filter(|track: &Track<Vec3>| track.values.iter().all(|v| v.is_finite()))
        };
        let tracks = JointTracks {
            joint,
            translation: vectors(&node.translation_keys),
            rotation: track(node.rotation_keys.iter().map(|key| (key.time, quat(key.value))))
                .map(|track: Track<Quat>| track),
            scale: vectors(&node.scale_keys),
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

/// Keys as a track: times from 0 on, increasing.
fn track<T>(keys: impl Iterator<Item = (f64, T)>) -> Option<Track<T>> {
    let (mut times, mut values): (Vec<f32>, Vec<T>) = (Vec::new(), Vec::new());
    for (time, value) in keys.filter(|(time, _)| time.is_finite() && *time < 1e6) {
        let time = time.max(0.0) as f32;
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
