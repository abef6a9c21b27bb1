//! The shadow methods, one folder each.

pub mod none;
pub mod voxel_map;
