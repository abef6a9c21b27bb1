//! `approximate-deep`: the nearest hair of each texel alone, behind which hair is taken to be evenly dense (Engel, Hable 2013, hair of
//! *Tomb Raider*; TressFX).
//!
//! A point d behind the nearest hair is taken to lie behind n = d / spacing hairs, each of which lets 1 − α of the light through. It
//! needs the least memory and time, and does not know how much hair there is: a single strand shadows like a full head.

mod cpu;
mod gpu;
mod table;

pub use cpu::{ApproximateDeep, NearestHair};

use lovelock_base::settings::Settings;
use serde::{Deserialize, Serialize};

use super::method::{MapKind, MapSize, Method};
use super::texels::{self, TexelFilter, TexelFrame, TexelShadow};

pub(super) static METHOD: Method = Method {
    id: "approximate-deep",
    label: "Approximate deep",
    description: "The nearest hair per light texel, with even density assumed behind it (Engel, Hable 2013).",
    source: Some("Engel, Hable 2013, TressFX: real-time hair in Tomb Raider"),
    advice: "lower the map's resolution or the number of strands",
    map: MapKind::Texels,
    size: |settings| Some(MapSize { edge: settings.approximate_deep.resolution, per_texel: None }),
    words: texels::gpu::map_words::<NearestHair>,
    marks: &[texels::ALL_HAIR],
    settings: |settings| Some(&settings.approximate_deep),
    footprint: |input, settings, bounds| {
        TexelFrame::new(input, settings.approximate_deep.clamped().resolution, bounds)
    },
    counts_points: |_| false,
    // Light behind the nearest hair does not depend on how many strands there are.
    sums_strands: false,
    in_world: false,
    cpu: || Box::new(ApproximateDeep::default()),
    gpu: |_, gpu, projected| Ok(Box::new(TexelShadow::<NearestHair>::new(gpu, projected)?)),
    shaders: TexelShadow::<NearestHair>::shaders,
};

/// Settings of approximate deep shadow maps.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ApproximateDeepSettings {
    /// The most texels along each edge; see [`TEXEL_RESOLUTIONS`](crate::TEXEL_RESOLUTIONS).
    pub resolution: u32,
    /// How a point reads the texels around it.
    pub filter: TexelFilter,
    /// The distance along the light between two hairs, metres.
    pub spacing: f32,
    /// The most hairs before a point.
    pub hairs: u32,
}

impl Default for ApproximateDeepSettings {
    fn default() -> Self {
        Self {
            resolution: texels::DEFAULT_RESOLUTION,
            filter: TexelFilter::default(),
            spacing: 0.002,
            hairs: 64,
        }
    }
}
