//! Dance motion of `MikuMikuDance` (`.vmd`): keys of bones with the standard names, performed by the standard skeleton.
//!
//! Every frame is computed as that program does: keys with their curves, then the legs by inverse kinematics. The result
//! is a [`MotionFile`] of 30 frames per second, which is retargeted like any other.

mod faces;
mod legs;
mod parse;
mod skeleton;
mod track;

use lovelock_base::words::counted;
use std::path::Path;

use glam::{Affine3A, Quat, Vec3};

use crate::{Keys, MotionError, MotionFile, MotionJoint, UpAxis};
use parse::{Key, RawVmd};
use skeleton::{BONES, CROWN, LEGS, TARGETS, UNIT_METRES, offset, place};
use track::{Value, value};

/// The longest motion: two hours.
const MAX_FRAMES: u32 = 30 * 7200;

/// Whether a file begins like a VMD file.
pub(crate) fn is_vmd(bytes: &[u8]) -> bool {
    bytes.starts_with(parse::MAGIC)
}

/// Reads a VMD file; `name` is used in messages.
pub(crate) fn read(name: &str, bytes: &[u8]) -> Result<MotionFile, MotionError> {
    let mut raw = parse::parse(name, bytes)?;
    let unknown = drop_unknown(&mut raw);
    let last = raw.bones.values().filter_map(|keys| keys.last()).map(|key| key.frame).max();
    let first = raw.bones.values().filter_map(|keys| keys.first()).map(|key| key.frame).min();
    let (Some(first), Some(last)) = (first, last) else {
        let found = if raw.dropped.is_empty() && raw.faces.is_empty() && unknown == 0 {
            "no key".to_owned()
        } else {
            format!("only keys of a camera, a face, or {unknown} other bones")
        };
        let wanted = "keys of bones with the standard names, such as センター";
        return Err(MotionError::Empty { file: name.into(), found, wanted });
    };
    // A frame without keys has no bytes, so a small file could otherwise claim a huge number of transforms. A file of any
    // size may last 23 minutes.
    let most = (bytes.len().max(1 << 20) / BONES.len()).min(MAX_FRAMES as usize);
    let frames = (last - first) as usize + 1;
    if frames > most {
        let problem = format!(
            "a key at frame {last}, {} after the first; must be less than {most} after it, by the size of the file",
            last - first
        );
        return Err(MotionError::malformed(name, "the keys", problem));
    }
    let stem =
        Path::new(name).file_stem().map_or_else(|| name.to_owned(), |s| s.to_string_lossy().into_owned());
    let joints = (0..BONES.len()).map(joint).collect();
    let mut motion = MotionFile {
        name: stem,
        joints,
        frames,
        frame_secs: 1.0 / 30.0,
        // A step back to the first pose takes a frame, however far apart keys are.
        keys: Keys { times: key_times(&raw), step_secs: Some(1.0 / 30.0) },
        start_secs: f64::from(first) / 30.0,
        lead_secs: f64::from(first) / 30.0,
        rotations: Vec::with_capacity(BONES.len() * frames),
        positions: Vec::with_capacity(BONES.len() * frames),
        unit_metres: UNIT_METRES,
        up: UpAxis::Y,
        height_metres: (place(8) + CROWN).y * UNIT_METRES,
        format: "VMD".into(),
        ..MotionFile::default()
    };
    let figure = Figure::new(&raw);
    let mut locals = Vec::with_capacity(BONES.len());
    for frame in first..=last {
        figure.pose(frame, &mut locals);
        for (bone, (rotation, position)) in locals.iter().enumerate() {
            // On the same side of the sphere as in the frame before, so that interpolation does not jump.
            let before = motion.rotations.len().checked_sub(BONES.len()).map(|at| motion.rotations[at]);
            let flip = before.is_some_and(|before| before.dot(*rotation) < 0.0);
            motion.rotations.push(if flip { -*rotation } else { *rotation });
            motion.positions.push((offset(bone) + *position) * UNIT_METRES);
        }
    }
    if unknown > 0 {
        let many = "bones without a standard name were left out";
        motion.notes.push(counted(unknown, "bone without a standard name was left out", many));
    }
    let by_targets = figure.legs.iter().filter(|leg| leg.is_some()).count();
    let how = if by_targets > 0 { "follow the targets of their feet" } else { "are turned joint by joint" };
    motion.notes.push(format!("performed by the standard skeleton of MikuMikuDance; the legs {how}"));
    motion.faces = faces::tracks(&raw.faces, [first, last]);
    motion.dropped = raw.dropped;
    Ok(motion)
}

/// Number of frames with keys.
fn key_times(raw: &RawVmd) -> usize {
    let frames = raw.bones.values().flatten().map(|key| key.frame);
    frames.collect::<std::collections::BTreeSet<_>>().len()
}

fn joint(bone: usize) -> MotionJoint {
    MotionJoint {
        name: BONES[bone].joint.into(),
        parent: BONES[bone].parent,
        offset: offset(bone) * UNIT_METRES,
        end: (BONES[bone].joint == "Head").then_some(CROWN * UNIT_METRES),
    }
}

