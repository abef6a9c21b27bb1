//! The registry of shadow methods: a folder per method, and the lines in this file that point into it.
//!
//! Everything about a method is in its folder: its `METHOD` (names, source, size of its map), its settings, its definition on
//! the CPU and its passes on the GPU. Everything else goes through [`ShadowMethod::ALL`].

pub mod adaptive;
pub mod approximate_deep;
mod curves;
pub mod deep_opacity_maps;
pub mod deep_shadow_maps;
pub mod density_clustering;
pub mod exact;
pub mod fourier;
mod method;
pub mod moments;
pub mod none;
pub mod occupancy_maps;
pub mod opacity_maps;
pub mod ray_traced;
pub mod texels;
pub mod user;
pub mod voxel_map;
pub mod voxel_march;

pub use method::{MapKind, MapSize, UnknownShadowMethod, all_shaders, cpu_shadow, gpu_shadow};

use lovelock_base::settings::AnySettings;
use serde::{Deserialize, Serialize};

use method::Method;
use user::UserMethod;

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
    /// See [`deep_shadow_maps`].
    DeepShadowMaps,
    /// See [`approximate_deep`].
    ApproximateDeep,
    /// See [`fourier`].
    Fourier,
    /// See [`adaptive`].
    Adaptive,
    /// See [`moments`].
    Moments,
    /// See [`voxel_march`].
    VoxelMarch,
    /// See [`ray_traced`].
    RayTraced,
    /// See [`exact`].
    Exact,
    /// See [`user`]: not among [`ShadowMethod::ALL`].
    User(UserMethod),
}

impl ShadowMethod {
    /// Every method of the program, in the order of menus and reports.
    pub const ALL: &'static [Self] = &[
        Self::None,
        Self::VoxelMap,
        Self::OpacityMaps,
        Self::DeepOpacityMaps,
        Self::DensityClustering,
        Self::OccupancyMaps,
        Self::DeepShadowMaps,
        Self::ApproximateDeep,
        Self::Fourier,
        Self::Adaptive,
        Self::Moments,
        Self::VoxelMarch,
        Self::RayTraced,
        Self::Exact,
    ];

    /// The methods of users whose folders were named so far.
    fn of_users() -> Vec<Self> {
        UserMethod::known().into_iter().map(Self::User).collect()
    }

    /// The user's method that a text names.
    fn of_text(text: &str) -> Option<Self> {
        UserMethod::parse(text).map(Self::User)
    }

    /// Allows the files of a user's method to be read.
    fn allow(self) {
        if let Self::User(user) = self {
            user.allow();
        }
    }

    /// What the method's folder says about it.
    pub(crate) const fn method(self) -> &'static Method {
        match self {
            Self::None => &none::METHOD,
            Self::VoxelMap => &voxel_map::METHOD,
            Self::OpacityMaps => &opacity_maps::METHOD,
            Self::DeepOpacityMaps => &deep_opacity_maps::METHOD,
            Self::DensityClustering => &density_clustering::METHOD,
            Self::OccupancyMaps => &occupancy_maps::METHOD,
            Self::DeepShadowMaps => &deep_shadow_maps::METHOD,
            Self::ApproximateDeep => &approximate_deep::METHOD,
            Self::Fourier => &fourier::METHOD,
            Self::Adaptive => &adaptive::METHOD,
            Self::Moments => &moments::METHOD,
            Self::VoxelMarch => &voxel_march::METHOD,
            Self::RayTraced => &ray_traced::METHOD,
            Self::Exact => &exact::METHOD,
            Self::User(_) => &user::METHOD,
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
    /// See [`deep_shadow_maps`].
    pub deep_shadow_maps: deep_shadow_maps::DeepShadowMapsSettings,
    /// See [`approximate_deep`].
    pub approximate_deep: approximate_deep::ApproximateDeepSettings,
    /// See [`fourier`].
    pub fourier: fourier::FourierSettings,
    /// See [`adaptive`].
    pub adaptive: adaptive::AdaptiveSettings,
    /// See [`moments`].
    pub moments: moments::MomentsSettings,
    /// See [`voxel_march`].
    pub voxel_march: voxel_march::VoxelMarchSettings,
    /// See [`ray_traced`].
    pub ray_traced: ray_traced::RayTracedSettings,
    /// See [`exact`].
    pub exact: exact::ExactSettings,
    /// See [`user`].
    #[serde(skip_serializing_if = "user::UserSettings::is_unused")]
    pub user: user::UserSettings,
}

impl ShadowSettings {
    /// The settings of each method that has any, to be changed.
    fn sections_mut(&mut self) -> Vec<(ShadowMethod, &mut dyn AnySettings)> {
        let mut sections: Vec<(ShadowMethod, &mut dyn AnySettings)> = vec![
            (ShadowMethod::VoxelMap, &mut self.voxel_map),
            (ShadowMethod::OpacityMaps, &mut self.opacity_maps),
            (ShadowMethod::DeepOpacityMaps, &mut self.deep_opacity_maps),
            (ShadowMethod::DensityClustering, &mut self.density_clustering),
            (ShadowMethod::OccupancyMaps, &mut self.occupancy_maps),
            (ShadowMethod::DeepShadowMaps, &mut self.deep_shadow_maps),
            (ShadowMethod::ApproximateDeep, &mut self.approximate_deep),
            (ShadowMethod::Fourier, &mut self.fourier),
            (ShadowMethod::Adaptive, &mut self.adaptive),
            (ShadowMethod::Moments, &mut self.moments),
            (ShadowMethod::VoxelMarch, &mut self.voxel_march),
            (ShadowMethod::RayTraced, &mut self.ray_traced),
            (ShadowMethod::Exact, &mut self.exact),
        ];
        if let Some(user) = self.user.method {
            sections.push((ShadowMethod::User(user), &mut self.user));
        }
        sections
    }
}
