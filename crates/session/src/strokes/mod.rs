//! Strokes of brushes on the hair of an engine: of the pointer, and recorded ones.
//!
//! - [`Stroke`]: one stroke while it is made, with [`StrokeStart`] and [`StrokeReport`] as its messages.
//! - [`play_strokes`]: recorded strokes, played on a project.

mod live;
#[cfg(test)]
mod live_tests;
mod played;

pub use live::{Stroke, StrokeReport, StrokeStart};
pub use played::{
    PlayStrokes, PlayedBrush, STROKES_EXTENSION, SeeStrokes, StrokesReport, play_strokes, read_strokes,
};