/// Removes the bones that the skeleton lacks and counts their keys. Returns their number.
fn drop_unknown(raw: &mut RawVmd) -> usize {
    let known = |name: &str| {
        BONES.iter().any(|bone| bone.names.contains(&name)) || TARGETS.as_flattened().contains(&name)
    };
    let (mut bones, mut keys) = (0, 0);
    raw.bones.retain(|name, of_bone| {
        let keep = known(name);
        if !keep {
            (bones, keys) = (bones + 1, keys + of_bone.len() as u64);
        }
        keep
    });
    if keys > 0 {
        raw.dropped.insert("keys_of_other_bones".into(), keys);
    }
    bones
}

/// The tracks of a file, by the bones of the skeleton.
struct Figure<'a> {
    raw: &'a RawVmd,
    /// For each leg that follows a target: the tracks of the target's parent, of the ankle and of the toe.
    legs: [Option<[&'a [Key]; 3]>; 2],
}

impl<'a> Figure<'a> {
    fn new(raw: &'a RawVmd) -> Self {
        let legs = [0, 1].map(|side| {
            let targets = TARGETS[side].map(|name| keys(raw, name));
            // A file without targets turns its legs joint by joint.
            targets.iter().any(|keys| !keys.is_empty()).then_some(targets)
        });
        Self { raw, legs }
    }

    /// Rotation of each bone relative to its parent, and its displacement from its offset, in units and right-handed axes.
    fn pose(&self, frame: u32, locals: &mut Vec<(Quat, Vec3)>) {
        locals.clear();
        for bone in &BONES {
            let mut local = (Quat::IDENTITY, Vec3::ZERO);
            for name in bone.names {
                let value = mirrored(value(keys(self.raw, name), frame));
                local = (local.0 * value.rotation, local.1 + value.position);
            }
            locals.push(local);
        }
        // The parent of a shoulder moves the arm, but does not turn it.
        for (arm, parent) in [(10, "左肩P"), (14, "右肩P")] {
            let turned = mirrored(value(keys(self.raw, parent), frame)).rotation;
            locals[arm].0 = turned.conjugate() * locals[arm].0;
        }
        for side in 0..2 {
            let off = |name: &str| {
                let switches = self.raw.switches.get(name);
                switches.and_then(|all| all.range(..=frame).next_back()).is_some_and(|(_, on)| !on)
            };
            if let Some(targets) = self.legs[side].filter(|_| !off(TARGETS[side][1])) {
                follow(
                    LEGS[side],
                    targets.map(|keys| mirrored(value(keys, frame))),
                    !off(TARGETS[side][2]),
                    locals,
                );
            }
        }
    }
}

fn keys<'a>(raw: &'a RawVmd, name: &str) -> &'a [Key] {
    raw.bones.get(name).map_or(&[], Vec::as_slice)
}

/// From the left-handed axes of the file, in which the figure looks along -Z, to ours.
fn mirrored(value: Value) -> Value {
    let (p, q) = (value.position, value.rotation);
    Value { position: Vec3::new(p.x, p.y, -p.z), rotation: Quat::from_xyzw(-q.x, -q.y, q.z, q.w) }
}

/// Turns thigh, knee and foot so that the ankle and, with `with_toe`, the toe are at their targets.
fn follow(
    [thigh, shin, foot, toe]: [usize; 4],
    targets: [Value; 3],
    with_toe: bool,
    locals: &mut [(Quat, Vec3)],
) {
    let local = |bone: usize, locals: &[(Quat, Vec3)]| {
        Affine3A::from_rotation_translation(locals[bone].0, offset(bone) + locals[bone].1)
    };
    let world = |bone: usize, locals: &[(Quat, Vec3)]| {
        let up = std::iter::successors(Some(bone), |&bone| BONES[bone].parent);
        up.fold(Affine3A::IDENTITY, |below, bone| local(bone, locals) * below)
    };
    // The targets are on the floor below the model's root, each relative to its own rest position.
    let [above, ankle, toes] = targets;
    let at =
        |value: Value, from: Vec3| Affine3A::from_rotation_translation(value.rotation, from + value.position);
    let floor = place(foot) * Vec3::new(1.0, 0.0, 1.0);
    let parent = world(0, locals) * at(above, floor);
    let ankle_target = parent * at(ankle, place(foot) - floor);
    let toe_target = ankle_target * at(toes, place(toe) - place(foot));

    let hip = world(thigh, locals);
    let body = world(BONES[thigh].parent.unwrap_or(0), locals);
    let to_body = |point: Vec3| body.inverse().transform_vector3(point - Vec3::from(hip.translation));
    let leg =
        legs::reach(to_body(ankle_target.translation.into()), offset(shin), offset(foot), locals[thigh].0);
    (locals[thigh].0, locals[shin].0) = (leg.thigh, leg.knee);
    if with_toe {
        let above_foot = world(shin, locals);
        let placed = above_foot * local(foot, locals);
        let wanted = above_foot
            .inverse()
            .transform_vector3(Vec3::from(toe_target.translation) - Vec3::from(placed.translation));
        locals[foot].0 = (legs::swing(locals[foot].0 * offset(toe), wanted) * locals[foot].0).normalize();
    }
}
