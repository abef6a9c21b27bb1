//! The registry of shadow methods: a folder per method, and the lines in this file that point into it.
//!
//! Everything about a method is in its folder: its `METHOD` (names, source, size of its map), its settings, its definition on
//! the CPU and its passes on the GPU. Everything else goes through [`ShadowMethod::ALL`].

pub mod deep_opacity_maps;
pub mod density_clustering;
pub mod exact;
mod method;
pub mod none;
pub mod occupancy_maps;
pub mod opacity_maps;
pub mod texels;
pub mod voxel_map;

pub use method::{MapKind, MapSize, UnknownShadowMethod, all_shaders, cpu_shadow, gpu_shadow};

use lovelock_base::settings::AnySettings;
use serde::{Deserialize, Serialize};

use method::Method;

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

/// The method in use, and the settings of every method, so that switching the method keeps them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ShadowSettings {
    /// The method in use.
    pub method: ShadowMethod,
    /// See [`voxel_map`].
    pub voxel_map: voxel_map::VoxelMapSettings,
    /// See [`opacity_maps`].
    pub opacity_maps: opacity_maps::OpacityMapsSettings,
    /// See [`deep_opacity_maps`].
    pub deep_opacity_maps: deep_opacity_maps::DeepOpacityMapsSettings,
    /// See [`density_clustering`].
    pub density_clustering: density_clustering::DensityClusteringSettings,
    /// See [`occupancy_maps`].
    pub occupancy_maps: occupancy_maps::OccupancyMapsSettings,
    /// See [`exact`].
    pub exact: exact::ExactSettings,
}

impl ShadowSettings {
    /// The settings of each method that has any, to be changed.
    fn sections_mut(&mut self) -> Vec<(ShadowMethod, &mut dyn AnySettings)> {
        vec![
            (ShadowMethod::VoxelMap, &mut self.voxel_map),
            (ShadowMethod::OpacityMaps, &mut self.opacity_maps),
            (ShadowMethod::DeepOpacityMaps, &mut self.deep_opacity_maps),
            (ShadowMethod::DensityClustering, &mut self.density_clustering),
            (ShadowMethod::OccupancyMaps, &mut self.occupancy_maps),
            (ShadowMethod::Exact, &mut self.exact),
        ]
    }
}
