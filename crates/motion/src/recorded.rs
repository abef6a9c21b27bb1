//! Clips of character files as motion that any other figure can take over.

use std::collections::BTreeMap;

use glam::{Affine3A, Quat, Vec3};

use lovelock_base::words::counted;

use crate::bvh::height_of;
use crate::character::Character;
use crate::clip::{Keys, LONGEST_SECS};
use crate::gltf::UNTIMED;
use crate::pose::rotation_of;
use crate::{
    Body, Clip, FaceTrack, MorphTrack, MotionError, MotionFile, MotionJoint, Pose, Track, UpAxis, pose_at,
};

/// Frames per second at which clips are sampled at least: twice as often as most clips have keys.
const RATE: f64 = 60.0;

/// Most frames per second at which keys are followed exactly.
const MAX_RATE: f64 = 480.0;

/// Most rotations of a motion: about a gigabyte.
const LIMIT: usize = 32 << 20;

/// The motion of one clip of a figure. Its zero pose is the figure's rest pose.
///
/// Of several clips, that called `wanted` is taken, otherwise the first.
pub(crate) fn motion_of(file: &str, figure: Character, wanted: &str) -> Result<MotionFile, MotionError> {
    let named = figure.clips.iter().find(|clip| clip.name == wanted);
    let Some(clip) = named.or(figure.clips.first()) else {
        return Err(MotionError::Empty {
            file: file.to_owned(),
            found: format!(
                "{} and no clip{}",
                counted(figure.body.skeleton.joints.len(), "joint", "joints"),
                untimed(&figure)
            ),
            wanted: "at least one clip of animation",
        });
    };
    let mut notes = figure.notes;
    let clips: Vec<String> = figure.clips.iter().map(|clip| clip.name.clone()).collect();
    if named.is_none() && clips.len() > 1 {
        let names: Vec<String> = clips.iter().take(20).map(|name| format!("`{name}`")).collect();
        notes.push(format!("`{}` is played; the file has the clips {}", clip.name, names.join(", ")));
    }
    let skeleton = &figure.body.skeleton;
    let joints: Vec<MotionJoint> = skeleton
        .joints
        .iter()
        .enumerate()
        .map(|(j, joint)| {
            let from = joint.parent.map_or(Vec3::ZERO, |p| skeleton.rest_position(p));
            let name = if skeleton.named.is_empty() {
                joint.name.clone()
            } else {
                skeleton.named.get(&j).cloned().unwrap_or_default()
            };
            MotionJoint { name, parent: joint.parent, offset: skeleton.rest_position(j) - from, end: None }
        })
        .collect();
    let duration = playable_secs(clip);
    let keys = clip.keys();
    let rate = rate_of(keys);
    let frames = ((duration * rate).round() as usize).saturating_add(1);
    let longest = (LIMIT as f64 / joints.len() as f64 / rate).min(LONGEST_SECS);
    if duration > LONGEST_SECS || frames.saturating_mul(joints.len()) > LIMIT {
        let problem =
            format!("lasts {duration:.0} s with {} joints; must be at most {longest:.0} s", joints.len());
        return Err(MotionError::malformed(file, format!("clip `{}`", clip.name), problem));
    }
    let frame_secs = if frames > 1 { duration / (frames - 1) as f64 } else { 1.0 / rate };
    let mut motion = MotionFile {
        name: clip.name.clone(),
        frames,
        frame_secs,
        keys,
        start_secs: clip.start_secs,
        lead_secs: clip.lead_secs,
        dropped: figure.dropped,
        notes,
        unit_metres: figure.unit_metres,
        up: UpAxis::Y,
        format: figure.format,
        clips,
        faces: faces_of(&figure.body, clip),
        ..MotionFile::default()
    };
    let at_rest: Vec<Quat> = skeleton.world_at_rest.iter().map(|w| rotation_of(&w.matrix3)).collect();
    let (mut pose, mut turns) = (Pose::default(), vec![Quat::IDENTITY; joints.len()]);
    motion.rotations.reserve_exact(frames * joints.len());
    motion.positions.reserve_exact(frames * joints.len());
    // The end of a clip would wrap to its start.
    let held = Clip { duration_secs: duration + 1.0, ..(**clip).clone().played_once() };
    for frame in 0..frames {
        pose_at(&figure.body, Some(&held), frame as f64 * frame_secs, &mut pose);
        for (j, joint) in joints.iter().enumerate() {
            let world = &pose.world_from_joint[j];
            turns[j] = (rotation_of(&world.matrix3) * at_rest[j].conjugate()).normalize();
            let (turn, from) = joint
                .parent
                .map_or((Quat::IDENTITY, Vec3::ZERO), |p| (turns[p], position(&pose.world_from_joint[p])));
            let mut local = (turn.conjugate() * turns[j]).normalize();
            // On the same side of the sphere as in the previous frame, so that interpolation does not jump.
            if let Some(at) = motion.rotations.len().checked_sub(joints.len())
                && motion.rotations[at].dot(local) < 0.0
            {
                local = -local;
            }
            motion.rotations.push(local);
            motion.positions.push(turn.conjugate() * (position(world) - from));
        }
    }
    motion.joints = joints;
    motion.height_metres = height_of(&motion);
    motion.note_shape();
    Ok(motion)
}

/// The face of a clip, by the names of expressions and morph targets. Several tracks of one name are those of several meshes.
fn faces_of(body: &Body, clip: &Clip) -> Vec<FaceTrack> {
    let mut faces: BTreeMap<&str, Track<f32>> = BTreeMap::new();
    for of in &clip.expressions {
        if let Some(expression) = body.expressions.get(of.expression) {
            faces.entry(&expression.name).or_insert_with(|| of.track.clone());
        }
    }
    for MorphTrack { first, count, track } in &clip.morphs {
        for lane in 0..*count {
            let Some(morph) = body.skin.morphs.get(first + lane) else { break };
            faces.entry(&morph.name).or_insert_with(|| Track {
                times: track.times.clone(),
                values: track.values.iter().skip(lane).step_by(*count).copied().collect(),
                interpolation: track.interpolation,
            });
        }
    }
    faces.into_iter().map(|(name, track)| FaceTrack { name: name.to_owned(), track }).collect()
}

/// What an error about a file without a clip says about channels that were dropped for the times of their keys.
fn untimed(figure: &Character) -> String {
    let count = figure.dropped.get(UNTIMED).copied().unwrap_or(0);
    if count == 0 {
        return String::new();
    }
    let channels = counted(count, "channel", "channels");
    format!(" besides {channels} with keys at times that do not ascend, or are more than 1000000 s from 0")
}

/// Frames per second of samples that meet the keys of a clip, if these are evenly spaced: a multiple of their rate.
fn rate_of(keys: Keys) -> f64 {
    let step = keys.step_secs.filter(|step| *step >= 1.0 / MAX_RATE);
    step.map_or(RATE, |step| {
        let rate = 1.0 / step;
        rate * (RATE / rate - 1e-3).ceil().max(1.0)
    })
}

fn position(transform: &Affine3A) -> Vec3 {
    transform.translation.into()
}

/// Duration of the keys of a clip, seconds.
fn playable_secs(clip: &Clip) -> f64 {
    let secs = clip.keys_end_secs();
    if secs.is_finite() { secs } else { 0.0 }
}
