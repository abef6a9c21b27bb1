//! Shadow methods inside hair: how much light reaches a point through the strands in front of it.
//!
//! [`ShadowMethod`] lists the methods, [`ShadowSettings`] holds the settings of all of them, and [`CpuShadow`] is their
//! interface: build a map from strands and a light, then look up a transmittance in `0..=1` at any point. The CPU version of a
//! method is its definition.
//!
//! Adding a method is a folder in `methods/` and its lines in `methods/mod.rs`: see `docs/how_to_add.md`.

mod area;
mod bounds;
mod converged;
mod cpu;
mod error;
mod exp;
mod gpu;
mod light;
mod perspective;
mod ray;
mod world;

pub mod methods;

pub use area::LightArea;
pub use bounds::Bounds;
pub use converged::{CONVERGED_CHANGE, Converged, MAX_CONVERGED_SAMPLES, converged};
pub use cpu::{ColumnMap, CpuShadow, ProjectedStrands, ShadowInput, ShadowReport, fallbacks_sentence};
pub use error::ShadowError;
pub use gpu::{
    GpuColumns, GpuList, GpuProjected, GpuShadow, GpuShadowError, GpuShadowInput, GpuStrands, GpuTargets,
    ProjectedTargets, SUM_WORDS, SharedList,
};
pub use light::{LightFrame, LightSource};
pub use methods::adaptive::AdaptiveSettings;
pub use methods::approximate_deep::ApproximateDeepSettings;
pub use methods::deep_opacity_maps::{DeepOpacityMapsSettings, LayerGrowth};
pub use methods::deep_shadow_maps::DeepShadowMapsSettings;
pub use methods::density_clustering::{
    ClusterDeviation, ClusterSeeds, DensityClusteringSettings, LineFilter,
};
pub use methods::exact::{ExactMap, ExactSettings};
pub use methods::fourier::FourierSettings;
pub use methods::moments::{MomentKind, MomentsSettings};
pub use methods::occupancy_maps::OccupancyMapsSettings;
pub use methods::opacity_maps::OpacityMapsSettings;
pub use methods::ray_traced::RayTracedSettings;
pub use methods::texels::{DepthRange, TEXEL_RESOLUTIONS, TexelFilter};
pub use methods::user::{UserMethod, UserSettings, new_method};
pub use methods::voxel_map;
pub use methods::voxel_map::VoxelMapSettings;
pub use methods::voxel_march::VoxelMarchSettings;
pub use methods::{
    MapKind, MapSize, ShadowMethod, ShadowSettings, UnknownShadowMethod, all_shaders, cpu_shadow, gpu_shadow,
};
pub use perspective::cube;
pub use ray::{RayMark, RayMarkKind, RayStructure};
