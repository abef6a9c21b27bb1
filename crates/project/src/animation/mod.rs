//! The project at a time of its timeline, and how moving a control writes keys.
//!
//! [`Project::at`](crate::Project::at) is the project at a time of the timeline; [`Overdub`] turns what is moved while the dance
//! plays into keys.

mod animate;
mod keys;
mod leaf;
mod overdub;
mod style;

pub use animate::Animation;
pub use leaf::{is_keyable, key_numbers};
pub use overdub::{Moment, Overdub};
pub use style::{StyleTracks, StyleValues};

#[cfg(test)]
mod keys_tests;
#[cfg(test)]
mod ride_tests;
#[cfg(test)]
mod style_tests;
#[cfg(test)]
mod tests;
