//! Semantics: the features of a sector by which the database finds its record.
//!
//! The paper's index is the average density and the averages of the marginal histograms along s and t. The average of a
//! marginal is the overall average times a constant, so those three numbers are one. The features here keep the density and
//! add what the marginals can tell, their centroids, and the curl, which the paper leaves open.

use crate::layout::{CURLS, DEPTHS, PATTERNS, S_CENTROIDS, SECTORS, STORED_S_CENTROIDS, T_CENTROIDS};

/// Optical depths of the first and the last bin; those between are equally spaced in the logarithm.
const DEPTH_RANGE: [f32; 2] = [0.02, 8.0];
/// Centres of the bins of both centroids. Centroids of many strands are close to the middle, so the bins are too.
pub const CENTROIDS: [f32; T_CENTROIDS] = [0.28, 0.44, 0.56, 0.72];

/// How far strands move sideways between the two ends of a hair shell volume.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Curl {
    /// Less than 0.12 widths of the sector.
    #[default]
    Straight,
    /// An arc: up to 0.36 widths.
    Loose,
    /// A turn or more.
    Tight,
}

impl Curl {
    /// All classes, in the order of the database.
    pub const ALL: [Self; CURLS] = [Self::Straight, Self::Loose, Self::Tight];

    /// The class of a strand whose extent sideways over one hair shell volume is `reach` widths of the sector.
    pub fn of_reach(reach: f32) -> Self {
        match reach {
            r if r >= 0.36 => Self::Tight,
            r if r >= 0.12 => Self::Loose,
            _ => Self::Straight,
        }
    }
}

/// The features of a sector. Symbol: `ρ_feature`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Features {
    /// Optical depth along the radius, from the inner to the outer edge.
    pub optical_depth: f32,
    /// Centroid of the density along the arc, 0..=1.
    pub s_centroid: f32,
    /// Centroid of the density along the radius, 0 inner to 1 outer.
    pub t_centroid: f32,
    /// How far strands move sideways.
    pub curl: Curl,
}

impl Default for Features {
    /// No hair.
    fn default() -> Self {
        Self { optical_depth: 0.0, s_centroid: 0.5, t_centroid: 0.5, curl: Curl::Straight }
    }
}

/// A sector of the database that stands for another one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SectorRef {
    /// Number of the sector, below [`crate::layout::SECTORS`].
    pub index: u32,
    /// Whether the sector is the mirror image: u becomes 1 − u, and azimuths change their signs.
    pub mirrored: bool,
    /// The optical depth that is wanted, divided by that of the stored sector. The opacity becomes
    /// `1 − (1 − α)^tau_ratio`, which is exact; 1 leaves it as it is.
    pub tau_ratio: f32,
}

impl SectorRef {
    /// The sector with the features nearest to `features`. Anything but a positive optical depth finds no hair.
    pub fn of(features: &Features) -> Self {
        let depth = depth_bin(features.optical_depth);
        let s = centroid_bin(features.s_centroid);
        let t = centroid_bin(features.t_centroid);
        let mirrored = s >= STORED_S_CENTROIDS;
        let stored = if mirrored { S_CENTROIDS - 1 - s } else { s };
        let pattern = (features.curl as usize * T_CENTROIDS + t) * STORED_S_CENTROIDS + stored;
        let ratio = features.optical_depth / depth_of(depth);
        Self {
            index: (pattern * DEPTHS + depth) as u32,
            mirrored,
            // False for NaN.
            tau_ratio: if ratio > 0.0 { ratio.min(1e6) } else { 0.0 },
        }
    }

    /// The paper's index, read literally: the average density alone, and the stored record as it is. Where the centroids
    /// are in the middle, the sector left of it stands for both.
    pub fn literal(optical_depth: f32) -> Self {
        let found = Self::of(&Features { optical_depth, s_centroid: CENTROIDS[1], ..Features::default() });
        Self { tau_ratio: if optical_depth > 0.5 * DEPTH_RANGE[0] { 1.0 } else { 0.0 }, ..found }
    }
}

/// The optical depth of the sectors in bin `bin`.
pub fn depth_of(bin: usize) -> f32 {
    let [first, last] = DEPTH_RANGE;
    first * (last / first).powf(bin as f32 / (DEPTHS - 1) as f32)
}

fn depth_bin(depth: f32) -> usize {
    let [first, last] = DEPTH_RANGE;
    // The logarithm is NaN or infinite without hair; the conversion gives 0 for those.
    let at = (depth / first).ln() / (last / first).ln() * (DEPTHS - 1) as f32;
    (at + 0.5).clamp(0.0, (DEPTHS - 1) as f32) as usize
}

fn centroid_bin(centroid: f32) -> usize {
    CENTROIDS.windows(2).filter(|pair| centroid > 0.5 * (pair[0] + pair[1])).count()
}

/// The features for which sector `index` of the database was made. An index past the last is that of the last.
pub fn features_of(index: usize) -> Features {
    let index = index.min(SECTORS - 1);
    let (curl, [s_centroid, t_centroid]) = pattern(index / DEPTHS);
    Features { optical_depth: depth_of(index % DEPTHS), s_centroid, t_centroid, curl }
}

/// Curl and wanted centroids along s and t of the sectors in pattern `pattern`.
pub(crate) fn pattern(pattern: usize) -> (Curl, [f32; 2]) {
    debug_assert!(pattern < PATTERNS, "a pattern that does not exist");
    let (rest, s) = (pattern / STORED_S_CENTROIDS, pattern % STORED_S_CENTROIDS);
    (Curl::ALL[rest / T_CENTROIDS], [CENTROIDS[s], CENTROIDS[rest % T_CENTROIDS]])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_bin_finds_itself_and_its_mirror_image() {
        for index in 0..PATTERNS * DEPTHS {
            let features = features_of(index);
            let found = SectorRef::of(&features);
            assert_eq!((found.index, found.mirrored), (index as u32, false));
            assert!((found.tau_ratio - 1.0).abs() < 1e-5);
            let mirror = SectorRef::of(&Features { s_centroid: 1.0 - features.s_centroid, ..features });
            assert_eq!(mirror, SectorRef { mirrored: true, ..found });
        }
    }

    #[test]
    fn optical_depths_between_bins_are_rescaled_by_less_than_a_bin() {
        for i in 0..1000 {
            let depth = 0.02 * 400.0_f32.powf(i as f32 / 999.0);
            let found = SectorRef::of(&Features { optical_depth: depth, ..Features::default() });
            assert!((0.8..1.25).contains(&found.tau_ratio), "{depth}: {found:?}");
            let again = found.tau_ratio * depth_of(found.index as usize % DEPTHS);
            assert!((again - depth).abs() < 1e-5 * depth);
        }
    }

    #[test]
    fn what_is_no_density_finds_no_hair() {
        for depth in [0.0, -1.0, f32::NAN, f32::NEG_INFINITY] {
            let features = Features { optical_depth: depth, s_centroid: f32::NAN, ..Features::default() };
            assert_eq!(SectorRef::of(&features).tau_ratio, 0.0);
            assert_eq!(SectorRef::literal(depth).tau_ratio, 0.0);
        }
        let much = SectorRef::of(&Features { optical_depth: f32::INFINITY, ..Features::default() });
        assert_eq!((much.index as usize % DEPTHS, much.tau_ratio), (DEPTHS - 1, 1e6));
    }
}
