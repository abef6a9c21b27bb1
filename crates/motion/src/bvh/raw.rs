//! The content of a BVH file before its numbers are interpreted.

use std::collections::BTreeMap;

/// One number of a row: a position along an axis or a rotation about it (0 for X, 1 for Y, 2 for Z).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Channel {
    Position(usize),
    Rotation(usize),
}

#[derive(Clone, Debug, Default)]
pub(super) struct RawJoint {
    pub(super) name: String,
    pub(super) parent: Option<usize>,
    pub(super) offset: [f32; 3],
    pub(super) channels: Vec<Channel>,
    pub(super) end: Option<[f32; 3]>,
}

/// The content of a file, in its own unit and axes.
#[derive(Clone, Debug, Default)]
pub(super) struct RawMotion {
    pub(super) joints: Vec<RawJoint>,
    /// Numbers per row.
    pub(super) channels: usize,
    /// Rows, one after the other; all numbers are finite.
    pub(super) rows: Vec<f32>,
    pub(super) frames: usize,
    pub(super) frame_secs: f64,
    pub(super) dropped: BTreeMap<String, u64>,
    pub(super) notes: Vec<String>,
}

/// What was found in place of something else, for errors.
pub(super) fn quote(word: Option<&str>) -> String {
    word.map_or_else(
        || "the file ends here".into(),
        |w| format!("found `{}`", w.chars().take(40).collect::<String>()),
    )
}
