//! `occupancy-maps`: a bit for each slice with hair in it, and the amount of hair a slab of slices (Sintorn,
//! Assarsson 2009, "Hair Self Shadowing and Transparency Depth Ordering Using Occupancy Maps").
//!
//! Slices divide the depth range of each texel by itself. A point counts the hair of the slabs before its own, and
//! of its own the share of occupied slices before it.

mod cpu;
mod gpu;
mod table;

pub use cpu::{Occupancy, OccupancyMaps};

use serde::{Deserialize, Serialize};

use super::texels::{self, TexelFilter, TexelShadow};
use crate::RayMarkKind;
use crate::method::{MapKind, MapSize, Method};

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
    marks: &[SLAB, texels::SLICE],
    counts_points: |_| false,
    cpu: || Box::new(OccupancyMaps::default()),
    gpu: |gpu| Ok(Box::new(TexelShadow::<Occupancy>::new(gpu)?)),
    shaders: TexelShadow::<Occupancy>::shaders,
};

/// A slab of slices, with its count of fragments times their mean optical depth.
pub(crate) const SLAB: RayMarkKind = RayMarkKind { label: "Slab", resolves_depth: false };

/// What a user sets about occupancy maps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct OccupancyMapsSettings {
    /// Most texels along each edge; see [`TEXEL_RESOLUTIONS`](crate::TEXEL_RESOLUTIONS).
    pub resolution: u32,
    /// How a point reads the texels around it.
    pub filter: TexelFilter,
    /// Slices, a bit each: 128, 256 or 512.
    pub slices: u32,
    /// Slabs, a count each: 4, 8 or 16.
    pub slabs: u32,
}

impl Default for OccupancyMapsSettings {
    fn default() -> Self {
        Self { resolution: texels::DEFAULT_RESOLUTION, filter: TexelFilter::default(), slices: 128, slabs: 8 }
    }
}
