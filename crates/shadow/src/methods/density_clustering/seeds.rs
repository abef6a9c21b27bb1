//! The initial centres of clusters.

use super::super::texels::Fragment;
use super::ClusterSeeds;
use crate::exp::exp_of_minus;

/// Bins of the histogram of [`ClusterSeeds::Histogram`].
const BINS: usize = 32;

/// The paper's "75 % towards the left": seeds lie at three quarters of their distance from the nearest hair.
const TOWARD_LIGHT: f32 = 0.75;

/// The initial centres, sorted, for hair from `near` to `far`.
pub(super) fn seeds<const K: usize>(
    of: ClusterSeeds,
    fragments: &[Fragment],
    near: f32,
    far: f32,
) -> [f32; K] {
    let mut seeds = [far; K];
    let even = |j: usize| (j as f32 + 0.5) / K as f32;
    for (j, seed) in seeds.iter_mut().enumerate() {
        *seed = match of {
            ClusterSeeds::Uniform => near + (far - near) * even(j),
            ClusterSeeds::TowardLight => near + (far - near) * even(j) * TOWARD_LIGHT,
            ClusterSeeds::Histogram => near + (far - near) * even(j) * 0.5,
        };
    }
    if of == ClusterSeeds::Histogram && far > near {
        let at = quantiles_of_lost_light::<K>(fragments, near, far);
        for (seed, at) in seeds.iter_mut().zip(at) {
            *seed += (far - near) * at * 0.5;
        }
    }
    seeds
}

/// The depths, as fractions of the range, at which (j + ½) / K of the light that the texel absorbs is lost.
fn quantiles_of_lost_light<const K: usize>(fragments: &[Fragment], near: f32, far: f32) -> [f32; K] {
    let mut histogram = [0.0_f64; BINS];
    let per_depth = BINS as f32 / (far - near);
    for fragment in fragments {
        let bin = ((fragment.depth() - near) * per_depth) as usize;
        histogram[bin.min(BINS - 1)] += f64::from(fragment.optical_depth());
    }
    // Light lost before the end of each bin.
    let (mut sum, mut lost) = (0.0, [0.0_f32; BINS + 1]);
    for (bin, depth) in histogram.iter().enumerate() {
        sum += depth;
        lost[bin + 1] = 1.0 - exp_of_minus(sum as f32);
    }
    let mut at = [0.0; K];
    let mut bin = 0;
    for (j, at) in at.iter_mut().enumerate() {
        let wanted = lost[BINS] * (j as f32 + 0.5) / K as f32;
        while bin + 1 < BINS && lost[bin + 1] < wanted {
            bin += 1;
        }
        let in_bin = lost[bin + 1] - lost[bin];
        let part = if in_bin > 0.0 { ((wanted - lost[bin]) / in_bin).clamp(0.0, 1.0) } else { 0.5 };
        *at = (bin as f32 + part) / BINS as f32;
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_seeds_are_interior_and_pulled_ones_keep_the_nearest_hair() {
        let of = |seeds_of| seeds::<4>(seeds_of, &[], 0.2, 0.6);
        for (found, expected) in of(ClusterSeeds::Uniform).iter().zip([0.25, 0.35, 0.45, 0.55]) {
            assert!((found - expected).abs() < 1e-6);
        }
        for (found, expected) in of(ClusterSeeds::TowardLight).iter().zip([0.2375, 0.3125, 0.3875, 0.4625]) {
            assert!((found - expected).abs() < 1e-6);
        }
    }

    #[test]
    fn quantiles_of_even_hair_follow_the_exponential() {
        // τ = 2, spread uniformly: 1 − e^(−2x) = q (1 − e^−2).
        let fragments: Vec<_> =
            (0..3200).map(|i| Fragment::new((i as f32 + 0.5) / 3200.0, 2.0 / 3200.0)).collect();
        let at = quantiles_of_lost_light::<4>(&fragments, 0.0, 1.0);
        for (j, at) in at.iter().enumerate() {
            let q = (j as f64 + 0.5) / 4.0;
            let truth = -0.5 * (1.0 - q * (1.0 - (-2.0_f64).exp())).ln();
            // The quantile is linear within a bin of 1/32, where light falls off a little.
            assert!((f64::from(*at) - truth).abs() < 1e-3, "{j}: {at} not {truth}");
        }
    }

    #[test]
    fn hair_without_optical_depth_has_seeds_in_order() {
        let fragments = [Fragment::new(0.1, 0.0), Fragment::new(0.9, 0.0)];
        for of in [ClusterSeeds::Uniform, ClusterSeeds::TowardLight, ClusterSeeds::Histogram] {
            let seeds = seeds::<8>(of, &fragments, 0.1, 0.9);
            assert!(seeds.is_sorted() && seeds.iter().all(|s| (0.1..=0.9).contains(s)), "{seeds:?}");
        }
    }
}
