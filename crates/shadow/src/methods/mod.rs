//! The registry of shadow methods: a folder per method, and the lines in this file that point into it.
//!
//! Everything about a method is in its folder: its `METHOD` (names, source, size of its map), its settings, its definition on
//! the CPU and its passes on the GPU. Everything else goes through [`ShadowMethod::ALL`].

pub mod deep_opacity_maps;
pub mod density_clustering;
pub mod exact;
pub mod none;
pub mod occupancy_maps;
pub mod opacity_maps;
pub mod texels;
pub mod voxel_map;

use serde::{Deserialize, Serialize};

use crate::method::Method;

/// How the light that reaches a point inside hair is computed.
///
/// The order is that of menus and reports. Project files and the command line use [`ShadowMethod::id`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum ShadowMethod {
    /// See [`none`].
    None,
    /// See [`voxel_map`].
    #[default]
    VoxelMap,
    /// See [`opacity_maps`].
    OpacityMaps,
    /// See [`deep_opacity_maps`].
    DeepOpacityMaps,
    /// See [`density_clustering`].
    DensityClustering,
    /// See [`occupancy_maps`].
    OccupancyMaps,
    /// See [`exact`].
    Exact,
}

impl ShadowMethod {
    /// Every method, in the order of menus and reports.
    pub const ALL: &'static [Self] = &[
        Self::None,
        Self::VoxelMap,
        Self::OpacityMaps,
        Self::DeepOpacityMaps,
        Self::DensityClustering,
        Self::OccupancyMaps,
        Self::Exact,
    ];

    /// What the method's folder says about it.
    pub(crate) const fn method(self) -> &'static Method {
        match self {
            Self::None => &none::METHOD,
            Self::VoxelMap => &voxel_map::METHOD,
            Self::OpacityMaps => &opacity_maps::METHOD,
            Self::DeepOpacityMaps => &deep_opacity_maps::METHOD,
            Self::DensityClustering => &density_clustering::METHOD,
            Self::OccupancyMaps => &occupancy_maps::METHOD,
            Self::Exact => &exact::METHOD,
        }
    }
}
