//! For tests alone: comparison of pictures, the folder of real files, and what to do without an adapter.

mod compare;
mod data;

pub use compare::{Flip, flip, mean_color};
pub use data::{data_dir, skip_without_adapter};
