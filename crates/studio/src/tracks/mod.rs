//! Numbers of the project that follow the timeline: tracks of keys, and how moving a control writes them.
//!
//! A [`Track`] names a number, or a few that belong together, such as the direction of a light. [`Project::at`] is the
//! project at a time of the timeline; [`Overdub`] turns what is moved while the dance plays into keys.

mod animate;
mod curve;
mod leaf;
mod overdub;
mod section;

pub use animate::Animation;
pub use overdub::{Moment, Overdub};
pub use section::{Key, Track};

#[cfg(test)]
mod ride_tests;
#[cfg(test)]
mod tests;
