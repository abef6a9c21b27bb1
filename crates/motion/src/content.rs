//! What a file of a character or a motion contains, without reading the body.

use std::path::Path;

use crate::error::read_file;
use crate::load::FILE_LIMIT;
use crate::{MotionError, fbx, usd};

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

/// What an FBX or USD file contains; `None` for a file of another format.
///
/// # Errors
/// For a file that cannot be read.
pub fn figure_content(path: &Path) -> Result<Option<FigureContent>, MotionError> {
    let bytes = read_file(path, FILE_LIMIT)?;
    let file = path.display().to_string();
    if fbx::is_fbx(&bytes) {
        fbx::content(&file, &bytes).map(Some)
    } else if usd::is_usd(&bytes) {
        usd::content(&file, &bytes).map(Some)
    } else {
        Ok(None)
    }
}
