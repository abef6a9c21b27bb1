//! `moments`: four, six or eight moments of the hair along the light (Münstermann, Krumpen, Klein, Peters 2018, "Moment-Based
//! Order-Independent Transparency").
//!
//! Depths are z, −1 to 1 between the ends of a depth range. A texel holds the optical depth of its hair, b₀, and means of functions of z
//! that give the means of z, z², … or those of cosines and sines. Of all distributions of hair with these moments, the solver knows the
//! least and the most that can lie before a depth; the share used lies between both.

mod cpu;
mod gpu;
mod means;
mod roots;
mod solve;
mod table;

pub use cpu::{DepthMoments, Moments};

use lovelock_base::settings::{Choices, Settings};
use serde::{Deserialize, Serialize};

use super::method::{MapKind, MapSize, Method};
use super::texels::{self, DepthRange, TexelFilter, TexelFrame, TexelShadow};

pub(super) static METHOD: Method = Method {
    id: "moments",
    label: "Moments",
    description: "A few moments of the hair along the light, for each light texel (Münstermann and others 2018).",
    source: Some("Münstermann, Krumpen, Klein, Peters 2018, Moment-Based Order-Independent Transparency"),
    advice: "lower the map's resolution or the number of strands",
    map: MapKind::Texels,
    size: |settings| {
        Some(MapSize { edge: settings.moments.resolution, per_texel: Some(settings.moments.count) })
    },
    words: texels::gpu::map_words::<DepthMoments>,
    marks: &[texels::ALL_HAIR],
    settings: |settings| Some(&settings.moments),
    footprint: |input, settings, bounds| {
        TexelFrame::new(input, settings.moments.clamped().resolution, bounds)
    },
    counts_points: |_| false,
    sums_strands: true,
    in_world: false,
    cpu: || Box::new(Moments::default()),
    gpu: |_, gpu, projected| Ok(Box::new(TexelShadow::<DepthMoments>::new(gpu, projected)?)),
    shaders: TexelShadow::<DepthMoments>::shaders,
};

/// The functions of depth whose means are known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MomentKind {
    /// Powers of the depth.
    #[default]
    Power,
    /// Cosine and sine of an angle proportional to the depth, and of its multiples.
    Trigonometric,
}

impl Choices for MomentKind {
    const ALL: &'static [Self] = &[Self::Power, Self::Trigonometric];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Power => ("power", "Power"),
            Self::Trigonometric => ("trigonometric", "Trigonometric"),
        }
    }
}

/// Settings of moments.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MomentsSettings {
    /// The most texels along each edge; see [`TEXEL_RESOLUTIONS`](crate::TEXEL_RESOLUTIONS).
    pub resolution: u32,
    /// How a point reads the texels around it.
    pub filter: TexelFilter,
    /// Numbers of a record besides all hair: 4, 6 or 8.
    pub count: u32,
    /// What they are moments of.
    pub kind: MomentKind,
    /// Bits of a moment: 16 or 32.
    pub bits: u32,
    /// A factor on the published share of even hair that is mixed into the moments: of four powers, 5 · 10⁻⁷ with 32 bits and 6 · 10⁻⁵
    /// with 16.
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
            count: 4,
            kind: MomentKind::Power,
            bits: 32,
            bias: 1.0,
            overestimation: 0.25,
            depth_range: DepthRange::default(),
        }
    }
}
