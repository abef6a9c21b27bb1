//! Interpretation of the numbers of a BVH file: rotations, positions, axis and unit.
//!
//! The format specifies none of these. Each rule here is correct for the files in circulation, and the
//! settings override all of them.

use lovelock_base::words::counted;
use std::path::Path;

use glam::{Affine3A, Quat, Vec3};

use super::{
    MotionFile, MotionJoint,
    raw::{Channel, RawJoint, RawMotion},
};
use crate::{
    Keys, LengthUnit, MotionSettings, RootPosition, UpAxis,
    humanoid::{Humanoid, Role, Side},
};

/// How a joint's position channels combine with its OFFSET.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PositionMeaning {
    Replace,
    Add,
}

/// Converts a parsed file to metres, Y up, and quaternions.
pub(super) fn interpret(file: &str, raw: &RawMotion, settings: MotionSettings) -> MotionFile {
    let stem =
        Path::new(file).file_stem().map_or_else(|| file.to_owned(), |s| s.to_string_lossy().into_owned());
    let mut motion = MotionFile {
        name: stem,
        joints: raw.joints.iter().map(joint).collect(),
        frames: raw.frames,
        frame_secs: raw.frame_secs,
        keys: Keys { times: raw.frames, step_secs: (raw.frames > 1).then_some(raw.frame_secs) },
        dropped: raw.dropped.clone(),
        notes: raw.notes.clone(),
        unit_metres: 1.0,
        up: UpAxis::Y,
        format: "BVH".into(),
        ..MotionFile::default()
    };
    let rest = joint_position_meaning(raw);
    decode(raw, rest, &mut motion);
    let figure = motion.humanoid();
    if rest == PositionMeaning::Replace {
        overrule_offsets(raw, &figure, &mut motion);
    }
    let probe = Probe::new(&motion, &figure);
    motion.up = match settings.up {
        UpAxis::Auto => probe.up,
        chosen => chosen,
    };
    choose_root(raw, settings.root, &probe, &mut motion);
    choose_unit(settings.unit, &probe, &mut motion);
    motion.height_metres = standing(probe.height) * motion.unit_metres;
    convert(&mut motion);
    motion
}

/// Height of the figure of a motion that is in metres, with skull and soles.
pub(crate) fn height_of(motion: &MotionFile) -> f32 {
    standing(Probe::new(motion, &motion.humanoid()).height)
}

/// The height of a figure with skull and soles, from that of its bones.
fn standing(bones: f32) -> f32 {
    bones * ADULT_HEIGHT / ADULT
}

fn joint(raw: &RawJoint) -> MotionJoint {
    MotionJoint {
        name: raw.name.clone(),
        parent: raw.parent,
        offset: Vec3::from(raw.offset),
        end: raw.end.map(Vec3::from),
    }
}

/// Examines the joints below the root. If most positions of the first frame are close to OFFSET, they replace
/// it; if most are close to zero, they are added to it.
fn joint_position_meaning(raw: &RawMotion) -> PositionMeaning {
    let (mut replace, mut add) = (0, 0);
    let mut at = 0;
    for joint in &raw.joints {
        let numbers = &raw.rows[at..at + joint.channels.len()];
        at += joint.channels.len();
        let (position, given) = position(joint, numbers, Vec3::ZERO);
        let offset = Vec3::from(joint.offset);
        let near = 0.1 * offset.length();
        // A zero offset is ambiguous.
        if joint.parent.is_some() && given && near > 1e-6 {
            replace += u32::from(position.distance(offset) < near);
            add += u32::from(position.length() < near);
        }
    }
    if add > replace { PositionMeaning::Add } else { PositionMeaning::Replace }
}

/// The position channels of a row, and whether there are any; axes without a channel keep `missing`.
fn position(joint: &RawJoint, numbers: &[f32], missing: Vec3) -> (Vec3, bool) {
    let (mut position, mut given) = (missing, false);
    for (channel, &value) in joint.channels.iter().zip(numbers) {
        if let Channel::Position(axis) = channel {
            position[*axis] = value;
            given = true;
        }
    }
    (position, given)
}

/// The rotation channels of a row, multiplied in the order in which they are listed.
fn rotation(joint: &RawJoint, numbers: &[f32]) -> Quat {
    let turn = |channel: &Channel, degrees: f32| match channel {
        Channel::Rotation(0) => Quat::from_rotation_x(degrees.to_radians()),
        Channel::Rotation(1) => Quat::from_rotation_y(degrees.to_radians()),
        Channel::Rotation(_) => Quat::from_rotation_z(degrees.to_radians()),
        Channel::Position(_) => Quat::IDENTITY,
    };
    joint.channels.iter().zip(numbers).fold(Quat::IDENTITY, |q, (c, &v)| q * turn(c, v))
}

