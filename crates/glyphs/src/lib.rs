//! Glyphs of any script, from the fonts of the system.
//!
//! [`Fonts`] finds the font that has a character. [`pieces()`] puts the pieces of a line into the order in which they are seen, and
//! [`line()`] shapes and draws a line: letters joined, marks placed, right-to-left scripts from right to left. Text boxes and line breaks
//! are not treated. The fonts are read when a text first needs them.

mod coverage;
mod fonts;
mod line;
mod order;
mod picture;
mod script;

pub use fonts::{Face, Fonts};
pub use line::{Glyph, Ink, Line, cluster, line};
pub use order::{Piece, pieces, seen, visual_words};
pub use script::Script;
