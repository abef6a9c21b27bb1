//! The shadow methods, one folder each.

pub mod deep_opacity_maps;
pub mod density_clustering;
pub mod exact;
pub mod none;
pub mod occupancy_maps;
pub mod opacity_maps;
pub mod texels;
pub mod voxel_map;
