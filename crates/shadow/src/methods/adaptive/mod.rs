//! `adaptive`: a curve of transmittance with a few nodes per texel, whose least important node goes when another one comes (Salvi,
//! Vidimče, Lauritzen, Lefohn 2010, "Adaptive Volumetric Shadow Maps").
//!
//! Fragments come in the order of depth, so that results repeat. Each is a step: two nodes at one depth. When there are too many, the node
//! is removed whose loss changes the area below the curve least; the first and the last one stay.

mod cpu;
mod gpu;
mod table;

pub use cpu::{Adaptive, AdaptiveCurve};

use lovelock_base::settings::Settings;
use serde::{Deserialize, Serialize};

use super::method::{MapKind, MapSize, Method};
use super::texels::{self, TexelFilter, TexelFrame, TexelShadow};

pub(super) static METHOD: Method = Method {
    id: "adaptive",
    label: "Adaptive maps",
    description: "A curve of transmittance with a few nodes per light texel, where it bends most (Salvi and others 2010).",
    source: Some("Salvi, Vidimče, Lauritzen, Lefohn 2010, Adaptive Volumetric Shadow Maps"),
    advice: "lower the map's resolution, the nodes or the number of strands",
    map: MapKind::Texels,
    size: |settings| {
        Some(MapSize { edge: settings.adaptive.resolution, per_texel: Some(settings.adaptive.nodes) })
    },
    words: texels::gpu::map_words::<AdaptiveCurve>,
    marks: &[texels::curve::PIECE],
    settings: |settings| Some(&settings.adaptive),
    footprint: |input, settings, bounds| {
        TexelFrame::new(input, settings.adaptive.clamped().resolution, bounds)
    },
    counts_points: |_| false,
    sums_strands: true,
    in_world: false,
    cpu: || Box::new(Adaptive::default()),
    gpu: |_, gpu, projected| Ok(Box::new(TexelShadow::<AdaptiveCurve>::new(gpu, projected)?)),
    shaders: TexelShadow::<AdaptiveCurve>::shaders,
};

/// Settings of adaptive volumetric shadow maps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct AdaptiveSettings {
    /// The most texels along each edge; see [`TEXEL_RESOLUTIONS`](crate::TEXEL_RESOLUTIONS).
    pub resolution: u32,
    /// How a point reads the texels around it.
    pub filter: TexelFilter,
    /// Nodes per texel: 4, 8, 16 or 32.
    pub nodes: u32,
}

impl Default for AdaptiveSettings {
    fn default() -> Self {
        Self { resolution: texels::DEFAULT_RESOLUTION, filter: TexelFilter::default(), nodes: 8 }
    }
}
