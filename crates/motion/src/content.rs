//! What a file of a character or a motion contains.

/// What an FBX or USD file contains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FigureContent {
    /// Curves, with or without a body; in USD only.
    Curves,
    /// A mesh, with or without clips.
    Body,
    /// Animation and no mesh.
    Clip,
    /// None of these.
    Nothing,
}
