//! Columns with slices where their hair is: the definition.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use lovelock_base::settings::Settings;

use super::super::super::texels::{
    Fragment, LineProfile, MapScale, TEXEL_RESOLUTIONS, TexelFilter, TexelMethod,
};
use super::super::CELL;
use crate::{RayMarkKind, ShadowMethod, ShadowSettings};

/// Words of a record before its slices.
pub(super) const HEADER: usize = 3;
/// Bins of equal depth in which the hair of a column is weighed. Each gets its share of the slices.
pub(super) const BINS: usize = 8;
/// The fewest slices of a column.
const LEAST_SLICES: usize = 4;
/// Steps of the ends of a column.
const DEPTHS: f32 = 65_535.0;
/// Steps of the share of hair before a bin; not 255, so that rounding does not decide on the half of a column with two strands.
const SHARES: f32 = 256.0;

/// A record consists of 32-bit words: the depths of the nearest and of the farthest hair, 16 bits each; the shares of hair before each of
/// the eight bins between them, 8 bits each; and the optical depth before the end of each slice (floats).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Columns {
    /// Cells along the edge of the uniform map with the same memory.
    edge: u32,
    slices: usize,
}

/// The placement of the slices of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Places {
    near: f32,
    far: f32,
    /// The share of hair before each bin, lowest byte first.
    shares: u64,
}

impl Places {
    #[inline(always)]
    fn of_words([range, low, high]: [u32; HEADER]) -> Self {
        let shares = u64::from(low) | u64::from(high) << 32;
        Self { near: (range & 0xffff) as f32, far: (range >> 16) as f32, shares }
    }

    fn words(&self) -> [u32; HEADER] {
        [self.near as u32 | (self.far as u32) << 16, self.shares as u32, (self.shares >> 32) as u32]
    }

    /// A depth in bins: 0 before the hair, 8 behind it.
    #[inline(always)]
    fn bins(&self, depth: f32) -> f32 {
        let part = (depth * DEPTHS - self.near) / (self.far - self.near);
        // NaN becomes 0.
        let part = if part > 0.0 { part } else { 0.0 };
        (if part < 1.0 { part } else { 1.0 }) * BINS as f32
    }

    /// The share of hair before bin `bin` and before the next one.
    #[inline(always)]
    fn around(&self, bin: u32) -> [f32; 2] {
        let next = if bin as usize == BINS - 1 { 0x100 } else { self.shares >> (8 * bin + 8) & 0xff };
        [(self.shares >> (8 * bin) & 0xff) as f32, next as f32]
    }

    /// A depth in slices, out of `slices`.
    #[inline(always)]
    fn slice(&self, slices: usize, depth: f32) -> f32 {
        let at = self.bins(depth);
        let bin = (at as u32).min(BINS as u32 - 1);
        let [before, behind] = self.around(bin);
        (before + (behind - before) * (at - bin as f32)) * (slices as f32 / SHARES)
    }

    /// The depth at which `share` of the hair lies before.
    fn depth(&self, share: f32) -> f32 {
        let mut bins = BINS as f32;
        for bin in 0..BINS as u32 {
            let [before, behind] = self.around(bin);
            if behind > before && share <= behind {
                bins = bin as f32 + (share - before) / (behind - before);
                break;
            }
        }
        (self.near + (self.far - self.near) * bins / BINS as f32) / DEPTHS
    }

    /// The placement for the fragments of a column.
    fn of(fragments: &[Fragment]) -> Self {
        let (mut near, mut far) = (1.0_f32, 0.0_f32);
        for fragment in fragments {
            near = near.min(fragment.depth());
            far = far.max(fragment.depth());
        }
        // Rounded outward, and never empty.
        let near = (near * DEPTHS).floor().clamp(0.0, DEPTHS - 1.0);
        let mut places = Self { near, far: (far * DEPTHS).ceil().clamp(near + 1.0, DEPTHS), shares: 0 };
        let mut weights = [0.0_f64; BINS];
        for fragment in fragments {
            weights[(places.bins(fragment.depth()) as usize).min(BINS - 1)] +=
                f64::from(fragment.optical_depth());
        }
        let (whole, mut before) = (weights.iter().sum::<f64>(), 0.0);
        for (bin, weight) in weights.into_iter().enumerate() {
            // Hair without optical depth: even slices.
            let share = if whole > 0.0 { before / whole } else { bin as f64 / BINS as f64 };
            places.shares |= ((share * f64::from(SHARES) + 0.5) as u64).min(0xff) << (8 * bin);
            before += weight;
        }
        places
    }
}

