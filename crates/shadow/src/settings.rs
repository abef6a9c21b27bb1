//! What a user sets about shadows.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use crate::{
    DeepOpacityMapsSettings, DensityClusteringSettings, ExactSettings, OccupancyMapsSettings,
    OpacityMapsSettings, ShadowMethod, VoxelMapSettings,
};

/// The method in use, what all methods share, and the values of each: switching loses nothing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ShadowSettings {
    /// The method in use.
    pub method: ShadowMethod,
    /// Factor on the optical depth of every strand; 0.01 to 4 on a logarithmic slider.
    ///
    /// It stands for the light that hair scatters forward instead of blocking: 1 is a head of opaque fibres,
    /// which is black a centimetre inside.
    pub extinction_scale: f32,
    /// Values of [`ShadowMethod::VoxelMap`].
    pub voxel_map: VoxelMapSettings,
    /// Values of [`ShadowMethod::OpacityMaps`].
    pub opacity_maps: OpacityMapsSettings,
    /// Values of [`ShadowMethod::DeepOpacityMaps`].
    pub deep_opacity_maps: DeepOpacityMapsSettings,
    /// Values of [`ShadowMethod::DensityClustering`].
    pub density_clustering: DensityClusteringSettings,
    /// Values of [`ShadowMethod::OccupancyMaps`].
    pub occupancy_maps: OccupancyMapsSettings,
    /// Values of [`ShadowMethod::Exact`].
    pub exact: ExactSettings,
}

impl ShadowSettings {
    /// Range of the slider of `extinction_scale`. Values outside are safe.
    pub const EXTINCTION_SCALES: RangeInclusive<f32> = 0.01..=4.0;

    /// The extinction scale as methods use it: not negative, finite, and 0 where it is no number.
    pub fn safe_extinction_scale(&self) -> f32 {
        if self.extinction_scale > 0.0 { self.extinction_scale.min(1e6) } else { 0.0 }
    }
}

impl Default for ShadowSettings {
    fn default() -> Self {
        Self {
            method: ShadowMethod::default(),
            extinction_scale: 0.15,
            voxel_map: VoxelMapSettings::default(),
            opacity_maps: OpacityMapsSettings::default(),
            deep_opacity_maps: DeepOpacityMapsSettings::default(),
            density_clustering: DensityClusteringSettings::default(),
            occupancy_maps: OccupancyMapsSettings::default(),
            exact: ExactSettings::default(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extinction_is_always_a_usable_number() {
        let cases = [(0.15, 0.15), (0.0, 0.0), (-1.0, 0.0), (f32::NAN, 0.0), (f32::INFINITY, 1e6)];
        for (extinction_scale, safe) in cases {
            assert_eq!(
                ShadowSettings { extinction_scale, ..Default::default() }.safe_extinction_scale(),
                safe
            );
        }
    }
}
