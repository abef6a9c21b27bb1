//! The moments of a texel.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use lovelock_base::settings::Settings;

use super::super::texels::whole::{HEADER, part_of};
use super::super::texels::{ALL_HAIR, DepthRange, Fragment, TexelFilter, TexelMap, TexelMethod};
use super::means::{MOST_MEANS, each_function, from_short, to_short};
use super::solve::System;
use super::{MomentKind, MomentsSettings};
use crate::{RayMarkKind, ShadowMethod, ShadowSettings};

/// The map of [`ShadowMethod::Moments`].
pub type Moments = TexelMap<DepthMoments>;

/// The published shares of even hair, by kind, bits (16, 32) and number of moments (4, 6, 8). Of six powers in 32 bits four times as much:
/// with 5 · 10⁻⁶ one texel in a thousand with few strands has no distribution.
const PUBLISHED_BIAS: [[[f32; 3]; 2]; 2] =
    [[[6e-5, 6e-4, 2.5e-3], [5e-7, 2e-5, 5e-5]], [[4e-4, 6.5e-4, 8.5e-4], [4e-7, 8e-7, 1.5e-6]]];

/// A record is a depth range, the optical depth of all hair, and the means of the functions of means.rs, in a cell each or two in one: the bits of
/// floats, or integers of 16 bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthMoments {
    settings: MomentsSettings,
    /// The share of even hair.
    pub(super) bias: f32,
}

impl DepthMoments {
    /// The number of moments.
    pub(super) fn count(&self) -> usize {
        self.settings.count as usize
    }

    /// Whether moments are trigonometric.
    pub(super) fn is_trigonometric(&self) -> bool {
        self.settings.kind == MomentKind::Trigonometric
    }

    /// Whether moments have 16 bits.
    pub(super) fn is_short(&self) -> bool {
        self.settings.bits == 16
    }

    /// Whether depths are those of the whole map.
    pub(super) fn is_of_map(&self) -> bool {
        self.settings.depth_range == DepthRange::Map
    }

    /// The share of a point's own weight that lies before it.
    pub(super) fn overestimation(&self) -> f32 {
        self.settings.overestimation
    }

    /// The means of a record of `COUNT` moments.
    #[inline(always)]
    fn means<const COUNT: usize>(&self, record: &[u32]) -> [f32; MOST_MEANS] {
        let words = &record[HEADER..];
        let mut means = [0.0; MOST_MEANS];
        if self.is_short() {
            for k in 0..COUNT / 2 {
                means[2 * k] = from_short(words[k] & 0xffff);
                means[2 * k + 1] = from_short(words[k] >> 16);
            }
        } else {
            for k in 0..COUNT {
                means[k] = f32::from_bits(words[k]);
            }
        }
        means
    }

    /// The share of hair before `z` by the means of a record; `None` if no distribution has them.
    #[inline(always)]
    fn share<const M: usize, const TURNED: bool>(&self, means: &[f32; MOST_MEANS], z: f32) -> Option<f32> {
        let system = System::<M, TURNED>::new(means, self.bias);
        system.is_solvable().then(|| system.share_before(z, self.settings.overestimation))
    }

    /// The share for every kind but four powers: not inlined into each loop that looks up points, which it would make very long.
    #[inline(never)]
    fn share_of_more(&self, record: &[u32], z: f32) -> Option<f32> {
        match (self.settings.kind, self.settings.count) {
            (MomentKind::Power, 6) => self.share::<3, false>(&self.means::<6>(record), z),
            (MomentKind::Power, _) => self.share::<4, false>(&self.means::<8>(record), z),
            (MomentKind::Trigonometric, 4) => self.share::<2, true>(&self.means::<4>(record), z),
            (MomentKind::Trigonometric, 6) => self.share::<3, true>(&self.means::<6>(record), z),
            (MomentKind::Trigonometric, _) => self.share::<4, true>(&self.means::<8>(record), z),
        }
    }

    /// Whether a distribution has the means of a record.
    #[inline(never)]
    fn is_solvable(&self, record: &[u32]) -> bool {
        match (self.settings.kind, self.settings.count) {
            (MomentKind::Power, 4) => {
                System::<2, false>::new(&self.means::<4>(record), self.bias).is_solvable()
            }
            (MomentKind::Power, 6) => {
                System::<3, false>::new(&self.means::<6>(record), self.bias).is_solvable()
            }
            (MomentKind::Power, _) => {
                System::<4, false>::new(&self.means::<8>(record), self.bias).is_solvable()
            }
            (_, 4) => System::<2, true>::new(&self.means::<4>(record), self.bias).is_solvable(),
            (_, 6) => System::<3, true>::new(&self.means::<6>(record), self.bias).is_solvable(),
            _ => System::<4, true>::new(&self.means::<8>(record), self.bias).is_solvable(),
        }
    }

    #[inline(always)]
    fn share_before(&self, record: &[u32], z: f32) -> Option<f32> {
        if self.settings.count == 4 && self.settings.kind == MomentKind::Power {
            self.share::<2, false>(&self.means::<4>(record), z)
        } else {
            self.share_of_more(record, z)
        }
    }
}

