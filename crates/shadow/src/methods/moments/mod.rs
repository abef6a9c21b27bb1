//! `moments`: four power moments of the hair along the light (Münstermann, Krumpen, Klein, Peters 2018, "Moment-Based Order-Independent
//! Transparency").
//!
//! Depths are z, −1 to 1 between the ends of a depth range. A texel holds the optical depth of its hair, b₀, and the means of z, z², z³
//! and z⁴. Of all distributions of hair with these moments, the solver knows the least and the most that can lie before a depth; the share
//! used lies between both.

mod cpu;
mod gpu;
mod pack;
mod solve;
mod table;

pub use cpu::{Moments, PowerMoments};

use lovelock_base::settings::Settings;
use serde::{Deserialize, Serialize};

use super::method::{MapKind, MapSize, Method};
use super::texels::{self, DepthRange, TexelFilter, TexelFrame, TexelShadow};

pub(super) static METHOD: Method = Method {
    id: "moments",
    label: "Moments",
    description: "Four moments of the hair along the light, for each light texel (Münstermann and others 2018).",
    source: Some("Münstermann, Krumpen, Klein, Peters 2018, Moment-Based Order-Independent Transparency"),
    advice: "lower the map's resolution or the number of strands",
    map: MapKind::Texels,
    size: |settings| Some(MapSize { edge: settings.moments.resolution, per_texel: Some(4) }),
    words: texels::gpu::map_words::<PowerMoments>,
    marks: &[texels::ALL_HAIR],
    settings: |settings| Some(&settings.moments),
    footprint: |input, settings, bounds| {
        TexelFrame::new(input, settings.moments.clamped().resolution, bounds)
    },
    counts_points: |_| false,
    in_world: false,
    cpu: || Box::new(Moments::default()),
    gpu: |_, gpu, projected| Ok(Box::new(TexelShadow::<PowerMoments>::new(gpu, projected)?)),
    shaders: TexelShadow::<PowerMoments>::shaders,
};

/// Settings of moments.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MomentsSettings {
    /// The most texels along each edge; see [`TEXEL_RESOLUTIONS`](crate::TEXEL_RESOLUTIONS).
    pub resolution: u32,
    /// How a point reads the texels around it.
    pub filter: TexelFilter,
    /// Bits of a moment: 16 or 32.
    pub bits: u32,
    /// A factor on the published share of even hair that is mixed into the moments: 5 · 10⁻⁷ with 32 bits, 6 · 10⁻⁵ with 16.
    pub bias: f32,
    /// The share of the hair at a point's own depth that counts as before it: 0 for the lower bound, 1 for the upper one.
    pub overestimation: f32,
    /// The depths between which z goes from −1 to 1.
    pub depth_range: DepthRange,
}

impl Default for MomentsSettings {
    fn default() -> Self {
        Self {
            resolution: texels::DEFAULT_RESOLUTION,
            filter: TexelFilter::default(),
            bits: 32,
            bias: 1.0,
            overestimation: 0.25,
            depth_range: DepthRange::default(),
        }
    }
}
