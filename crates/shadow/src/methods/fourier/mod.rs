//! `fourier`: the density along the light as a Fourier series (Jansen, Bavoil 2010, "Fourier Opacity Mapping").
//!
//! Fragments with optical depths τᵢ at dᵢ, 0 to 1 between the ends of a depth range, have the coefficients
//! aₖ = 2 Σ τᵢ cos 2πkdᵢ and bₖ = 2 Σ τᵢ sin 2πkdᵢ. Optical depth before d is the integral of the series,
//! a₀ d / 2 + Σₖ [aₖ sin 2πkd + bₖ (1 − cos 2πkd)] / 2πk. Few terms ring before and behind dense hair.

mod cpu;
mod gpu;
mod table;

pub use cpu::{Fourier, Series};

use lovelock_base::settings::Settings;
use serde::{Deserialize, Serialize};

use super::method::{MapKind, MapSize, Method};
use super::texels::{self, DepthRange, TexelFilter, TexelFrame, TexelShadow};

pub(super) static METHOD: Method = Method {
    id: "fourier",
    label: "Fourier maps",
    description: "A few terms of a Fourier series of the density, for each light texel (Jansen, Bavoil 2010).",
    source: Some("Jansen, Bavoil 2010, Fourier Opacity Mapping"),
    advice: "lower the map's resolution, the terms or the number of strands",
    map: MapKind::Texels,
    size: |settings| {
        Some(MapSize { edge: settings.fourier.resolution, per_texel: Some(settings.fourier.terms) })
    },
    words: texels::gpu::map_words::<Series>,
    marks: &[texels::ALL_HAIR],
    settings: |settings| Some(&settings.fourier),
    footprint: |input, settings, bounds| {
        TexelFrame::new(input, settings.fourier.clamped().resolution, bounds)
    },
    counts_points: |_| false,
    sums_strands: true,
    in_world: false,
    cpu: || Box::new(Fourier::default()),
    gpu: |_, gpu, projected| Ok(Box::new(TexelShadow::<Series>::new(gpu, projected)?)),
    shaders: TexelShadow::<Series>::shaders,
};

/// Settings of Fourier opacity maps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FourierSettings {
    /// The most texels along each edge; see [`TEXEL_RESOLUTIONS`](crate::TEXEL_RESOLUTIONS).
    pub resolution: u32,
    /// How a point reads the texels around it.
    pub filter: TexelFilter,
    /// Terms of the series besides the constant one: 3, 7 or 15.
    pub terms: u32,
    /// Whether higher terms are reduced against ringing (Lanczos).
    pub window: bool,
    /// The depths between which the series is defined.
    pub depth_range: DepthRange,
}

impl Default for FourierSettings {
    fn default() -> Self {
        Self {
            resolution: texels::DEFAULT_RESOLUTION,
            filter: TexelFilter::default(),
            terms: 7,
            window: false,
            depth_range: DepthRange::default(),
        }
    }
}
