//! Small parts that several crates need and none owns. One thing stands here once; no crate of the workspace is below.

pub mod glb;
pub mod numbers;