/// Fills rotations and positions in the file's own unit and axes; roots replace their OFFSET for now.
fn decode(raw: &RawMotion, below_root: PositionMeaning, motion: &mut MotionFile) {
    let count = raw.joints.len();
    motion.rotations.reserve_exact(count * raw.frames);
    motion.positions.reserve_exact(count * raw.frames);
    for row in raw.rows.chunks_exact(raw.channels) {
        let mut at = 0;
        for joint in &raw.joints {
            let numbers = &row[at..at + joint.channels.len()];
            at += joint.channels.len();
            let offset = Vec3::from(joint.offset);
            let adds = joint.parent.is_some() && below_root == PositionMeaning::Add;
            let missing = if adds { Vec3::ZERO } else { offset };
            let (position, given) = position(joint, numbers, missing);
            motion.positions.push(if given && adds {
                offset + position
            } else if given {
                position
            } else {
                offset
            });
            let mut q = rotation(joint, numbers).normalize();
            // On the same side of the sphere as in the previous frame, so that interpolation does not jump.
            if let Some(&before) = motion.rotations.len().checked_sub(count).map(|i| &motion.rotations[i])
                && before.dot(q) < 0.0
            {
                q = -q;
            }
            motion.rotations.push(q);
        }
    }
}

/// Where position channels overrule the OFFSET of a joint below the hips, its bone is as long as these say: the mean
/// replaces the OFFSET, so that the resting figure is the one that dances.
fn overrule_offsets(raw: &RawMotion, figure: &Humanoid, motion: &mut MotionFile) {
    let count = motion.joints.len();
    let Some(hips) = figure.get(Role::Hips) else { return };
    let step = (motion.frames / Probe::FRAMES).max(1);
    let mut overruled = 0;
    for j in hips + 1..count {
        let moves = raw.joints[j].channels.iter().any(|channel| matches!(channel, Channel::Position(_)));
        let below = std::iter::successors(Some(j), |&j| motion.joints[j].parent).any(|j| j == hips);
        if !moves || !below {
            continue;
        }
        let (mut sum, mut frames) = (Vec3::ZERO, 0.0);
        for frame in (0..motion.frames).step_by(step) {
            sum += motion.positions[frame * count + j];
            frames += 1.0;
        }
        let (mean, offset) = (sum / frames, motion.joints[j].offset);
        if mean.distance(offset) > 0.1 * mean.length().max(offset.length()) {
            motion.joints[j].offset = mean;
            overruled += 1;
        }
    }
    if overruled > 0 {
        let joints = counted(overruled, "joint overrule its offset", "joints overrule their offsets");
        motion.notes.push(format!("the positions of {joints}"));
    }
}

/// Observations about the figure over some frames of the motion, in the file's own unit and axes.
struct Probe {
    up: UpAxis,
    /// Distance from the feet to the head along the bones; 0 if unknown.
    height: f32,
    /// Whether the height is that of a figure whose head and feet were found.
    is_figure: bool,
    /// Lowest point of any joint over the observed frames, along Y and along Z.
    lowest: [f32; 2],
}

impl Probe {
    /// Number of frames that suffices to distinguish a lying figure from a standing one.
    const FRAMES: usize = 48;

    fn new(motion: &MotionFile, figure: &Humanoid) -> Self {
        let head = figure.get(Role::Head).or(figure.get(Role::Neck));
        let feet: Vec<usize> = Side::BOTH
            .iter()
            .filter_map(|&side| figure.get(Role::Foot(side)).or(figure.get(Role::Shin(side))))
            .collect();
        let step = (motion.frames / Self::FRAMES).max(1);
        let mut world: Vec<Affine3A> = Vec::new();
        let mut upward = Vec3::ZERO;
        let mut spread = Vec3::ZERO;
        let mut lowest = [f32::MAX; 2];
        for frame in (0..motion.frames).step_by(step) {
            motion.world(frame, &mut world);
            let at = |j: usize| Vec3::from(world[j].translation);
            if let (Some(head), false) = (head, feet.is_empty()) {
                let foot = feet.iter().map(|&f| at(f)).sum::<Vec3>() / feet.len() as f32;
                upward += (at(head) - foot).normalize_or_zero();
            }
            let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
            for p in world.iter().map(|w| Vec3::from(w.translation)) {
                (low, high) = (low.min(p), high.max(p));
            }
            spread += high - low;
            lowest = [lowest[0].min(low.y), lowest[1].min(low.z)];
        }
        let direction = if upward == Vec3::ZERO { spread } else { upward };
        let up = if direction.z.abs() > direction.y.abs() { UpAxis::Z } else { UpAxis::Y };
        // Along the bones as they are posed, up to the hips: what is above them, such as a root on the floor, is no part
        // of the figure.
        let hips = figure.get(Role::Hips);
        let count = motion.joints.len();
        let length = |j: usize| {
            let frames = (0..motion.frames).step_by(step);
            let (sum, frames) = frames.fold((0.0, 0.0), |(sum, frames), frame| {
                (sum + motion.positions[frame * count + j].length(), frames + 1.0_f32)
            });
            sum / frames.max(1.0)
        };
        let path = |joint: usize| {
            let up = std::iter::successors(Some(joint), |&j| motion.joints[j].parent);
            let bones = up.take_while(|&j| Some(j) != hips && motion.joints[j].parent.is_some());
            bones.map(length).sum::<f32>()
        };
        let height = match (head, feet.iter().map(|&f| path(f)).reduce(f32::max)) {
            (Some(head), Some(leg)) => path(head) + leg,
            _ => spread.max_element() / motion.frames.div_ceil(step).max(1) as f32,
        };
        Self { up, height, is_figure: head.is_some() && !feet.is_empty(), lowest }
    }
}

