//! A character file: what every reader hands over, and what is then decided for all formats alike: unit, direction of the face, head.

mod axes;
mod draft;
mod hair;
mod headed;
mod hidden;

use std::{collections::BTreeMap, sync::Arc};

use crate::{Body, Clip};

pub(crate) use draft::{Axes, Draft};
pub(crate) use hair::{WornHair, names_hair};
pub(crate) use hidden::{Hidden, HiddenMeshes};

/// A character file: a body, its clips, and what was lost.
#[derive(Clone, Debug, Default)]
pub struct Character {
    /// The body.
    pub body: Arc<Body>,
    /// Its clips; may be empty.
    pub clips: Vec<Arc<Clip>>,
    /// Counts of what was left out; empty if everything was read.
    pub dropped: BTreeMap<String, u64>,
    /// Guesses and other remarks, as sentences.
    pub notes: Vec<String>,
    /// The format, such as `glTF 2.0 (binary)`.
    pub format: String,
    /// Joints used by skins; all nodes with meshes if there is no skin.
    pub joints: usize,
    /// Number of skins.
    pub skins: usize,
    /// Metres per unit of the file.
    pub unit_metres: f32,
}

/// What an error adds about a file without a body that has clips.
pub(crate) fn only_motion(clips: usize) -> &'static str {
    if clips > 0 { " (a clip without a body is opened by *Motion file*)" } else { "" }
}
