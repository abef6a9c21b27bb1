//! What the methods with a record for each light texel share.
//!
//! Strands are drawn into the texels of a light ([`TexelFrame`]) as fragments, each with a depth and an optical
//! depth. A method is then a function from the fragments of one texel to a record, and one from a record and a depth
//! to the optical depth before it ([`TexelMethod`]); [`TexelMap`] does the rest.

pub(crate) mod fragments;
pub(crate) mod frame;
pub(crate) mod gpu;
pub(crate) mod lines;
mod lookup;
pub(crate) mod map;
mod method;

pub use fragments::Fragment;
pub use frame::TexelFrame;
pub(crate) use gpu::TexelShadow;
pub use map::TexelMap;
pub use method::TexelMethod;

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use crate::RayMarkKind;

/// Texels along each edge that a map can have; multiples of 16.
///
/// A setting is the most that a map has: texels are no narrower than strands are wide, so that hair of few, wide
/// strands has fewer.
pub const TEXEL_RESOLUTIONS: RangeInclusive<u32> = 64..=2048;

/// A slice of even depth: of opacity maps every one, of occupancy maps those whose bit is set.
pub(crate) const SLICE: RayMarkKind = RayMarkKind { label: "Slice", resolves_depth: true };

/// Texels along each edge to begin with.
pub(crate) const DEFAULT_RESOLUTION: u32 = 512;

/// Memory that a map and its build may take together, bytes; `exact` has a limit of its own.
pub const MAP_MEMORY_LIMIT_BYTES: u64 = 2 << 30;

/// How a point reads the texels around it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TexelFilter {
    /// The texel that it lies in alone.
    Nearest,
    /// The bilinear mean of the transmittances of the four texels around it, each at the point's depth
    /// (percentage-closer filtering over 2 × 2 texels).
    #[default]
    Bilinear,
    /// One texel, after the point was moved by up to half a texel on each axis, by chance but the same for a place: noise
    /// that many blended strands even out, as Sintorn and Assarsson 2009 have it.
    Jitter,
}

impl TexelFilter {
    /// Every filter, in the order of menus.
    pub const ALL: [Self; 3] = [Self::Nearest, Self::Bilinear, Self::Jitter];
}

/// The resolution that is used: the nearest multiple of 16 in [`TEXEL_RESOLUTIONS`].
pub(crate) fn safe_resolution(resolution: u32) -> u32 {
    (resolution.clamp(*TEXEL_RESOLUTIONS.start(), *TEXEL_RESOLUTIONS.end()) + 8) / 16 * 16
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_resolution_is_brought_into_range() {
        for (asked, used) in
            [(0, 64), (1, 64), (64, 64), (71, 64), (72, 80), (500, 496), (512, 512), (u32::MAX, 2048)]
        {
            assert_eq!(safe_resolution(asked), used);
        }
    }
}
