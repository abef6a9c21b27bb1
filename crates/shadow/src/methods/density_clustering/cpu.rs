//! Clusters of fragments, and the bins made of them.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use lovelock_base::settings::Settings;

use super::super::texels::{Fragment, LineProfile, TexelFilter, TexelMap, TexelMethod};
use super::seeds::seeds;
use super::{BIN, ClusterDeviation, DensityClusteringSettings, LineFilter};
use crate::{RayMarkKind, ShadowMethod, ShadowSettings};

/// The map of [`ShadowMethod::DensityClustering`].
pub type DensityClustering = TexelMap<Clustering>;

/// The most clusters per texel.
pub(super) const MAX: usize = *DensityClusteringSettings::CLUSTERS.end() as usize;

/// Half the width of a uniform distribution divided by its standard deviation (the paper's γ).
const GAMMA: f64 = 1.732_050_807_568_877_2;

/// The least width of a bin, as a fraction of the texel's range: a cluster at a single depth has no spread.
const LEAST_WIDTH: f64 = 1.0 / 256.0;

/// The distance outside the bin of its own cluster, as a fraction of the texel's range, at which a fragment still counts as
/// inside. Otherwise rounding would decide where a bin ends at a centre that is itself a fragment.
const SLACK: f64 = 1.0 / 65_536.0;

/// 1 over the width of a bin without width: a step.
const STEEPEST: f64 = 1e30;

/// A range of depths with uniform density.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bin {
    /// The depth at its start.
    pub start: f32,
    /// 1 over its width.
    pub per_depth: f32,
    /// Its optical depth; 0 for an unused bin.
    pub optical_depth: f32,
}

/// A record has one bin per cluster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clustering {
    pub(super) settings: DensityClusteringSettings,
    count: usize,
}

/// Sums over the fragments of a cluster: optical depth, and its products with the offset from the seed and with the squared
/// offset.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    weight: f64,
    offset: f64,
    square: f64,
}

/// The borders between clusters: half way between neighbouring centres. Unused borders are infinite.
fn borders<const K: usize>(centres: &[f32; K], count: usize) -> [f32; K] {
    let mut borders = [f32::INFINITY; K];
    for j in 1..count {
        borders[j - 1] = 0.5 * (centres[j - 1] + centres[j]);
    }
    borders
}

/// The cluster of a depth; a tie goes to the cluster nearer to the light. Centres are sorted, and a clustering step keeps them
/// sorted.
#[inline]
fn cluster<const K: usize>(borders: &[f32; K], depth: f32) -> usize {
    borders.iter().map(|border| usize::from(depth > *border)).sum()
}

/// Sums per cluster, relative to the centres.
fn sums<const K: usize>(fragments: &[Fragment], centres: &[f32; K]) -> [Sums; K] {
    let borders = borders(centres, K);
    let mut sums = [Sums::default(); K];
    for fragment in fragments {
        let j = cluster(&borders, fragment.depth());
        let weight = f64::from(fragment.optical_depth());
        let offset = f64::from(fragment.depth() - centres[j]);
        sums[j].weight += weight;
        sums[j].offset += weight * offset;
        sums[j].square += weight * offset * offset;
    }
    sums
}

impl Clustering {
    /// Centres and standard deviations of the clusters, and whether each contains hair.
    fn clusters<const K: usize>(
        &self,
        fragments: &[Fragment],
        near: f32,
        far: f32,
    ) -> ([f32; K], [f64; K], [bool; K]) {
        let mut centres = seeds(self.settings.seeds, fragments, near, far);
        let mut found = [Sums::default(); K];
        for _ in 0..self.settings.steps {
            found = sums(fragments, &centres);
            for (centre, sums) in centres.iter_mut().zip(&found) {
                if sums.weight > 0.0 {
                    *centre += (sums.offset / sums.weight) as f32;
                }
            }
        }
        let mut deviations = [0.0; K];
        match self.settings.deviation {
            ClusterDeviation::Merged => {
                for (deviation, sums) in deviations.iter_mut().zip(&found) {
                    if sums.weight > 0.0 {
                        let mean = sums.offset / sums.weight;
                        *deviation = (sums.square / sums.weight - mean * mean).max(0.0).sqrt();
                    }
                }
            }
            ClusterDeviation::Exact => {
                found = sums(fragments, &centres);
                for (deviation, sums) in deviations.iter_mut().zip(&found) {
                    if sums.weight > 0.0 {
                        *deviation = (sums.square / sums.weight).sqrt();
                    }
                }
            }
        }
        (centres, deviations, found.map(|sums| sums.weight > 0.0))
    }

