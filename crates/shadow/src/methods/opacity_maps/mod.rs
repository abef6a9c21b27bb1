//! `opacity-maps`: optical depth at uniform slices along the light (Kim, Neumann 2001, "Opacity Shadow Maps").
//!
//! The depth range of the whole hair is divided into equal slices. A texel holds the optical depth before the end of each slice,
//! and a point between two ends interpolates optical depth.

mod cpu;
mod gpu;
mod table;

pub use cpu::{OpacityMaps, Slices};

use lovelock_base::settings::Settings;
use serde::{Deserialize, Serialize};

use super::method::{MapKind, MapSize, Method};
use super::texels::{self, TexelFilter, TexelFrame, TexelShadow};

pub(super) static METHOD: Method = Method {
    id: "opacity-maps",
    label: "Opacity maps",
    description: "Optical depth at equal slices along the light, per light texel (Kim, Neumann 2001).",
    source: Some("Kim, Neumann 2001, Opacity Shadow Maps"),
    advice: "lower the map's resolution, the slices or the number of strands",
    map: MapKind::Texels,
    size: |settings| {
        Some(MapSize {
            edge: settings.opacity_maps.resolution,
            per_texel: Some(settings.opacity_maps.slices),
        })
    },
    words: texels::gpu::map_words::<Slices>,
    marks: &[texels::SLICE],
    settings: |settings| Some(&settings.opacity_maps),
    footprint: |input, settings, bounds| {
        TexelFrame::new(input, settings.opacity_maps.clamped().resolution, bounds)
    },
    counts_points: |_| false,
    sums_strands: true,
    in_world: false,
    cpu: || Box::new(OpacityMaps::default()),
    gpu: |_, gpu, projected| Ok(Box::new(TexelShadow::<Slices>::new(gpu, projected)?)),
    shaders: TexelShadow::<Slices>::shaders,
};

/// Settings of opacity maps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct OpacityMapsSettings {
    /// The most texels along each edge; see [`TEXEL_RESOLUTIONS`](crate::TEXEL_RESOLUTIONS).
    pub resolution: u32,
    /// How a point reads the texels around it.
    pub filter: TexelFilter,
    /// Slices of equal depth.
    pub slices: u32,
}

impl Default for OpacityMapsSettings {
    fn default() -> Self {
        Self { resolution: texels::DEFAULT_RESOLUTION, filter: TexelFilter::default(), slices: 128 }
    }
}
