//! Motion capture from BVH files.
//!
//! The text is parsed tolerantly ([`parse`]), its table of frames row by row ([`rows`]). The meaning of its numbers (unit, axis, whether positions are
//! added to offsets) is decided in [`interpret`].

mod interpret;
mod parse;
mod raw;
mod rows;
mod write;

use std::collections::BTreeMap;

use glam::{Affine3A, Quat, Vec3};

use crate::{FaceTrack, Keys, MotionError, MotionSettings, UpAxis, humanoid::Humanoid};

pub(crate) use interpret::height_of;
pub use write::write_bvh;

/// One joint of a motion file.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionJoint {
    /// Its name, which may contain spaces.
    pub name: String,
    /// Index of its parent, always smaller than its own.
    pub parent: Option<usize>,
    /// Its rest position relative to the parent, metres, Y up.
    pub offset: Vec3,
    /// End of the bone relative to the joint, for a joint without children, metres, Y up.
    pub end: Option<Vec3>,
}

/// A motion file, converted to metres and Y up.
#[derive(Clone, Debug, Default)]
pub struct MotionFile {
    /// The file's name without folder and extension.
    pub name: String,
    /// Its joints, parents first.
    pub joints: Vec<MotionJoint>,
    /// Number of frames.
    pub frames: usize,
    /// Time between frames, seconds.
    pub frame_secs: f64,
    /// The keys of the file: its rows, or the keys between which frames were taken.
    pub keys: Keys,
    /// Time of the first frame on the clock of the file, seconds.
    pub start_secs: f64,
    /// As [`crate::Clip::lead_secs`].
    pub lead_secs: f64,
    /// Rotation of each joint relative to its parent: frame by frame, joint by joint.
    pub rotations: Vec<Quat>,
    /// Position of each joint relative to its parent, metres, in the same order.
    pub positions: Vec<Vec3>,
    /// The weights of a face over time, by name.
    pub faces: Vec<FaceTrack>,
    /// Counts of what was left out.
    pub dropped: BTreeMap<String, u64>,
    /// Guesses and other remarks.
    pub notes: Vec<String>,
    /// Metres per unit of the file.
    pub unit_metres: f32,
    /// The axis that pointed up in the file.
    pub up: UpAxis,
    /// The format, such as `BVH`.
    pub format: String,
    /// Height of the figure as it is posed, metres: the bones from the feet to the head, and the usual share of skull and
    /// soles.
    pub height_metres: f32,
    /// Names of the clips of the file; empty for a format that holds one motion.
    pub clips: Vec<String>,
}

impl MotionFile {
    /// World transforms of all joints in one frame; frames past the end repeat the last.
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

    /// Frames from one key of the file to the next.
    pub(crate) fn frames_per_key(&self) -> usize {
        let frames = self.keys.step_secs.map_or(1.0, |step| (step / self.frame_secs).round());
        if (1.0..=1e6).contains(&frames) { frames as usize } else { 1 }
    }

    /// The roles of the joints.
    pub(crate) fn humanoid(&self) -> Humanoid {
        let names: Vec<&str> = self.joints.iter().map(|j| j.name.as_str()).collect();
        let parents: Vec<Option<usize>> = self.joints.iter().map(|j| j.parent).collect();
        let figure = Humanoid::new(&names, &parents).or_by_shape(&names, &parents, &self.rest());
        if self.rotations.len() < names.len() {
            return figure;
        }
        // A zero pose may be no pose of a figure; the first frame is one.
        let mut first = Vec::new();
        self.world(0, &mut first);
        let places: Vec<Vec3> = first.iter().map(|world| world.translation.into()).collect();
        figure.or_by_shape(&names, &parents, &places)
    }

    /// Adds a note if the names of the joints do not tell which bones they are.
    pub(crate) fn note_shape(&mut self) {
        if self.humanoid().is_by_shape {
            let note =
                "the names of the joints do not tell all limbs; they are told by the shape of the skeleton";
            self.notes.push(note.into());
        }
    }

    /// Positions of all joints with zero rotations, metres.
    pub fn rest(&self) -> Vec<Vec3> {
        let mut rest: Vec<Vec3> = Vec::with_capacity(self.joints.len());
        for joint in &self.joints {
            rest.push(joint.parent.map_or(Vec3::ZERO, |p| rest[p]) + joint.offset);
        }
        rest
    }
}

/// Reads a BVH file from bytes; `name` is used in messages.
pub(crate) fn read(name: &str, bytes: &[u8], settings: MotionSettings) -> Result<MotionFile, MotionError> {
    let raw = parse::parse(name, bytes)?;
    let mut motion = interpret::interpret(name, &raw, settings);
    motion.note_shape();
    Ok(motion)
}