/// z of a depth, −1 to 1 between the ends of a range.
#[inline(always)]
fn warped(near: f32, far: f32, depth: f32) -> f32 {
    part_of(near, far, depth) * 2.0 - 1.0
}

impl TexelMethod for DepthMoments {
    type Cell = u32;

    const METHOD: ShadowMethod = ShadowMethod::Moments;

    fn new(settings: &ShadowSettings) -> Self {
        let settings = settings.moments.clamped();
        let of_kind = PUBLISHED_BIAS[usize::from(settings.kind == MomentKind::Trigonometric)];
        let published = of_kind[usize::from(settings.bits == 32)][settings.count as usize / 2 - 2];
        // More than everything is not even hair.
        Self { settings, bias: (published * settings.bias).min(1.0) }
    }

    fn resolution(&self) -> u32 {
        self.settings.resolution
    }

    fn filter(&self) -> TexelFilter {
        self.settings.filter
    }

    fn cells(&self) -> usize {
        HEADER + if self.is_short() { self.count() / 2 } else { self.count() }
    }

    fn fill(&self, fragments: &mut [Fragment], record: &mut [u32]) {
        let [near, far] = self.settings.depth_range.ends(fragments);
        let (mut all, mut sums) = (0.0_f64, [0.0_f64; MOST_MEANS]);
        for fragment in fragments.iter() {
            let weight = f64::from(fragment.optical_depth());
            all += weight;
            let z = warped(near, far, fragment.depth());
            each_function(self.is_trigonometric(), self.count(), z, |k, value| {
                sums[k] += weight * f64::from(value);
            });
        }
        let per_depth = if all > 0.0 { 1.0 / all } else { 0.0 };
        let means = sums.map(|sum| (sum * per_depth) as f32);
        record[..HEADER].copy_from_slice(&[near, far, all as f32].map(f32::to_bits));
        if self.is_short() {
            for (word, pair) in record[HEADER..].iter_mut().zip(means.chunks_exact(2)) {
                *word = to_short(pair[0]) | to_short(pair[1]) << 16;
            }
        } else {
            for (word, mean) in record[HEADER..].iter_mut().zip(means) {
                *word = mean.to_bits();
            }
        }
    }

    #[inline(always)]
    fn depth_before(&self, _fragments: &[Fragment], record: &[u32], depth: f32) -> f32 {
        let [near, far, all] = [record[0], record[1], record[2]].map(f32::from_bits);
        if depth <= near {
            return 0.0;
        }
        if depth > far {
            return all;
        }
        let z = warped(near, far, depth);
        // Without a distribution, even hair between the ends.
        all * self.share_before(record, z).unwrap_or(0.5 * (z + 1.0))
    }

    /// All hair in one place is a step, for which no system is solved.
    fn falls_back(&self, record: &[u32]) -> bool {
        record[0] != record[1] && !self.is_solvable(record)
    }

