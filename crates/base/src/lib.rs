//! Small parts that several crates need and none owns. Nothing here depends on another crate of the workspace.

pub mod clock;
pub mod direction_map;
mod failure;
pub mod memory;
pub mod numbers;
pub mod random;
pub mod settings;
pub mod simd;
pub mod speed;
pub mod statistics;
pub mod triangle;
pub mod watch;
mod whole_part;
pub mod words;

pub use failure::Failure;
