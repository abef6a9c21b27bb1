//! `occupancy-maps`: one bit per slice that contains hair, and the amount of hair per slab of slices (Sintorn, Assarsson 2009, "Hair Self Shadowing and Transparency Depth Ordering Using Occupancy Maps").
//!
//! Slices divide the depth range of each texel. A point counts the hair of the slabs before its own slab, and a fraction of its
//! own slab: the share of occupied slices before it.

mod cpu;
mod gpu;
mod table;

pub use cpu::{Occupancy, OccupancyMaps};

use lovelock_base::settings::Settings;
use serde::{Deserialize, Serialize};

use super::method::{MapKind, MapSize, Method};
use super::texels::{self, TexelFilter, TexelFrame, TexelShadow};
use crate::RayMarkKind;

pub(super) static METHOD: Method = Method {
    id: "occupancy-maps",
    label: "Occupancy maps",
    description: "Bits of slices with hair and counts per slab of slices, for each light texel (Sintorn, Assarsson 2009).",
    source: Some(
        "Sintorn, Assarsson 2009, Hair Self Shadowing and Transparency Depth Ordering Using Occupancy Maps",
    ),
    advice: "lower the map's resolution, the slices or the number of strands",
    map: MapKind::Texels,
    size: |settings| {
        Some(MapSize {
            edge: settings.occupancy_maps.resolution,
            per_texel: Some(settings.occupancy_maps.slices),
        })
    },
    words: texels::gpu::map_words::<Occupancy>,
    marks: &[SLAB, texels::SLICE],
    settings: |settings| Some(&settings.occupancy_maps),
    footprint: |input, settings, bounds| {
        TexelFrame::new(input, settings.occupancy_maps.clamped().resolution, bounds)
    },
    counts_points: |_| false,
    sums_strands: true,
    in_world: false,
    cpu: || Box::new(OccupancyMaps::default()),
    gpu: |_, gpu, projected| Ok(Box::new(TexelShadow::<Occupancy>::new(gpu, projected)?)),
    shaders: TexelShadow::<Occupancy>::shaders,
};

/// A slab of slices, with its count of fragments times their mean optical depth.
pub(crate) const SLAB: RayMarkKind = RayMarkKind { label: "Slab", resolves_depth: false };

/// Settings of occupancy maps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct OccupancyMapsSettings {
    /// The most texels along each edge; see [`TEXEL_RESOLUTIONS`](crate::TEXEL_RESOLUTIONS).
    pub resolution: u32,
    /// How a point reads the texels around it.
    pub filter: TexelFilter,
    /// Slices, one bit each: 128, 256 or 512.
    pub slices: u32,
    /// Slabs, one count each: 4, 8 or 16.
    pub slabs: u32,
}

impl Default for OccupancyMapsSettings {
    fn default() -> Self {
        Self { resolution: texels::DEFAULT_RESOLUTION, filter: TexelFilter::default(), slices: 128, slabs: 8 }
    }
}