    /// [`TexelMethod::fill`] for *K* clusters.
    fn fill_bins<const K: usize>(&self, fragments: &[Fragment], record: &mut [Bin]) {
        record.fill(Bin::default());
        if let [fragment] = fragments {
            // A step: the code below gives the same result.
            record[0] = Bin {
                start: fragment.depth(),
                per_depth: STEEPEST as f32,
                optical_depth: fragment.optical_depth(),
            };
            return;
        }
        let (mut near, mut far) = (1.0_f32, 0.0_f32);
        for fragment in fragments {
            near = near.min(fragment.depth());
            far = far.max(fragment.depth());
        }
        let (centres, deviations, has_hair) = self.clusters::<K>(fragments, near, far);
        // Clusters without hair are removed before neighbours are compared.
        let (mut kept_centres, mut kept_deviations, mut kept) = ([0.0; K], [0.0; K], 0);
        for j in (0..K).filter(|j| has_hair[*j]) {
            (kept_centres[kept], kept_deviations[kept]) = (centres[j], deviations[j]);
            kept += 1;
        }
        if kept == 0 {
            return;
        }
        let least_width = f64::from(far - near) * LEAST_WIDTH;
        let slack = f64::from(far - near) * SLACK;
        let ranges = ranges(&kept_centres, &kept_deviations, least_width, kept);

        let borders = borders(&kept_centres, kept);
        let mut depths = [0.0_f64; K];
        for fragment in fragments {
            // The cluster with the nearest centre, unless the bin of a neighbour contains the fragment.
            let mut j = cluster(&borders, fragment.depth());
            let depth = f64::from(fragment.depth());
            if depth < ranges[j].0 - slack && j > 0 && depth <= ranges[j - 1].1 {
                j -= 1;
            } else if depth > ranges[j].1 + slack && j + 1 < kept && depth >= ranges[j + 1].0 {
                j += 1;
            }
            depths[j] += f64::from(fragment.optical_depth());
        }
        for (j, bin) in record.iter_mut().enumerate().take(kept) {
            let (start, end) = ranges[j];
            // A bin without width is a step.
            let per_depth = if end > start { (1.0 / (end - start)).min(STEEPEST) } else { STEEPEST };
            *bin = Bin { start: start as f32, per_depth: per_depth as f32, optical_depth: depths[j] as f32 };
        }
    }
}

/// Start and end of the bins: ±√3 standard deviations around their centres. Two bins that overlap end at the middle of the
/// overlap. Only the first `count` entries are used.
fn ranges<const K: usize>(
    centres: &[f32; K],
    deviations: &[f64; K],
    least_width: f64,
    count: usize,
) -> [(f64, f64); K] {
    let mut ranges = [(0.0, 0.0); K];
    for j in 0..count {
        let half = (GAMMA * deviations[j]).max(0.5 * least_width);
        ranges[j] = (f64::from(centres[j]) - half, f64::from(centres[j]) + half);
    }
    for j in 1..count {
        let (end, start) = (ranges[j - 1].1, ranges[j].0);
        if end > start {
            // A bin always contains its own centre.
            let border = (0.5 * (end + start)).clamp(f64::from(centres[j - 1]), f64::from(centres[j]));
            ranges[j - 1].1 = border;
            ranges[j].0 = border;
        }
    }
    ranges
}

impl TexelMethod for Clustering {
    type Cell = Bin;

    const METHOD: ShadowMethod = ShadowMethod::DensityClustering;

    fn new(settings: &ShadowSettings) -> Self {
        let settings = settings.density_clustering.clamped();
        Self { settings, count: settings.clusters as usize }
    }

    fn resolution(&self) -> u32 {
        self.settings.resolution
    }

    fn filter(&self) -> TexelFilter {
        self.settings.filter
    }

    fn profile(&self) -> LineProfile {
        match (self.settings.prefiltered, self.settings.line_filter) {
            (false, _) => LineProfile::Thin,
            (true, LineFilter::TwoTexels) => LineProfile::TwoTexels,
            (true, LineFilter::Gaussian) => LineProfile::Gaussian(self.settings.line_width),
        }
    }

    fn cells(&self) -> usize {
        self.count
    }

    fn fill(&self, fragments: &mut [Fragment], record: &mut [Bin]) {
        match *record {
            [_] => self.fill_bins::<1>(fragments, record),
            [_, _] => self.fill_bins::<2>(fragments, record),
            [_, _, _] => self.fill_bins::<3>(fragments, record),
            [_, _, _, _] => self.fill_bins::<4>(fragments, record),
            [_, _, _, _, _] => self.fill_bins::<5>(fragments, record),
            [_, _, _, _, _, _] => self.fill_bins::<6>(fragments, record),
            [_, _, _, _, _, _, _] => self.fill_bins::<7>(fragments, record),
            _ => self.fill_bins::<MAX>(fragments, record),
        }
    }

    #[inline(always)]
    fn depth_before(&self, _fragments: &[Fragment], record: &[Bin], depth: f32) -> f32 {
        let part = |bin: &Bin| ((depth - bin.start) * bin.per_depth).clamp(0.0, 1.0);
        record.iter().map(|bin| bin.optical_depth * part(bin)).sum()
    }

    fn pieces(
        &self,
        _fragments: &[Fragment],
        record: &[Bin],
        put: &mut dyn FnMut(RayMarkKind, [f32; 2], f32),
    ) {
        // The bins in use have the order of their centres.
        for bin in record.iter().filter(|bin| bin.optical_depth > 0.0) {
            put(BIN, [bin.start, bin.start + 1.0 / bin.per_depth], bin.optical_depth);
        }
    }
}

#[cfg(test)]
mod tests;
