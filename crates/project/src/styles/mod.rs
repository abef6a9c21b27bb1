//! Hairstyles as documents of their own: how hair grows and is styled, its colours, and how it moves.
//!
//! - [`Style`]: the document, and its text.
//! - [`mod@shipped`]: the styles that are part of the program.
//! - [`StyleParts`]: what of a style is applied to a project, by [`Project::apply_style`].
//!
//! [`Project::apply_style`]: crate::Project::apply_style

mod apply;
mod document;
mod mix;
mod morph;
mod motion;
mod own;
pub mod shipped;

pub use document::{STYLE_EXTENSION, Style};
pub use mix::StyleParts;
pub(crate) use morph::MovesMix;
pub use own::{OwnStyle, OwnStyles, own_id};
pub use shipped::{Shipped, shipped, unknown_style};

#[cfg(test)]
mod morph_tests;
#[cfg(test)]
mod tests;
