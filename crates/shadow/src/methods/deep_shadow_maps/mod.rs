//! `deep-shadow-maps`: the curve of transmittance of each texel, with as few nodes as an error allows (Lokovic, Veach 2000, "Deep Shadow
//! Maps").
//!
//! Curves are compressed greedily. From the last node, the slopes of a line are kept that pass every step since within the error; when none
//! is left, the line ends before that step, with the slope in the middle of those left.

mod compress;
mod cpu;
mod gpu;
mod table;

pub use cpu::{DeepCurve, DeepShadowMaps};

use lovelock_base::settings::Settings;
use serde::{Deserialize, Serialize};

use super::method::{MapKind, MapSize, Method};
use super::texels::{self, TexelFilter, TexelFrame, TexelShadow};

pub(super) static METHOD: Method = Method {
    id: "deep-shadow-maps",
    label: "Deep shadow maps",
    description: "A curve of transmittance per light texel, with nodes where an error asks for them (Lokovic, Veach 2000).",
    source: Some("Lokovic, Veach 2000, Deep Shadow Maps"),
    advice: "lower the map's resolution, the nodes or the number of strands",
    map: MapKind::Texels,
    size: |settings| {
        Some(MapSize {
            edge: settings.deep_shadow_maps.resolution,
            per_texel: Some(settings.deep_shadow_maps.nodes),
        })
    },
    words: texels::gpu::map_words::<DeepCurve>,
    marks: &[texels::curve::PIECE],
    settings: |settings| Some(&settings.deep_shadow_maps),
    footprint: |input, settings, bounds| {
        TexelFrame::new(input, settings.deep_shadow_maps.clamped().resolution, bounds)
    },
    counts_points: |_| false,
    sums_strands: true,
    in_world: false,
    cpu: || Box::new(DeepShadowMaps::default()),
    gpu: |_, gpu, projected| Ok(Box::new(TexelShadow::<DeepCurve>::new(gpu, projected)?)),
    shaders: TexelShadow::<DeepCurve>::shaders,
};

/// Settings of deep shadow maps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct DeepShadowMapsSettings {
    /// The most texels along each edge; see [`TEXEL_RESOLUTIONS`](crate::TEXEL_RESOLUTIONS).
    pub resolution: u32,
    /// How a point reads the texels around it.
    pub filter: TexelFilter,
    /// The largest error of transmittance at a step of the curve.
    pub tolerance: f32,
    /// The most nodes per texel: 8, 16 or 32. A texel that would need more has a larger error.
    pub nodes: u32,
}

impl Default for DeepShadowMapsSettings {
    fn default() -> Self {
        Self {
            resolution: texels::DEFAULT_RESOLUTION,
            filter: TexelFilter::default(),
            tolerance: 0.02,
            nodes: 16,
        }
    }
}
