//! `deep-opacity-maps`: a few layers that start at the first hair (Yuksel, Keyser 2008, "Deep Opacity Maps").
//!
//! Layers follow the lit surface of the hair, so that no boundary between layers is visible on it. Everything behind the last
//! boundary counts toward the last layer. A single hair in front of the rest moves all layers forward.

mod cpu;
mod gpu;
mod table;

pub use cpu::{DeepOpacityMaps, Layers};

use std::ops::RangeInclusive;

use lovelock_base::settings::Settings;
use serde::{Deserialize, Serialize};

use super::method::{MapKind, MapSize, Method};
use super::texels::{self, TexelFilter, TexelFrame, TexelShadow};
use crate::RayMarkKind;

pub(super) static METHOD: Method = Method {
    id: "deep-opacity-maps",
    label: "Deep opacity maps",
    description: "A few layers per light texel, starting at its first hair (Yuksel, Keyser 2008).",
    source: Some("Yuksel, Keyser 2008, Deep Opacity Maps"),
    advice: "lower the map's resolution or the number of strands",
    map: MapKind::Texels,
    size: |settings| {
        Some(MapSize {
            edge: settings.deep_opacity_maps.resolution,
            per_texel: Some(settings.deep_opacity_maps.layers),
        })
    },
    words: texels::gpu::map_words::<Layers>,
    marks: &[LAYER],
    settings: |settings| Some(&settings.deep_opacity_maps),
    footprint: |input, settings, bounds| {
        TexelFrame::new(input, settings.deep_opacity_maps.clamped().resolution, bounds)
    },
    counts_points: |_| false,
    sums_strands: true,
    in_world: false,
    cpu: || Box::new(DeepOpacityMaps::default()),
    gpu: |_, gpu, projected| Ok(Box::new(TexelShadow::<Layers>::new(gpu, projected)?)),
    shaders: TexelShadow::<Layers>::shaders,
};

/// A layer of a texel.
pub(crate) const LAYER: RayMarkKind = RayMarkKind { label: "Layer", resolves_depth: true };

/// The thickness of layers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LayerGrowth {
    /// All are equally thick.
    Even,
    /// The k-th layer is k times as thick as the first: fine where light falls off fastest.
    #[default]
    Linear,
}

/// Settings of deep opacity maps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct DeepOpacityMapsSettings {
    /// The most texels along each edge; see [`TEXEL_RESOLUTIONS`](crate::TEXEL_RESOLUTIONS).
    pub resolution: u32,
    /// How a point reads the texels around it.
    pub filter: TexelFilter,
    /// Layers per texel; see [`DeepOpacityMapsSettings::LAYERS`].
    pub layers: u32,
    /// The thickness of layers.
    pub growth: LayerGrowth,
    /// Thickness of all layers together, as a fraction of the depth range of the hair.
    pub depth_share: f32,
}

impl DeepOpacityMapsSettings {
    /// Layers that the map can have.
    pub const LAYERS: RangeInclusive<u32> = 3..=16;
}

impl Default for DeepOpacityMapsSettings {
    fn default() -> Self {
        Self {
            resolution: texels::DEFAULT_RESOLUTION,
            filter: TexelFilter::default(),
            layers: 4,
            growth: LayerGrowth::default(),
            depth_share: 0.5,
        }
    }
}
