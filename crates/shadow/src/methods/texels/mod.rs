//! What the methods with a record per light texel share.
//!
//! Strands are rasterised into the texels of a light ([`TexelFrame`]) as fragments with a depth and an optical depth. A method
//! consists of a function from the fragments of one texel to a record, and one from a record and a depth to the optical depth before
//! it ([`TexelMethod`]); [`TexelMap`] does the rest.

pub(crate) mod curve;
pub(crate) mod fragments;
pub(crate) mod frame;
pub(crate) mod gaussian;
pub(crate) mod gpu;
pub(crate) mod lines;
mod lookup;
pub(crate) mod map;
mod method;
pub(crate) mod turn;
pub(crate) mod whole;

pub use curve::{Curve, CurveMethod, Nodes};
pub use fragments::Fragment;
pub use frame::TexelFrame;
pub(crate) use gpu::TexelShadow;
pub(crate) use lookup::place_hash;
pub use map::TexelMap;
pub(crate) use method::WEIGHT_ONE;
pub use method::{LineProfile, MapScale, TexelMethod};

use std::ops::RangeInclusive;

use lovelock_base::settings::{Choices, Field, Setting, Unit};
use serde::{Deserialize, Serialize};

use crate::RayMarkKind;

/// Texels along each edge that a map can have; multiples of 16.
///
/// The setting is an upper limit: texels are at least as wide as strands, so hair with few, wide strands has fewer.
pub const TEXEL_RESOLUTIONS: RangeInclusive<u32> = 64..=4096;

/// A slice of equal depth: every one in opacity maps, those whose bit is set in occupancy maps.
pub(crate) const SLICE: RayMarkKind = RayMarkKind { label: "Slice", resolves_depth: true };

/// The whole hair of a texel, which the method holds as a function of depth and not as pieces.
pub(crate) const ALL_HAIR: RayMarkKind = RayMarkKind { label: "Hair of the texel", resolves_depth: false };

/// The default number of texels along each edge.
pub(crate) const DEFAULT_RESOLUTION: u32 = 512;

/// The most memory that a map and its build may use together, bytes; `exact` has a setting instead.
pub const MAP_MEMORY_LIMIT_BYTES: u64 = 2 << 30;

/// How a point reads the texels around it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TexelFilter {
    /// Only the texel that contains it.
    Nearest,
    /// The bilinear mean of the transmittances of the four texels around it, each at the point's depth
    /// (percentage-closer filtering over 2 × 2 texels).
    #[default]
    Bilinear,
    /// One texel, after the point is moved by up to half a texel on each axis by a hash of its position. The noise averages out over
    /// many blended strands (Sintorn, Assarsson 2009).
    Jitter,
}

impl TexelFilter {
    /// Every filter, in the order of menus.
    pub const ALL: [Self; 3] = [Self::Nearest, Self::Bilinear, Self::Jitter];
}

impl Choices for TexelFilter {
    const ALL: &'static [Self] = &Self::ALL;

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Nearest => ("nearest", "Nearest"),
            Self::Bilinear => ("bilinear", "Bilinear"),
            Self::Jitter => ("jitter", "Jitter"),
        }
    }
}

/// The depths between which a method holds the hair of a texel as one function.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DepthRange {
    /// The nearest and the farthest hair of the texel. Light before and behind them is exact.
    #[default]
    Texel,
    /// Those of the whole map, as in the publications.
    Map,
}

impl DepthRange {
    /// Both, in the order of menus.
    pub const ALL: [Self; 2] = [Self::Texel, Self::Map];
}

impl Choices for DepthRange {
    const ALL: &'static [Self] = &Self::ALL;

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Texel => ("texel", "Of each texel"),
            Self::Map => ("map", "Of the map"),
        }
    }
}

impl DepthRange {
    /// The ends of the range for the hair of a texel, depths of the map.
    pub(crate) fn ends(self, fragments: &[Fragment]) -> [f32; 2] {
        match self {
            Self::Texel => {
                let depths = || fragments.iter().map(|fragment| fragment.depth());
                [depths().fold(1.0, f32::min), depths().fold(0.0, f32::max)]
            }
            Self::Map => [0.0, 1.0],
        }
    }
}

/// The setting `depth_range` of the methods that hold all hair of a texel as one function.
pub(crate) const fn depth_range<S>(field: Field<S>) -> Setting<S> {
    let text = "Depths between which the function is defined: the hair of each texel, which is more accurate, or the hair of \
                the whole map, as published.";
    Setting::choice::<DepthRange>(field, "Depth range", text)
}

/// The setting `resolution` of every method with texels.
pub(crate) const fn resolution<S>(field: Field<S>) -> Setting<S> {
    let range = [*TEXEL_RESOLUTIONS.start() as u64, *TEXEL_RESOLUTIONS.end() as u64];
    let text = "Maximum number of texels along each edge of the map. More texels show finer shadows and take longer. \
                Texels are never narrower than strands are wide.";
    Setting::count(field, range, "Map resolution", text)
        .unit(Unit::TEXELS)
        .step(16)
        .stops(&[64, 128, 256, 512, 1024, 2048, 4096])
}

/// The setting `filter` of every method with texels.
pub(crate) const fn filter<S>(field: Field<S>) -> Setting<S> {
    let text = "How a point reads the texels around it: the nearest one, with hard steps, the mean of four, or one at a \
                random offset.";
    Setting::choice::<TexelFilter>(field, "Filter", text)
}

#[cfg(test)]
mod tests {
    use lovelock_base::settings::Settings;

    use crate::ExactSettings;

    #[test]
    fn every_resolution_is_brought_into_range() {
        for (asked, used) in
            [(0, 64), (1, 64), (64, 64), (71, 64), (72, 80), (500, 496), (512, 512), (u32::MAX, 4096)]
        {
            let settings = ExactSettings { resolution: asked, ..ExactSettings::default() };
            assert_eq!(settings.clamped().resolution, used);
        }
    }
}
