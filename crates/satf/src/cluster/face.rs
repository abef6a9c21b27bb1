//! Features of one sector of a cluster, in 32 bits.

use crate::features::Curl;

/// Features of a sector as they are kept: the amount of hair, the centroids and the curl.
///
/// Bits 0 to 15 hold the amount as a part of the cluster's [`scale`](super::Clusters::scales) times 65535, 16 to 21 the
/// centroid along the arc times 63, 22 to 27 that along the radius, 28 and 29 the curl.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[repr(transparent)]
pub struct Face(pub u32);

impl Face {
    pub(crate) fn new(part: f32, s_centroid: f32, t_centroid: f32, curl: Curl) -> Self {
        let bits = |value: f32, most: f32| (value.clamp(0.0, 1.0) * most + 0.5) as u32;
        let curl = (curl as u32) << 28;
        Self(bits(part, 65535.0) | bits(s_centroid, 63.0) << 16 | bits(t_centroid, 63.0) << 22 | curl)
    }

    /// The amount of hair as a part of the cluster's scale, 0 to 1.
    pub fn part(self) -> f32 {
        (self.0 & 0xffff) as f32 / 65535.0
    }

    /// Centroid along the arc, 0 to 1.
    pub fn s_centroid(self) -> f32 {
        (self.0 >> 16 & 63) as f32 / 63.0
    }

    /// Centroid along the radius, 0 to 1.
    pub fn t_centroid(self) -> f32 {
        (self.0 >> 22 & 63) as f32 / 63.0
    }

    /// How far strands move sideways.
    pub fn curl(self) -> Curl {
        match self.0 >> 28 & 3 {
            0 => Curl::Straight,
            1 => Curl::Loose,
            _ => Curl::Tight,
        }
    }
}
