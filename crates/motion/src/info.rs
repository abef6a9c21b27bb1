//! The summaries of characters and motions that `lovelock info` prints.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::surface_info::{self, ExpressionInfo, ImageInfo, MaterialInfo};
use crate::{Character, MotionFile};

/// One clip of a character.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ClipInfo {
    /// Its name in the file.
    pub name: String,
    /// Its duration, seconds.
    pub duration_secs: f64,
    /// Time of its first key on the clock of the file, seconds.
    pub start_secs: f64,
    /// Time of its last key on that clock, seconds.
    pub end_secs: f64,
    /// Whether it repeats without a jump.
    pub loops: bool,
}

/// Summary of a character file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CharacterInfo {
    /// Its format.
    pub format: String,
    /// Counts of what was left out.
    pub dropped: BTreeMap<String, u64>,
    /// Guesses and other remarks.
    pub notes: Vec<String>,
    /// Joints used by skins; nodes with meshes if there is no skin.
    pub joints: usize,
    /// Number of skins.
    pub skins: usize,
    /// Vertices of all meshes.
    pub vertices: usize,
    /// Triangles of all meshes.
    pub triangles: usize,
    /// Number of morph targets.
    pub morph_targets: usize,
    /// Names of the morph targets.
    pub morph_target_names: Vec<String>,
    /// Its expressions.
    pub expressions: Vec<ExpressionInfo>,
    /// Its materials; empty if all of it has the default one.
    pub materials: Vec<MaterialInfo>,
    /// The images that materials use.
    pub textures: Vec<ImageInfo>,
    /// Height of the rest pose, metres.
    pub height_m: f32,
    /// Name of the joint that was chosen as the head.
    pub head: String,
    /// Its clips.
    pub clips: Vec<ClipInfo>,
}

impl Character {
    /// The summary for the command line.
    pub fn info(&self) -> CharacterInfo {
        let body = &self.body;
        CharacterInfo {
            format: self.format.clone(),
            dropped: self.dropped.clone(),
            notes: self.notes.clone(),
            joints: self.joints,
            skins: self.skins,
            vertices: body.mesh.positions.len(),
            triangles: body.mesh.triangles.len(),
            morph_targets: body.skin.morphs.len(),
            morph_target_names: body.skin.morphs.iter().map(|morph| morph.name.clone()).collect(),
            expressions: surface_info::expressions(&body.expressions),
            materials: surface_info::materials(body),
            textures: surface_info::images(&body.images),
            height_m: body.height(),
            head: body.skeleton.joints.get(body.head_joint).map_or_else(String::new, |j| j.name.clone()),
            clips: self
                .clips
                .iter()
                .map(|c| ClipInfo {
                    name: c.name.clone(),
                    duration_secs: c.duration_secs,
                    start_secs: c.start_secs,
                    end_secs: c.start_secs + c.keys_end_secs(),
                    loops: c.loops,
                })
                .collect(),
        }
    }
}

/// Summary of a motion file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MotionInfo {
    /// Its format.
    pub format: String,
    /// Counts of what was left out.
    pub dropped: BTreeMap<String, u64>,
    /// Guesses and other remarks.
    pub notes: Vec<String>,
    /// Number of joints, without end sites.
    pub joints: usize,
    /// Number of frames that are played: the rows, or samples of the keys.
    pub frames: usize,
    /// Time between these frames, seconds.
    pub frame_secs: f64,
    /// Number of times at which the file has keys: its rows, where it has these.
    pub keys: usize,
    /// The time of which all keys are multiples, counted from the first, seconds: that between two of them if none is left out. `None` for
    /// keys that are spaced unevenly.
    pub key_secs: Option<f64>,
    /// Time of the first row on the clock of the file, seconds.
    pub start_secs: f64,
    /// Time of the last row on that clock, seconds.
    pub end_secs: f64,
    /// Whether it repeats without a jump, with or without a last row that repeats the first.
    pub loops: bool,
    /// Metres per unit of the file.
    pub unit_metres: f32,
    /// Height of the figure as it is posed, metres.
    pub height_m: f32,
}

impl MotionFile {
    /// The summary for the command line.
    pub fn info(&self) -> MotionInfo {
        MotionInfo {
            format: self.format.clone(),
            dropped: self.dropped.clone(),
            notes: self.notes.clone(),
            joints: self.joints.len(),
            frames: self.frames,
            frame_secs: self.frame_secs,
            keys: self.keys.times,
            key_secs: self.keys.step_secs,
            start_secs: self.start_secs,
            end_secs: self.start_secs + self.frames.saturating_sub(1) as f64 * self.frame_secs,
            loops: self.loops(),
            unit_metres: self.unit_metres,
            height_m: self.height_metres,
        }
    }
}
