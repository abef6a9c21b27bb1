//! Brushes: tools that change the displayed hair, and write the change into a layer of the style.
//!
//! A [`Brush`] is one stroke. It gets the guides as they move at one instant, moves those that its tool touches, and carries each change
//! back to the rest shape: a motion turns every link at rest to the one that is seen, and what it turns to the new place of the link becomes
//! the link at rest. What a stroke did is added to [`HandEdits`](lovelock_style::hand::HandEdits).
//!
//! Strokes can be recorded and played: see [`StrokeFile`].

mod brush;
mod carry;
mod chain;
mod fall;
mod file;
mod settings;
mod stroke;
mod tool;
mod tools;
mod touch;

#[cfg(test)]
mod tests;

pub use brush::{Brush, BrushSurroundings};
pub use file::{RecordedStroke, StrokeFile};
pub use settings::{BrushMirror, BrushSettings};
pub use stroke::StrokeSample;
pub use tool::Tool;
