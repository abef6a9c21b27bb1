//! The moments of a texel.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use lovelock_base::settings::Settings;

use super::super::texels::whole::{HEADER, part_of};
use super::super::texels::{ALL_HAIR, DepthRange, Fragment, TexelFilter, TexelMap, TexelMethod};
use super::MomentsSettings;
use super::pack::{pack, unpack};
use super::solve::System;
use crate::{RayMarkKind, ShadowMethod, ShadowSettings};

/// The map of [`ShadowMethod::Moments`].
pub type Moments = TexelMap<PowerMoments>;

/// A record is a depth range, the optical depth of all hair, and four moments, in a cell each or two in one: the bits of floats, or
/// integers of 16 bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PowerMoments {
    settings: MomentsSettings,
    /// The share of even hair.
    pub(super) bias: f32,
}

impl PowerMoments {
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

    /// The system of a record.
    #[inline(always)]
    fn system(&self, record: &[u32]) -> System {
        let words = &record[HEADER..];
        let moments = if self.is_short() {
            unpack([words[0], words[1]])
        } else {
            [words[0], words[1], words[2], words[3]].map(f32::from_bits)
        };
        System::new(moments, self.bias)
    }
}

/// z of a depth, −1 to 1 between the ends of a range.
#[inline(always)]
fn warped(near: f32, far: f32, depth: f32) -> f32 {
    part_of(near, far, depth) * 2.0 - 1.0
}

impl TexelMethod for PowerMoments {
    type Cell = u32;

    const METHOD: ShadowMethod = ShadowMethod::Moments;

    fn new(settings: &ShadowSettings) -> Self {
        let settings = settings.moments.clamped();
        let published = if settings.bits == 16 { 6e-5 } else { 5e-7 };
        Self { settings, bias: published * settings.bias }
    }

    fn resolution(&self) -> u32 {
        self.settings.resolution
    }

    fn filter(&self) -> TexelFilter {
        self.settings.filter
    }

    fn cells(&self) -> usize {
        HEADER + if self.is_short() { 2 } else { 4 }
    }

    fn fill(&self, fragments: &mut [Fragment], record: &mut [u32]) {
        let [near, far] = self.settings.depth_range.ends(fragments);
        let mut sums = [0.0_f64; 5];
        for fragment in fragments.iter() {
            let (z, mut power) =
                (f64::from(warped(near, far, fragment.depth())), f64::from(fragment.optical_depth()));
            for sum in &mut sums {
                *sum += power;
                power *= z;
            }
        }
        let per_depth = if sums[0] > 0.0 { 1.0 / sums[0] } else { 0.0 };
        let moments = [1, 2, 3, 4].map(|k| (sums[k] * per_depth) as f32);
        record[..HEADER].copy_from_slice(&[near, far, sums[0] as f32].map(f32::to_bits));
        if self.is_short() {
            record[HEADER..].copy_from_slice(&pack(moments));
        } else {
            record[HEADER..].copy_from_slice(&moments.map(f32::to_bits));
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
        let system = self.system(record);
        // Without a distribution, even hair between the ends.
        let share = if system.is_solvable() {
            system.share_before(z, self.settings.overestimation)
        } else {
            0.5 * (z + 1.0)
        };
        all * share
    }

    /// All hair in one place is a step, for which no system is solved.
    fn falls_back(&self, record: &[u32]) -> bool {
        record[0] != record[1] && !self.system(record).is_solvable()
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

    fn method(change: impl FnOnce(&mut MomentsSettings)) -> PowerMoments {
        let mut settings = ShadowSettings::default();
        change(&mut settings.moments);
        PowerMoments::new(&settings)
    }

    fn filled(method: &PowerMoments, fragments: &[(f32, f32)]) -> Vec<u32> {
        let mut record = vec![u32::MAX; method.cells()];
        let mut fragments: Vec<_> = fragments.iter().map(|(z, b)| Fragment::new(*z, *b)).collect();
        method.fill(&mut fragments, &mut record);
        record
    }

    /// A slab as fragments.
    fn slab(start: f32, end: f32, depth: f32) -> impl Iterator<Item = (f32, f32)> {
        (0..1000).map(move |i| (start + (end - start) * (i as f32 + 0.5) / 1000.0, depth / 1000.0))
    }

    #[test]
    fn one_slab_is_between_the_bounds() {
        for bits in [16, 32] {
            let bounds = [0.0, 0.25, 1.0].map(|overestimation| {
                let method = method(|s| (s.bits, s.overestimation) = (bits, overestimation));
                let record = filled(&method, &slab(0.2, 0.7, 3.0).collect::<Vec<_>>());
                assert!(!method.falls_back(&record));
                [0.1, 0.3, 0.45, 0.6, 0.8].map(|depth| method.depth_before(&[], &record, depth))
            });
            for (at, truth) in [0.0, 0.6, 1.5, 2.4, 3.0].into_iter().enumerate() {
                let [low, used, high] = bounds.map(|bound| bound[at]);
                assert!(low <= truth + 1e-3 && truth <= high + 1e-3, "{bits}: {low}, {truth}, {high}");
                assert!((used - truth).abs() < 0.55, "{bits}: {used}, not {truth}");
            }
        }
    }

    #[test]
    fn two_slabs_with_a_gap_keep_the_gap_lit() {
        let slabs: Vec<_> = slab(0.1, 0.2, 1.0).chain(slab(0.8, 0.9, 2.0)).collect();
        for bits in [16, 32] {
            let method = method(|s| s.bits = bits);
            let record = filled(&method, &slabs);
            for depth in [0.4, 0.5, 0.6] {
                let before = method.depth_before(&[], &record, depth);
                assert!((before - 1.0).abs() < 0.1, "{bits}: {before} at {depth}");
            }
        }
    }

    #[test]
    fn a_card_is_a_step_and_two_cards_are_two() {
        for bits in [16, 32] {
            let method = method(|s| s.bits = bits);
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
    fn one_strand_and_one_opaque_card_in_16_bits_keep_their_order() {
        let method = method(|s| (s.bits, s.depth_range) = (16, DepthRange::Map));
        for all in [1e-3, 0.15, 16.0, 1e4] {
            for place in [0.1, 0.5, 0.9] {
                let record = filled(&method, &[(place, all)]);
                assert!(!method.falls_back(&record), "{all} at {place}");
                let before: Vec<_> = (0..=20)
                    .map(|i| method.depth_before(&[], &record, place - 0.1 + 0.01 * i as f32))
                    .collect();
                assert!(
                    before.iter().all(|depth| (0.0..=all).contains(depth)),
                    "{all} at {place}: {before:?}"
                );
                // The bias that 16 bits need blurs the step: a tenth of the range before it and behind it little of it is wrong.
                assert!(before[0] < 0.05 * all && before[20] > 0.95 * all, "{all} at {place}: {before:?}");
            }
        }
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
