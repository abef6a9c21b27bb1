//! Numbers of the project that follow the timeline: tracks of keys.
//!
//! A [`Track`] names a number, or a few that belong together, such as the direction of a light.

pub(crate) mod curve;
mod section;

pub use section::{Key, MORPH_TARGET, STACK_TARGET, Track};
