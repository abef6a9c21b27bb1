//! Helpers for tests: comparison of images, the folder of real data files, damaged input, a sound, waits that only
//! a hang ends, CPU time, and skipping without a graphics adapter.

pub mod clock;
mod compare;
mod data;
pub mod fuzz;
mod sound;
pub mod suite;
pub mod wait;

pub use compare::{Flip, flip, mean_color};
pub use data::{data_dir, skip_without_adapter};
pub use sound::{click_track, clicks};
