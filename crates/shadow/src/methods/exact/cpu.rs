//! Sorted fragments with running sums.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use glam::Vec3;
use lovelock_base::settings::Settings;

use super::super::texels::{Fragment, TexelFilter, TexelMap, TexelMethod};
use super::ExactSettings;
use crate::{RayMarkKind, ShadowMethod, ShadowSettings};

/// The map of [`ShadowMethod::Exact`].
pub type ExactMap = TexelMap<SortedFragments>;

/// Every fragment, sorted by depth; each holds the optical depth up to and including itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SortedFragments(ExactSettings);

/// Sorts fragments by depth and replaces the optical depth of each by the sum up to and including itself.
pub(crate) fn sort_and_sum(fragments: &mut [Fragment]) {
    fragments.sort_unstable();
    let mut sum = 0.0_f64;
    for fragment in fragments {
        sum += f64::from(fragment.optical_depth());
        *fragment = Fragment::new(fragment.depth(), sum as f32);
    }
}

/// Optical depth of the fragments before `depth`, which [`sort_and_sum`] has sorted. Fragments at exactly `depth` do not
/// count.
#[inline(always)]
pub(crate) fn sum_before(fragments: &[Fragment], depth: f32) -> f32 {
    count_before(fragments, depth).checked_sub(1).map_or(0.0, |last| fragments[last].optical_depth())
}

/// The number of fragments before `depth`.
#[inline(always)]
fn count_before(fragments: &[Fragment], depth: f32) -> usize {
    fragments.partition_point(|fragment| fragment.depth() < depth)
}

impl ExactMap {
    /// The fragments of a texel of the last build, sorted by depth, each with the optical depth up to and including itself.
    /// Empty before the first build and beside the map.
    pub fn fragments(&self, column: u32, row: u32) -> &[Fragment] {
        let Some(frame) = self.frame() else { return &[] };
        let centre = Vec3::new(column as f32 + 0.5, row as f32 + 0.5, 0.0);
        self.fragments_at(frame.world_from_texel(centre)).0
    }
}

impl TexelMethod for SortedFragments {
    type Cell = ();

    const METHOD: ShadowMethod = ShadowMethod::Exact;

    const READS_FRAGMENTS: bool = true;

    fn new(settings: &ShadowSettings) -> Self {
        Self(settings.exact.clamped())
    }

    fn resolution(&self) -> u32 {
        self.0.resolution
    }

    fn filter(&self) -> TexelFilter {
        self.0.filter
    }

    fn memory_limit_bytes(&self) -> u64 {
        self.0.memory_limit_bytes
    }

    fn cells(&self) -> usize {
        0
    }

    fn fill(&self, fragments: &mut [Fragment], _record: &mut [()]) {
        sort_and_sum(fragments);
    }

    #[inline(always)]
    fn depth_before(&self, fragments: &[Fragment], _record: &[()], depth: f32) -> f32 {
        sum_before(fragments, depth)
    }

    fn pieces(
        &self,
        fragments: &[Fragment],
        _record: &[()],
        put: &mut dyn FnMut(RayMarkKind, [f32; 2], f32),
    ) {
        let mut before = 0.0;
        for fragment in fragments {
            let sum = fragment.optical_depth();
            put(RayMarkKind::FRAGMENT, [fragment.depth(); 2], sum - before);
            before = sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_run_along_the_light_and_leave_out_what_lies_at_the_point() {
        let mut fragments =
            [(0.5, 0.25), (0.1, 1.0), (0.5, 0.5), (0.9, 2.0)].map(|(z, b)| Fragment::new(z, b));
        sort_and_sum(&mut fragments);
        let cases =
            [(0.0, 0.0), (0.1, 0.0), (0.2, 1.0), (0.5, 1.0), (0.500_01, 1.75), (0.9, 1.75), (2.0, 3.75)];
        for (depth, sum) in cases {
            assert_eq!(sum_before(&fragments, depth), sum, "before {depth}");
        }
        assert_eq!(sum_before(&[], 0.5), 0.0);
    }

    #[test]
    fn sums_of_a_hundred_thousand_do_not_drift() {
        let mut fragments: Vec<_> = (0..100_000).map(|i| Fragment::new(i as f32 * 1e-5, 0.1)).collect();
        sort_and_sum(&mut fragments);
        // Exact except for the rounding of 0.1 and of the result; a sum of floats would be off by 1e-2.
        assert!((sum_before(&fragments, 2.0) - 10_000.0).abs() < 2e-3);
    }
}
