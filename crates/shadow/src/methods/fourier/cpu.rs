//! The series of a texel.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use lovelock_base::settings::Settings;

use super::super::texels::turn::{turn, turn_on};
use super::super::texels::whole::{HEADER, part_of};
use super::super::texels::{ALL_HAIR, DepthRange, Fragment, TexelFilter, TexelMap, TexelMethod};
use super::FourierSettings;
use crate::{RayMarkKind, ShadowMethod, ShadowSettings};

/// The map of [`ShadowMethod::Fourier`].
pub type Fourier = TexelMap<Series>;

/// The most terms.
const MAX_TERMS: usize = 15;

/// A record is a depth range, the optical depth of all hair, and two coefficients per term, as shares of that and ready to be multiplied
/// with sine and 1 − cosine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Series {
    settings: FourierSettings,
    /// Number of terms besides the constant one.
    pub(super) terms: usize,
    /// The factor of each term: 1/πk, and the window.
    pub(super) factors: [f32; MAX_TERMS],
    /// The part of the period that is empty at each end: half the wavelength of the first term that is left out. The series is
    /// periodic: without it, the first and the last hair would be in one place.
    pub(super) margin: f32,
}

impl Series {
    /// The place of a depth in the period of the series.
    #[inline(always)]
    fn place(&self, near: f32, far: f32, depth: f32) -> f32 {
        self.margin + part_of(near, far, depth) * (1.0 - 2.0 * self.margin)
    }

    /// Whether the series is defined between the ends of the whole map.
    pub(super) fn is_of_map(&self) -> bool {
        self.settings.depth_range == DepthRange::Map
    }
}

impl TexelMethod for Series {
    type Cell = f32;

    const METHOD: ShadowMethod = ShadowMethod::Fourier;

    fn new(settings: &ShadowSettings) -> Self {
        let settings = settings.fourier.clamped();
        let terms = settings.terms as usize;
        let mut factors = [0.0; MAX_TERMS];
        for (factor, k) in factors.iter_mut().zip(1..=terms) {
            let angle = std::f64::consts::PI * k as f64;
            let turned = angle / (terms + 1) as f64;
            let window = if settings.window { turned.sin() / turned } else { 1.0 };
            *factor = (window / angle) as f32;
        }
        Self { settings, terms, factors, margin: 0.5 / (terms + 1) as f32 }
    }

    fn resolution(&self) -> u32 {
        self.settings.resolution
    }

    fn filter(&self) -> TexelFilter {
        self.settings.filter
    }

    fn cells(&self) -> usize {
        HEADER + 2 * self.terms
    }

    fn fill(&self, fragments: &mut [Fragment], record: &mut [f32]) {
        let [near, far] = self.settings.depth_range.ends(fragments);
        let all: f64 = fragments.iter().map(|fragment| f64::from(fragment.optical_depth())).sum();
        let mut sums = [[0.0_f64; 2]; MAX_TERMS];
        for fragment in fragments.iter() {
            let one = turn(self.place(near, far, fragment.depth()));
            let mut turned = one;
            for sum in &mut sums[..self.terms] {
                let share = f64::from(fragment.optical_depth());
                *sum = [sum[0] + share * f64::from(turned[0]), sum[1] + share * f64::from(turned[1])];
                turned = turn_on(turned, one);
            }
        }
        record[..HEADER].copy_from_slice(&[near, far, all as f32]);
        let per_depth = if all > 0.0 { 1.0 / all } else { 0.0 };
        let cells = record[HEADER..].chunks_exact_mut(2);
        for ((cells, sum), factor) in cells.zip(&sums).zip(&self.factors) {
            cells.copy_from_slice(&sum.map(|sum| (sum * per_depth) as f32 * factor));
        }
    }

    #[inline(always)]
    fn depth_before(&self, _fragments: &[Fragment], record: &[f32], depth: f32) -> f32 {
        let (near, far, all) = (record[0], record[1], record[2]);
        if depth <= near {
            return 0.0;
        }
        if depth > far {
            return all;
        }
        let place = self.place(near, far, depth);
        let one = turn(place);
        let (mut turned, mut share) = (one, place);
        for coefficients in record[HEADER..].chunks_exact(2) {
            share += coefficients[0] * turned[1] + coefficients[1] * (1.0 - turned[0]);
            turned = turn_on(turned, one);
        }
        // All hair at one depth lies behind it.
        let share = if far > near && share > 0.0 { share } else { 0.0 };
        all * share
    }