/// Adds the root's OFFSET to its positions if they are relative to it.
fn choose_root(raw: &RawMotion, setting: RootPosition, probe: &Probe, motion: &mut MotionFile) {
    let count = motion.joints.len();
    for (j, joint) in raw.joints.iter().enumerate().filter(|(_, joint)| joint.parent.is_none()) {
        let offset = Vec3::from(joint.offset);
        let moves = joint.channels.iter().any(|c| matches!(c, Channel::Position(_)));
        if offset == Vec3::ZERO || !moves {
            continue;
        }
        let adds = match setting {
            RootPosition::Added => true,
            RootPosition::Absolute => false,
            RootPosition::Auto => {
                let (axis, lowest) =
                    if motion.up == UpAxis::Z { (2, probe.lowest[1]) } else { (1, probe.lowest[0]) };
                let (replaced, added) = (lowest.abs(), (lowest + offset[axis]).abs());
                // Only a clear difference overrides the common interpretation.
                let adds = added + 0.2 * probe.height < replaced;
                if adds || replaced + 0.2 * probe.height < added {
                    let how = if adds { "were added to" } else { "replaced" };
                    motion.notes.push(format!(
                        "positions of `{}` {how} its offset, which puts the feet on the ground",
                        joint.name
                    ));
                }
                adds
            }
        };
        if adds {
            motion.positions.iter_mut().skip(j).step_by(count).for_each(|p| *p += offset);
        }
    }
}

/// Distance from the feet to the head joint of an adult, and the height of that adult, metres.
const ADULT: f32 = 1.5;
const ADULT_HEIGHT: f32 = 1.75;

fn choose_unit(setting: LengthUnit, probe: &Probe, motion: &mut MotionFile) {
    /// Heights at which a unit is believed, metres. Centimetres and metres are so common that children count, too.
    const COMMON: std::ops::Range<f32> = 0.9..2.3;
    const RARE: std::ops::Range<f32> = 1.4..2.1;
    if let Some(metres) = setting.metres() {
        motion.unit_metres = metres;
        return;
    }
    let candidates = [
        (LengthUnit::Centimetres, COMMON),
        (LengthUnit::Metres, COMMON),
        (LengthUnit::Decimetres, RARE),
        (LengthUnit::Millimetres, RARE),
        (LengthUnit::Inches, RARE),
        (LengthUnit::Cmu, RARE),
    ];
    let height = probe.height;
    let metres = |unit: LengthUnit| unit.metres().unwrap_or(1.0);
    let error = |unit: LengthUnit| (height * metres(unit) / ADULT).ln().abs();
    let believed = candidates.into_iter().filter(|(unit, heights)| {
        !probe.is_figure || heights.contains(&(height * metres(*unit) * ADULT_HEIGHT / ADULT))
    });
    let best = believed.map(|(unit, _)| unit).min_by(|a, b| error(*a).total_cmp(&error(*b)));
    let interpreted = match best.filter(|_| height > 0.0) {
        Some(unit) => {
            motion.unit_metres = metres(unit);
            format!("interpreted as {}", unit.label())
        }
        None if probe.is_figure && height > 1e-6 => {
            motion.unit_metres = ADULT / height;
            "in no usual unit; scaled to an adult".to_owned()
        }
        None => {
            motion.unit_metres = metres(LengthUnit::Centimetres);
            "interpreted as centimetres".to_owned()
        }
    };
    motion.notes.push(format!(
        "from foot to head the figure is {height:.1} units; {interpreted}: {:.2} m",
        height * motion.unit_metres
    ));
}

/// Converts everything to metres and Y up.
fn convert(motion: &mut MotionFile) {
    let scale = motion.unit_metres;
    let turn = match motion.up {
        UpAxis::Z => Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2),
        _ => Quat::IDENTITY,
    };
    let carry = |v: &mut Vec3| *v = turn * *v * scale;
    for joint in &mut motion.joints {
        carry(&mut joint.offset);
        joint.end.iter_mut().for_each(carry);
    }
    motion.positions.iter_mut().for_each(carry);
    if motion.up == UpAxis::Z {
        motion.notes.push("Z points up; rotated to Y up".into());
        // A rotation about an axis becomes the same rotation about the rotated axis.
        motion.rotations.iter_mut().for_each(|q| *q = (turn * *q * turn.conjugate()).normalize());
    }
}
