//! What a user sets about shadows.

use lovelock_base::field;
use lovelock_base::settings::{AnySettings, Choices, Part, PartMut, Setting, Settings};
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
    /// Factor on the optical depth of every strand.
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
    /// The settings of one method alone; `None` of a method that has none.
    pub fn of_method(&self, method: ShadowMethod) -> Option<&dyn AnySettings> {
        let name = method.id().replace('-', "_");
        self.parts().into_iter().find(|(part, _)| *part == name).map(|(_, settings)| settings)
    }

    /// The same, to be changed.
    pub fn of_method_mut(&mut self, method: ShadowMethod) -> Option<&mut dyn AnySettings> {
        let name = method.id().replace('-', "_");
        self.parts_mut().into_iter().find(|(part, _)| *part == name).map(|(_, settings)| settings)
    }

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

impl Choices for ShadowMethod {
    const ALL: &'static [Self] = Self::ALL;

    fn names(self) -> (&'static str, &'static str) {
        (self.id(), self.label())
    }
}

impl Settings for ShadowSettings {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::choice::<ShadowMethod>(
            field!(Self, method),
            "Method",
            "How the light that reaches a hair through other hair is computed.",
        ),
        Setting::number(
            field!(Self, extinction_scale),
            [0.01, 4.0],
            "Extinction",
            "How much light a hair blocks. Low values let light through the hair, high ones make its \
             inside dark; 1 is a head of opaque fibres.",
        )
        .symbol("s")
        .logarithmic()
        .decimals(3),
    ];

    fn parts(&self) -> Vec<Part<'_>> {
        vec![
            ("voxel_map".into(), &self.voxel_map),
            ("opacity_maps".into(), &self.opacity_maps),
            ("deep_opacity_maps".into(), &self.deep_opacity_maps),
            ("density_clustering".into(), &self.density_clustering),
            ("occupancy_maps".into(), &self.occupancy_maps),
            ("exact".into(), &self.exact),
        ]
    }

    fn parts_mut(&mut self) -> Vec<PartMut<'_>> {
        vec![
            ("voxel_map".into(), &mut self.voxel_map),
            ("opacity_maps".into(), &mut self.opacity_maps),
            ("deep_opacity_maps".into(), &mut self.deep_opacity_maps),
            ("density_clustering".into(), &mut self.density_clustering),
            ("occupancy_maps".into(), &mut self.occupancy_maps),
            ("exact".into(), &mut self.exact),
        ]
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
