//! `exact`: every fragment that the strands leave in a light texel, sorted by depth. The other methods are judged
//! by it.
//!
//! A point receives what the fragments before it let through; its own does not count.

pub(crate) mod cpu;
mod gpu;
mod table;

pub use cpu::{ExactMap, Sorted};

use serde::{Deserialize, Serialize};

use super::texels::{self, TexelFilter, TexelShadow};
use crate::RayMarkKind;
use crate::method::{MapKind, MapSize, Method};

pub(super) static METHOD: Method = Method {
    id: "exact",
    label: "Exact",
    description: "Every fragment of each light texel, sorted by depth: the reference for the other methods.",
    source: None,
    advice: "lower the map's resolution or the number of strands, or raise the limit",
    map: MapKind::Texels,
    size: |settings| Some(MapSize { edge: settings.exact.resolution, per_texel: None }),
    marks: &[RayMarkKind::FRAGMENT],
    counts_points: |_| false,
    cpu: || Box::new(ExactMap::default()),
    gpu: |gpu| Ok(Box::new(TexelShadow::<Sorted>::new(gpu)?)),
    shaders: TexelShadow::<Sorted>::shaders,
};

/// What a user sets about the exact shadow.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ExactSettings {
    /// Most texels along each edge; see [`TEXEL_RESOLUTIONS`](crate::TEXEL_RESOLUTIONS).
    pub resolution: u32,
    /// How a point reads the texels around it.
    pub filter: TexelFilter,
    /// Memory that a build may take, bytes. Hair that needs more is refused.
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
