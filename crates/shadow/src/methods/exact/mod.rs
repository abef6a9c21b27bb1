//! `exact`: every fragment of strands in a light texel, sorted by depth. It is the reference for the other methods.
//!
//! A point receives the light that the fragments before it let through; its own fragment does not count.

pub(crate) mod cpu;
pub(crate) mod gpu;
mod table;

pub use cpu::{ExactMap, SortedFragments};

use lovelock_base::settings::Settings;
use serde::{Deserialize, Serialize};

use super::method::{MapKind, MapSize, Method};
use super::texels::{self, TexelFilter, TexelFrame, TexelShadow};
use crate::RayMarkKind;

pub(super) static METHOD: Method = Method {
    id: "exact",
    label: "Exact",
    description: "Every fragment of each light texel, sorted by depth: the reference for the other methods.",
    source: None,
    advice: "lower the map's resolution or the number of strands, or raise the limit",
    map: MapKind::Texels,
    size: |settings| Some(MapSize { edge: settings.exact.resolution, per_texel: None }),
    words: texels::gpu::map_words::<SortedFragments>,
    marks: &[RayMarkKind::FRAGMENT],
    settings: |settings| Some(&settings.exact),
    footprint: |input, settings, bounds| TexelFrame::new(input, settings.exact.clamped().resolution, bounds),
    counts_points: |_| false,
    sums_strands: true,
    in_world: false,
    cpu: || Box::new(ExactMap::default()),
    gpu: |_, gpu, projected| Ok(Box::new(TexelShadow::<SortedFragments>::new(gpu, projected)?)),
    shaders: TexelShadow::<SortedFragments>::shaders,
};

/// Settings of the exact method.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ExactSettings {
    /// The most texels along each edge; see [`TEXEL_RESOLUTIONS`](crate::TEXEL_RESOLUTIONS).
    pub resolution: u32,
    /// How a point reads the texels around it.
    pub filter: TexelFilter,
    /// The most memory that a build may use, bytes. Hair that needs more is an error.
    pub memory_limit_bytes: u64,
}

impl Default for ExactSettings {
    fn default() -> Self {
        Self {
            resolution: texels::DEFAULT_RESOLUTION,
            filter: TexelFilter::default(),
            memory_limit_bytes: 8 << 30,
        }
    }
}
