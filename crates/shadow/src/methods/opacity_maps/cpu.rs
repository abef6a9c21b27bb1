//! Optical depth at the ends of uniform slices.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use lovelock_base::settings::Settings;

use super::super::texels::{Fragment, SLICE, TexelFilter, TexelMap, TexelMethod};
use super::OpacityMapsSettings;
use crate::{RayMarkKind, ShadowMethod, ShadowSettings};

/// The map of [`ShadowMethod::OpacityMaps`].
pub type OpacityMaps = TexelMap<Slices>;

/// A record is the optical depth before the end of each slice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slices {
    settings: OpacityMapsSettings,
    /// Number of slices.
    count: usize,
}

impl Slices {
    /// The slice that contains a depth, and the position in it, 0 to 1; above 1 for depths behind all slices.
    #[inline(always)]
    fn slice(&self, depth: f32) -> (usize, f32) {
        let slices = depth * self.count as f32;
        let slice = (slices as usize).min(self.count - 1);
        (slice, slices - slice as f32)
    }
}

impl TexelMethod for Slices {
    type Cell = f32;

    const METHOD: ShadowMethod = ShadowMethod::OpacityMaps;

    fn new(settings: &ShadowSettings) -> Self {
        let settings = settings.opacity_maps.clamped();
        Self { settings, count: settings.slices as usize }
    }

    fn resolution(&self) -> u32 {
        self.settings.resolution
    }

    fn filter(&self) -> TexelFilter {
        self.settings.filter
    }

    fn cells(&self) -> usize {
        self.count
    }

    fn fill(&self, fragments: &mut [Fragment], record: &mut [f32]) {
        // Cells are 0 before the first slice with hair, and constant from the last one on.
        let (mut first, mut last) = (self.count - 1, 0);
        for fragment in fragments.iter() {
            let (slice, _) = self.slice(fragment.depth());
            (first, last) = (first.min(slice), last.max(slice));
        }
        record[..=last].fill(0.0);
        for fragment in fragments.iter() {
            record[self.slice(fragment.depth()).0] += fragment.optical_depth();
        }
        let mut sum = 0.0;
        for cell in &mut record[first..=last] {
            sum += *cell;
            *cell = sum;
        }
        record[last + 1..].fill(sum);
    }

    #[inline(always)]
    fn reads(&self, depth: f32) -> [usize; 2] {
        let (slice, _) = self.slice(depth);
        [slice.saturating_sub(1), slice]
    }

    #[inline(always)]
    fn depth_before(&self, _fragments: &[Fragment], record: &[f32], depth: f32) -> f32 {
        let (slice, part) = self.slice(depth);
        let before = slice.checked_sub(1).map_or(0.0, |last| record[last]);
        before + (record[slice] - before) * part.min(1.0)
    }

    fn pieces(
        &self,
        _fragments: &[Fragment],
        record: &[f32],
        put: &mut dyn FnMut(RayMarkKind, [f32; 2], f32),
    ) {
        let (thickness, mut before) = (1.0 / self.count as f32, 0.0);
        for (slice, sum) in record.iter().enumerate() {
            put(SLICE, [slice, slice + 1].map(|end| end as f32 * thickness), sum - before);
            before = *sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn method(slices: u32) -> Slices {
        let mut settings = ShadowSettings::default();
        settings.opacity_maps.slices = slices;
        Slices::new(&settings)
    }

    #[test]
    fn optical_depth_rises_through_the_slice_of_a_fragment() {
        let method = method(8);
        let mut record = [0.0; 8];
        method.fill(&mut [Fragment::new(0.3, 1.0), Fragment::new(1.0, 0.5)], &mut record);
        assert_eq!(record, [0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.5]);
        let cases =
            [(0.0, 0.0), (0.25, 0.0), (0.3125, 0.5), (0.375, 1.0), (0.9375, 1.25), (1.0, 1.5), (2.0, 1.5)];
        for (depth, before) in cases {
            assert_eq!(method.depth_before(&[], &record, depth), before, "at {depth}");
        }
    }

    #[test]
    fn the_end_of_the_range_belongs_to_the_last_slice() {
        for slices in [0, 8, 100, 256, u32::MAX] {
            let method = method(slices);
            let mut record = vec![0.0; method.cells()];
            method.fill(&mut [Fragment::new(1.0, 0.5)], &mut record);
            assert_eq!(method.depth_before(&[], &record, 2.0), 0.5);
        }
    }
}
