//! `ray-traced`: rays from each point to places on the light, through a hierarchy of boxes over the segments of the hair.
//!
//! Strands are ribbons that face the ray, as wide as they block light: each that a ray crosses takes as much of the light as its optical
//! depth says. Rays start on a square around the point, as wide as a strand, and end on the disc of the lamp, so that light is the mean over
//! both. There is no map, no texel and no filter: with many rays it is the truth of soft shadows.

mod cpu;
mod gpu;
mod hierarchy;
mod samples;
mod table;

pub use cpu::RayTraced;

use serde::{Deserialize, Serialize};

use super::method::{MapKind, Method};
use super::texels::{TEXEL_RESOLUTIONS, TexelFrame};
use crate::RayMarkKind;

pub(super) static METHOD: Method = Method {
    id: "ray-traced",
    label: "Ray traced",
    description: "Rays from each point to the light through every strand: no map, and the truth of soft shadows.",
    source: None,
    advice: "lower the number of strands, or raise the limit",
    map: MapKind::Rays,
    size: |_| None,
    words: |_| 0,
    marks: &[RayMarkKind::FRAGMENT],
    settings: |settings| Some(&settings.ray_traced),
    // Texels as wide as strands, like the squares on which rays start.
    footprint: |input, _, bounds| TexelFrame::new(input, *TEXEL_RESOLUTIONS.end(), bounds),
    counts_points: |_| false,
    // A ray crosses a whole number of ribbons, and fewer of them would be seen as noise.
    sums_strands: false,
    in_world: true,
    cpu: || Box::new(RayTraced::default()),
    gpu: |_, gpu, _| Ok(Box::new(gpu::GpuRayTraced::new(gpu)?)),
    shaders: gpu::GpuRayTraced::shaders,
};

/// Texels along the edge of the transmittance behind all hair, each of which sends rays.
const COLUMNS: u32 = 128;

/// Settings of the traced rays.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct RayTracedSettings {
    /// Rays from each point to the light: 1, 4, 16, 64 or 256.
    pub rays: u32,
    /// The most memory that the hierarchy may use, bytes. Hair that needs more is an error.
    pub memory_limit_bytes: u64,
}

impl Default for RayTracedSettings {
    fn default() -> Self {
        Self { rays: 4, memory_limit_bytes: 2 << 30 }
    }
}

/// The part of a strand in metres that rays see: not negative and finite, and 0 for NaN.
fn safe_width(strand_width: f32) -> f32 {
    if strand_width > 0.0 { strand_width.min(1e3) } else { 0.0 }
}