impl Columns {
    /// The slices of a column.
    pub(super) fn slices(&self) -> usize {
        self.slices
    }

    /// The words of a map per cell of the uniform one, rounded up: 1 where there is room for the fewest slices.
    pub(in crate::methods::voxel_map) fn words_per_cell(&self) -> u64 {
        let columns = u64::from(self.resolution()).pow(2);
        (columns * (HEADER + LEAST_SLICES) as u64).div_ceil(u64::from(self.edge).pow(3))
    }
}

impl TexelMethod for Columns {
    type Cell = u32;

    const METHOD: ShadowMethod = ShadowMethod::VoxelMap;

    fn new(settings: &ShadowSettings) -> Self {
        Self { edge: settings.voxel_map.clamped().resolution, slices: LEAST_SLICES }
    }

    /// As many slices as the memory of the uniform map has room for, but no more than that has.
    fn within(self, scale: &MapScale) -> Self {
        let words = u64::from(self.edge).pow(3) / u64::from(scale.frame.resolution).pow(2);
        let most = (self.edge as usize).max(LEAST_SLICES);
        Self { slices: (words as usize).saturating_sub(HEADER).clamp(LEAST_SLICES, most), ..self }
    }

    fn resolution(&self) -> u32 {
        (2 * self.edge).clamp(*TEXEL_RESOLUTIONS.start(), *TEXEL_RESOLUTIONS.end())
    }

    fn filter(&self) -> TexelFilter {
        TexelFilter::Bilinear
    }

    /// Thin lines would be drawn into one row of columns, with errors a third larger on hair as wide as a column.
    fn profile(&self) -> LineProfile {
        LineProfile::TwoTexels
    }

    fn cells(&self) -> usize {
        HEADER + self.slices
    }

    fn fill(&self, fragments: &mut [Fragment], record: &mut [u32]) {
        let places = Places::of(fragments);
        let (header, slices) = record.split_at_mut(HEADER);
        header.copy_from_slice(&places.words());
        slices.fill(0);
        for fragment in fragments.iter() {
            let at = (places.slice(self.slices, fragment.depth()) as usize).min(self.slices - 1);
            slices[at] = (f32::from_bits(slices[at]) + fragment.optical_depth()).to_bits();
        }
        let mut sum = 0.0;
        for slice in slices {
            sum += f32::from_bits(*slice);
            *slice = sum.to_bits();
        }
    }

    #[inline(always)]
    fn depth_before(&self, _fragments: &[Fragment], record: &[u32], depth: f32) -> f32 {
        let Some((header, slices)) = record.split_first_chunk() else { return 0.0 };
        let at = Places::of_words(*header).slice(self.slices, depth);
        let slice = (at as usize).min(self.slices - 1);
        let before = slice.checked_sub(1).map_or(0.0, |last| f32::from_bits(slices[last]));
        before + (f32::from_bits(slices[slice]) - before) * (at - slice as f32)
    }

