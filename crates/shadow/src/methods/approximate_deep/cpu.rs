//! Light behind the nearest hair.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use lovelock_base::settings::Settings;

use super::super::texels::{ALL_HAIR, Fragment, MapScale, TexelFilter, TexelMap, TexelMethod};
use super::ApproximateDeepSettings;
use crate::{RayMarkKind, ShadowMethod, ShadowSettings};

/// The map of [`ShadowMethod::ApproximateDeep`].
pub type ApproximateDeep = TexelMap<NearestHair>;

/// A record is the depth of the nearest fragment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NearestHair {
    settings: ApproximateDeepSettings,
    /// Optical depth for each unit of depth behind the nearest hair.
    pub(super) slope: f32,
    /// The largest optical depth.
    pub(super) most: f32,
}

impl TexelMethod for NearestHair {
    type Cell = f32;

    const METHOD: ShadowMethod = ShadowMethod::ApproximateDeep;

    fn new(settings: &ShadowSettings) -> Self {
        Self { settings: settings.approximate_deep.clamped(), slope: 0.0, most: 0.0 }
    }

    /// A hair lets 1 − α = e^(−s) of the light through, with the extinction s of the hair: T = (1 − α)ⁿ = e^(−s n).
    fn within(self, scale: &MapScale) -> Self {
        let of_hair = scale.extinction_scale;
        let per_depth = scale.frame.depth_range / self.settings.spacing;
        Self { slope: of_hair * per_depth, most: of_hair * self.settings.hairs as f32, ..self }
    }

    fn resolution(&self) -> u32 {
        self.settings.resolution
    }

    fn filter(&self) -> TexelFilter {
        self.settings.filter
    }

    fn cells(&self) -> usize {
        1
    }

    fn fill(&self, fragments: &mut [Fragment], record: &mut [f32]) {
        record[0] = fragments.iter().map(|fragment| fragment.depth()).fold(1.0, f32::min);
    }

    #[inline(always)]
    fn depth_before(&self, _fragments: &[Fragment], record: &[f32], depth: f32) -> f32 {
        let behind = depth - record[0];
        // Behind all hair of the map, as much as there can be.
        let before = if depth > 1.0 { self.most } else { (behind * self.slope).min(self.most) };
        if behind > 0.0 { before } else { 0.0 }
    }

    fn pieces(
        &self,
        _fragments: &[Fragment],
        record: &[f32],
        put: &mut dyn FnMut(RayMarkKind, [f32; 2], f32),
    ) {
        // Without extinction there is no depth behind which light stays the same.
        let length = if self.slope > 0.0 { self.most / self.slope } else { 0.0 };
        let end = (record[0] + length).min(1.0);
        put(ALL_HAIR, [record[0], end], self.depth_before(&[], record, end.next_up()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_falls_by_one_hair_for_each_spacing_and_stays_behind_the_most() {
        let mut settings = ShadowSettings::default();
        (settings.approximate_deep.spacing, settings.approximate_deep.hairs) = (0.01, 5);
        // The range is 0.1 m: ten hairs.
        let method = NearestHair { slope: 0.15 * 10.0, most: 0.15 * 5.0, ..NearestHair::new(&settings) };
        let mut record = [0.0];
        method.fill(&mut [(0.6, 9.0), (0.3, 0.1)].map(|(z, b)| Fragment::new(z, b)), &mut record);
        for (depth, hairs) in [(0.0, 0.0), (0.3, 0.0), (0.4, 1.0), (0.6, 3.0), (0.9, 5.0), (2.0, 5.0)] {
            let found = method.depth_before(&[], &record, depth);
            assert!((found - 0.15 * hairs).abs() < 1e-6, "at {depth}: {found}");
        }
    }
}