    fn pieces(
        &self,
        _fragments: &[Fragment],
        record: &[u32],
        put: &mut dyn FnMut(RayMarkKind, [f32; 2], f32),
    ) {
        let [near, far, all] = [record[0], record[1], record[2]].map(f32::from_bits);
        put(ALL_HAIR, [near, far], all);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn method(change: impl FnOnce(&mut MomentsSettings)) -> DepthMoments {
        let mut settings = ShadowSettings::default();
        change(&mut settings.moments);
        DepthMoments::new(&settings)
    }

    fn filled(method: &DepthMoments, fragments: &[(f32, f32)]) -> Vec<u32> {
        let mut record = vec![u32::MAX; method.cells()];
        let mut fragments: Vec<_> = fragments.iter().map(|(z, b)| Fragment::new(*z, *b)).collect();
        method.fill(&mut fragments, &mut record);
        record
    }

    /// Every kind and number of moments, with 16 and 32 bits.
    fn every_kind() -> impl Iterator<Item = (MomentKind, u32, u32)> {
        [MomentKind::Power, MomentKind::Trigonometric].into_iter().flat_map(|kind| {
            [4, 6, 8].into_iter().flat_map(move |count| [16, 32].map(|bits| (kind, count, bits)))
        })
    }

    /// A slab as fragments.
    fn slab(start: f32, end: f32, depth: f32) -> impl Iterator<Item = (f32, f32)> {
        (0..1000).map(move |i| (start + (end - start) * (i as f32 + 0.5) / 1000.0, depth / 1000.0))
    }

    #[test]
    fn one_slab_is_between_the_bounds() {
        for (kind, count, bits) in every_kind() {
            let bounds = [0.0, 0.25, 1.0].map(|overestimation| {
                let method = method(|s| {
                    (s.kind, s.count, s.bits, s.overestimation) = (kind, count, bits, overestimation);
                });
                let record = filled(&method, &slab(0.2, 0.7, 3.0).collect::<Vec<_>>());
                assert!(!method.falls_back(&record));
                [0.1, 0.3, 0.45, 0.6, 0.8].map(|depth| method.depth_before(&[], &record, depth))
            });
            for (at, truth) in [0.0, 0.6, 1.5, 2.4, 3.0].into_iter().enumerate() {
                let [low, used, high] = bounds.map(|bound| bound[at]);
                let case =
                    format!("{count} {kind:?} moments of {bits} bits: {low}, {used}, {high}, not {truth}");
                // Where trigonometric moments place hair in the wrapping zone, a part of it lies on the wrong side.
                let beyond = if kind == MomentKind::Power { 1e-3 } else { 0.02 };
                assert!(low <= truth + beyond && truth <= high + beyond, "{case}");
                assert!((used - truth).abs() < 0.55, "{case}");
            }
        }
    }

    #[test]
    fn two_slabs_with_a_gap_keep_the_gap_lit() {
        let slabs: Vec<_> = slab(0.1, 0.2, 1.0).chain(slab(0.8, 0.9, 2.0)).collect();
        for (kind, count, bits) in every_kind() {
            let method = method(|s| (s.kind, s.count, s.bits) = (kind, count, bits));
            let record = filled(&method, &slabs);
            for depth in [0.4, 0.5, 0.6] {
                let before = method.depth_before(&[], &record, depth);
                assert!((before - 1.0).abs() < 0.1, "{count} {kind:?} of {bits}: {before} at {depth}");
            }
        }
    }

    #[test]
    fn a_card_is_a_step_and_two_cards_are_two() {
        for (kind, count, bits) in every_kind() {
            let method = method(|s| (s.kind, s.count, s.bits) = (kind, count, bits));
            let record = filled(&method, &[(0.5, 3.0)]);
            assert!(!method.falls_back(&record));
            for (depth, before) in [(0.4, 0.0), (0.5, 0.0), (0.500_1, 3.0)] {
                assert_eq!(method.depth_before(&[], &record, depth), before, "{bits}");
            }
            // Opaque cards one behind the other: the leak between them is known.
            let record = filled(&method, &[(0.25, 3.0), (0.75, 3.0)]);
            let between = method.depth_before(&[], &record, 0.5);
            assert!((between - 3.0).abs() < 0.1, "{bits}: {between}");
        }
    }

    /// The depth range of the map leaves room before and behind the hair, in which moments of 16 bits are at their worst.
    #[test]
    fn one_strand_and_one_opaque_card_keep_their_order() {
        let alls = |bits: u32| if bits == 16 { &[1e-3, 0.15, 16.0, 1e4][..] } else { &[0.15] };
        let mut worst = 0.0_f32;
        for (kind, count, bits) in every_kind() {
            let method = method(|s| {
                (s.kind, s.count, s.bits, s.depth_range) = (kind, count, bits, DepthRange::Map);
            });
            for (&all, place) in alls(bits).iter().flat_map(|all| [0.1, 0.35, 0.5, 0.9].map(|at| (all, at))) {
                let case = format!("{count} {kind:?} of {bits} bits, {all} at {place}");
                let record = filled(&method, &[(place, all)]);
                assert!(!method.falls_back(&record), "{case}");
                let before: Vec<_> = (0..=20)
                    .map(|i| method.depth_before(&[], &record, place - 0.1 + 0.01 * i as f32))
                    .collect();
                assert!(before.iter().all(|depth| (0.0..=all).contains(depth)), "{case}: {before:?}");
                // The bias that 16 bits need blurs the step: a tenth of the range before it and behind it little of it is wrong.
                let wrong = (before[0] / all).max(1.0 - before[20] / all);
                assert!(wrong < 0.05, "{case}: {before:?}");
                worst = worst.max(wrong);
            }
        }
        println!("largest share on the wrong side {worst}");
    }

    #[test]
    fn moments_that_are_no_numbers_fall_back_and_are_counted() {
        let method = method(|s| s.bits = 32);
        let mut record = filled(&method, &[(0.25, 1.0), (0.5, 0.5), (0.75, 1.0)]);
        assert!(!method.falls_back(&record), "control");
        for at in HEADER..record.len() {
            let kept = std::mem::replace(&mut record[at], f32::NAN.to_bits());
            assert!(method.falls_back(&record), "moment {at}");
            // Even hair.
            let middle = method.depth_before(&[], &record, 0.5);
            assert!((middle - 1.25).abs() < 1e-5, "moment {at}: {middle}");
            record[at] = kept;
        }
    }

    #[test]
    fn moments_of_no_distribution_fall_back_to_even_hair() {
        let method = method(|s| (s.bits, s.bias) = (16, 0.0));
        let record = filled(&method, &[(0.25, 1.0), (0.75, 1.0)]);
        assert!(method.falls_back(&record), "two cards have no room for rounding");
        for (depth, before) in [(0.2, 0.0), (0.5, 1.0), (0.625, 1.5), (0.8, 2.0)] {
            let found = method.depth_before(&[], &record, depth);
            assert!((found - before).abs() < 1e-5, "at {depth}: {found}");
        }
    }
}