    fn pieces(
        &self,
        _fragments: &[Fragment],
        record: &[u32],
        put: &mut dyn FnMut(RayMarkKind, [f32; 2], f32),
    ) {
        let Some((header, slices)) = record.split_first_chunk() else { return };
        let places = Places::of_words(*header);
        let end = |slice: usize| places.depth(slice as f32 * SHARES / self.slices as f32);
        let mut before = 0.0;
        for (slice, sum) in slices.iter().enumerate() {
            let sum = f32::from_bits(*sum);
            put(CELL, [end(slice), end(slice + 1)], sum - before);
            before = sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::methods::texels::TexelFrame;

    fn filled(slices: usize, fragments: &[(f32, f32)]) -> (Columns, Vec<u32>) {
        let method = Columns { edge: 32, slices };
        let mut record = vec![0; method.cells()];
        let mut fragments: Vec<_> = fragments.iter().map(|(z, b)| Fragment::new(*z, *b)).collect();
        method.fill(&mut fragments, &mut record);
        (method, record)
    }

    fn before(of: &(Columns, Vec<u32>), depth: f32) -> f32 {
        of.0.depth_before(&[], &of.1, depth)
    }

    #[test]
    fn even_hair_has_an_even_ramp_and_nothing_before_and_behind() {
        let even: Vec<_> = (0..=4096).map(|i| (0.25 + 0.5 * i as f32 / 4096.0, 1.0 / 4097.0)).collect();
        let column = filled(16, &even);
        for (depth, expected) in
            [(0.0, 0.0), (0.24, 0.0), (0.375, 0.25), (0.5, 0.5), (0.6, 0.7), (0.76, 1.0), (2.0, 1.0)]
        {
            assert!((before(&column, depth) - expected).abs() < 2e-3, "{depth}: {}", before(&column, depth));
        }
    }

    #[test]
    fn every_slice_holds_an_equal_share_of_uneven_hair() {
        // Seven eighths of the hair in the second eighth of the depth.
        let dense = (0..7000).map(|i| (0.125 + 0.125 * i as f32 / 7000.0, 1e-3));
        let thin = (0..1000).map(|i| (i as f32 / 999.0, 1e-3));
        let column = filled(32, &dense.chain(thin).collect::<Vec<_>>());
        let mut shares = Vec::new();
        let mut ends = Vec::new();
        column.0.pieces(&[], &column.1, &mut |_, depths, share| {
            shares.push(share * 32.0 / 8.0);
            ends.push(depths);
        });
        // Shares of bins are rounded to 1/256, an eighth of a slice.
        assert!(shares.iter().all(|share| (0.8..1.2).contains(share)), "{shares:?}");
        assert!(ends.windows(2).all(|pair| pair[0][1] == pair[1][0]));
        let within = ends.iter().filter(|[start, end]| *start > 0.12 && *end < 0.255).count();
        assert!(within >= 27, "28 of 32 slices in the dense eighth: {within}");
        // Control: slices of equal depth hold shares of 0.125 and 7.1.
        let even: Vec<_> = (0..32)
            .map(|k| before(&column, (k as f32 + 1.0) / 32.0) - before(&column, k as f32 / 32.0))
            .collect();
        assert!(even.iter().any(|share| *share > 1.7) && even.iter().any(|share| *share < 0.05), "{even:?}");
    }

    #[test]
    fn two_thin_clumps_far_apart_are_resolved_by_slices_thicker_than_both() {
        // Eight slices over the whole range would be 0.125 thick; each clump is 0.02.
        let clump = |at: f32| (0..100).map(move |i| (at + 0.02 * i as f32 / 99.0, 0.01));
        let hair: Vec<_> = clump(0.1).chain(clump(0.88)).collect();
        let column = filled(8, &hair);
        for (depth, expected) in [(0.09, 0.0), (0.3, 1.0), (0.7, 1.0), (0.91, 2.0)] {
            assert!((before(&column, depth) - expected).abs() < 0.02, "{depth}: {}", before(&column, depth));
        }
    }

    #[test]
    fn one_fragment_and_many_at_one_depth_are_a_step() {
        for hair in [vec![(0.5, 0.75)], vec![(0.5, 0.25); 3], vec![(0.0, 0.75)], vec![(1.0, 0.75)]] {
            let column = filled(4, &hair);
            let (depth, _) = hair[0];
            assert_eq!(before(&column, depth - 1e-4), 0.0);
            assert!((before(&column, depth + 1e-4) - 0.75).abs() < 1e-6);
        }
    }

    #[test]
    fn hair_without_optical_depth_and_of_any_depth_is_finite() {
        let column = filled(4, &[(0.2, 0.0), (0.9, 0.0)]);
        for depth in [0.0, 0.5, 1.0, 2.0, f32::NAN] {
            assert_eq!(before(&column, depth), 0.0);
        }
    }

    #[test]
    fn the_memory_is_that_of_the_uniform_map_or_less() {
        let mut settings = ShadowSettings::default();
        for resolution in (32..=512).step_by(8) {
            settings.voxel_map.resolution = resolution;
            let method = Columns::new(&settings);
            for edge in
                [64, 112, 256, method.resolution()].into_iter().filter(|edge| *edge <= method.resolution())
            {
                let frame = TexelFrame { resolution: edge, ..any_frame() };
                let scale = MapScale { frame: &frame, extinction_scale: 1.0, depth_per_texel: 1.0 };
                let words = method.within(&scale).cells() as u64 * u64::from(edge).pow(2);
                assert!(words <= u64::from(resolution).pow(3), "{resolution}: {edge}, {words}");
            }
            assert_eq!(method.words_per_cell(), 1, "{resolution}");
        }
        // No map has fewer columns than 64².
        settings.voxel_map.resolution = 16;
        assert_eq!(Columns::new(&settings).words_per_cell(), 7);
    }

    fn any_frame() -> TexelFrame {
        let strands = lovelock_groom::Strands::default();
        let input = crate::ShadowInput {
            strands: &strands,
            strand_width: 1e-3,
            extinction_scale: 0.15,
            light: crate::LightFrame::default(),
            anchor: glam::Vec3::ZERO,
            maps: 1,
            projected: None,
        };
        TexelFrame::new(&input, 64, &crate::Bounds::EMPTY)
    }
}
