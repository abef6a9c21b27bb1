//! Motion capture from BVH files.
//!
//! The text is parsed tolerantly ([`parse`]); what its numbers mean (unit, axis, whether positions add to offsets)
//! is decided in [`interpret`].

mod interpret;
mod parse;

use std::{collections::BTreeMap, path::Path};

use glam::{Affine3A, Quat, Vec3};

use crate::{MotionError, MotionSettings, UpAxis, error::read_file, humanoid::Humanoid};

/// Largest file that is read.
const FILE_LIMIT: u64 = 1 << 30;

/// One joint of a motion file.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionJoint {
    /// Its name, which may hold spaces.
    pub name: String,
    /// Index of its parent, always smaller than its own.
    pub parent: Option<usize>,
    /// Its place relative to the parent at rest, metres, Y up.
    pub offset: Vec3,
    /// Where the bone ends, for a joint without children, relative to it, metres, Y up.
    pub end: Option<Vec3>,
}

/// A motion file, brought to metres and Y up.
#[derive(Clone, Debug, Default)]
pub struct MotionFile {
    /// The file's name without folder and ending.
    pub name: String,
    /// Its joints, parents first.
    pub joints: Vec<MotionJoint>,
    /// Number of frames.
    pub frames: usize,
    /// Time between frames, seconds.
    pub frame_secs: f64,
    /// Rotation of each joint relative to its parent: frame after frame, joint after joint.
    pub rotations: Vec<Quat>,
    /// Position of each joint relative to its parent, metres, laid out likewise.
    pub positions: Vec<Vec3>,
    /// What was left out, with counts.
    pub dropped: BTreeMap<String, u64>,
    /// Guesses and other things to know.
    pub notes: Vec<String>,
    /// Metres of one unit of the file.
    pub unit_metres: f32,
    /// The axis of the file that pointed up.
    pub up: UpAxis,
}

impl MotionFile {
    /// Transforms of all joints to the world in one frame; frames past the end hold the last.
    pub fn world(&self, frame: usize, world: &mut Vec<Affine3A>) {
        let first = frame.min(self.frames.saturating_sub(1)) * self.joints.len();
        world.clear();
        for (j, joint) in self.joints.iter().enumerate() {
            let local =
                Affine3A::from_rotation_translation(self.rotations[first + j], self.positions[first + j]);
            let parent = joint.parent.map(|p| world[p]);
            world.push(parent.map_or(local, |p| p * local));
        }
    }

    /// The roles of the joints.
    pub(crate) fn humanoid(&self) -> Humanoid {
        Humanoid::new(
            &self.joints.iter().map(|j| j.name.as_str()).collect::<Vec<_>>(),
            &self.joints.iter().map(|j| j.parent).collect::<Vec<_>>(),
        )
    }

    /// Places of all joints with every rotation at zero, metres.
    pub fn rest(&self) -> Vec<Vec3> {
        let mut rest: Vec<Vec3> = Vec::with_capacity(self.joints.len());
        for joint in &self.joints {
            rest.push(joint.parent.map_or(Vec3::ZERO, |p| rest[p]) + joint.offset);
        }
        rest
    }
}

/// Loads a BVH file, guessing what it does not say.
///
/// # Errors
/// Refuses text that is no BVH, naming the line, and files without joints or frames.
pub fn load_motion(path: &Path) -> Result<MotionFile, MotionError> {
    load_motion_with(path, MotionSettings::default())
}

/// Loads a BVH file.
///
/// # Errors
/// As [`load_motion`].
pub fn load_motion_with(path: &Path, settings: MotionSettings) -> Result<MotionFile, MotionError> {
    let bytes = read_file(path, FILE_LIMIT)?;
    load_motion_bytes(&path.display().to_string(), &bytes, settings)
}

/// Loads a BVH file from bytes; `name` is what messages call it.
///
/// # Errors
/// As [`load_motion`].
pub fn load_motion_bytes(
    name: &str,
    bytes: &[u8],
    settings: MotionSettings,
) -> Result<MotionFile, MotionError> {
    let raw = parse::parse(name, bytes)?;
    Ok(interpret::interpret(name, &raw, settings))
}