    fn pieces(
        &self,
        _fragments: &[Fragment],
        record: &[f32],
        put: &mut dyn FnMut(RayMarkKind, [f32; 2], f32),
    ) {
        put(ALL_HAIR, [record[0], record[1]], record[2]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn method(terms: u32, window: bool, depth_range: DepthRange) -> Series {
        let mut settings = ShadowSettings::default();
        settings.fourier = super::FourierSettings { terms, window, depth_range, ..settings.fourier };
        Series::new(&settings)
    }

    fn filled(method: &Series, fragments: &[(f32, f32)]) -> Vec<f32> {
        let mut record = vec![f32::NAN; method.cells()];
        let mut fragments: Vec<_> = fragments.iter().map(|(z, b)| Fragment::new(*z, *b)).collect();
        method.fill(&mut fragments, &mut record);
        record
    }

    /// The slabs as fragments: start, end, optical depth.
    fn slabs(of: &[(f32, f32, f32)]) -> Vec<(f32, f32)> {
        let fragment = |&(start, end, depth): &(f32, f32, f32)| {
            (0..2000).map(move |i| (start + (end - start) * (i as f32 + 0.5) / 2000.0, depth / 2000.0))
        };
        of.iter().flat_map(fragment).collect()
    }

    /// The largest error of optical depth before 99 depths.
    fn worst(method: &Series, of: &[(f32, f32, f32)]) -> f32 {
        let record = filled(method, &slabs(of));
        let error = |i: u16| {
            let depth = f32::from(i) * 0.01;
            let before = |&(start, end, all): &(f32, f32, f32)| {
                all * ((depth - start) / (end - start)).clamp(0.0, 1.0)
            };
            (method.depth_before(&[], &record, depth) - of.iter().map(before).sum::<f32>()).abs()
        };
        (1..100).map(error).fold(0.0, f32::max)
    }

    #[test]
    fn more_terms_come_nearer_to_one_slab_and_to_two_with_a_gap() {
        for of in [&[(0.2, 0.7, 3.0)][..], &[(0.1, 0.3, 1.0), (0.6, 0.9, 2.0)]] {
            let errors = [3, 7, 15].map(|terms| worst(&method(terms, false, DepthRange::Texel), of));
            assert!(errors.is_sorted_by(|more, less| more > less), "{errors:?}");
            assert!(errors[2] < 0.06, "{errors:?}");
        }
    }

    #[test]
    fn a_card_is_a_step_between_the_ends_of_the_texel_and_rings_between_those_of_the_map() {
        let card = [(0.5, 3.0)];
        let exact = method(7, false, DepthRange::Texel);
        let record = filled(&exact, &card);
        for (depth, before) in [(0.2, 0.0), (0.5, 0.0), (0.500_1, 3.0), (2.0, 3.0)] {
            assert_eq!(exact.depth_before(&[], &record, depth), before, "at {depth}");
        }
        let swing = |window: bool| {
            let method = method(7, window, DepthRange::Map);
            let record = filled(&method, &card);
            let before = (0..40).map(|i| method.depth_before(&[], &record, i as f32 * 0.01));
            before.fold(0.0, f32::max)
        };
        // Waves of a twentieth of the card before it, which the window reduces.
        assert!(swing(false) > 0.1 && swing(true) < 0.5 * swing(false), "{} {}", swing(false), swing(true));
    }

    #[test]
    fn everything_before_is_lit_and_all_counts_behind() {
        let method = method(3, false, DepthRange::Texel);
        let record = filled(&method, &[(0.25, 0.5), (0.5, 0.25), (0.75, 0.5)]);
        assert_eq!(method.depth_before(&[], &record, 0.25), 0.0);
        assert_eq!(method.depth_before(&[], &record, 0.8), 1.25);
        // Half way there are the first and half of the second.
        let middle = method.depth_before(&[], &record, 0.5);
        assert!((middle - 0.625).abs() < 1e-3, "{middle}");
    }
}
