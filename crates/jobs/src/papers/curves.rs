//! Visibility along one ray of light: what the methods with a record per texel make of a list of fragments.

use lovelock_base::random::SplitMix64;
use lovelock_metrics::errors;
use lovelock_shadow::ShadowSettings;
use lovelock_shadow::methods::texels::{Fragment, TexelMethod};

use super::report::CurveReport;

/// Depths at which curves are computed, from 0 to 1.
pub(super) const SAMPLES: usize = 401;

/// The depth of a sample.
pub(super) fn depth(at: usize) -> f32 {
    at as f32 / (SAMPLES - 1) as f32
}

/// The transmittance that a method finds at each sample of a texel with these fragments.
pub(super) fn curve<M: TexelMethod>(settings: &ShadowSettings, fragments: &[Fragment]) -> Vec<f32> {
    let method = M::new(settings);
    let mut fragments = fragments.to_vec();
    let mut record = vec![M::Cell::default(); method.cells()];
    method.fill(&mut fragments, &mut record);
    let known: &[Fragment] = if M::READS_FRAGMENTS { &fragments } else { &[] };
    (0..SAMPLES).map(|at| (-method.depth_before(known, &record, depth(at))).exp()).collect()
}

/// The exact transmittance: a step at every fragment.
pub(super) fn steps(fragments: &[Fragment]) -> Vec<f32> {
    let mut sorted = fragments.to_vec();
    sorted.sort_unstable();
    let before = |depth: f32| -> f32 {
        sorted
            .iter()
            .take_while(|fragment| fragment.depth() < depth)
            .map(|fragment| fragment.optical_depth())
            .sum()
    };
    (0..SAMPLES).map(|at| (-before(depth(at))).exp()).collect()
}

/// The same fragments with depths from 0 to 1 between the nearest and the farthest.
pub(super) fn spread(fragments: &[(f32, f32)]) -> Vec<Fragment> {
    let (near, far) =
        fragments.iter().fold((f32::MAX, f32::MIN), |(near, far), (z, _)| (near.min(*z), far.max(*z)));
    let scale = 1.0 / (far - near).max(1e-9);
    fragments.iter().map(|(z, depth)| Fragment::new((z - near) * scale, depth.max(0.0))).collect()
}

/// `count` depths of `groups` normal distributions with random means and widths, each with the same optical depth; they sum to `total`.
pub(super) fn gaussians(seed: u32, groups: usize, count: usize, total: f32) -> Vec<Fragment> {
    let mut random = SplitMix64::of_stream(seed, groups as u64);
    let kinds: Vec<(f32, f32)> =
        (0..groups).map(|_| (0.05 + 0.9 * random.unit(), 0.008 + 0.04 * random.unit())).collect();
    let drawn = (0..count).map(|at| {
        let (mean, deviation) = kinds[at % groups.max(1)];
        ((mean + deviation * random.bell()).clamp(0.0, 1.0), total / count as f32)
    });
    drawn.map(|(z, depth)| Fragment::new(z, depth)).collect()
}

/// Root mean square difference of two curves between two depths.
pub(super) fn rmse(test: &[f32], truth: &[f32], within: std::ops::Range<f32>) -> f64 {
    let chosen = (0..SAMPLES).filter(|at| within.contains(&depth(*at)));
    let (test, truth): (Vec<f32>, Vec<f32>) = chosen.map(|at| (test[at], truth[at])).unzip();
    errors(&test, &truth).rmse
}

/// A curve for the page.
pub(super) fn named(name: &str, values: &[f32]) -> CurveReport {
    let points = values.iter().enumerate().map(|(at, value)| (depth(at), *value)).collect();
    CurveReport { name: name.to_owned(), points }
}

#[cfg(test)]
mod tests {
    use lovelock_shadow::methods::exact::SortedFragments;
    use lovelock_shadow::methods::opacity_maps::Slices;

    use super::*;

    #[test]
    fn the_exact_method_gives_the_steps() {
        let fragments = gaussians(3, 4, 60, 3.0);
        let settings = ShadowSettings::default();
        let (found, wanted) = (curve::<SortedFragments>(&settings, &fragments), steps(&fragments));
        // The exact method lets a fragment shade itself over a short ramp.
        assert!(rmse(&found, &wanted, 0.0..1.0) < 0.02, "{}", rmse(&found, &wanted, 0.0..1.0));
        assert!((found[SAMPLES - 1] - (-3.0_f32).exp()).abs() < 0.01);
        // Control: slices differ more.
        let mut slices = settings;
        slices.opacity_maps.slices = 8;
        assert!(rmse(&curve::<Slices>(&slices, &fragments), &wanted, 0.0..1.0) > 0.02);
    }

    #[test]
    fn fragments_are_spread_over_the_whole_range() {
        let fragments = spread(&[(-0.02, 0.1), (0.06, 0.2), (0.02, 0.3)]);
        let depths: Vec<f32> = fragments.iter().map(|fragment| fragment.depth()).collect();
        assert_eq!((depths[0], depths[1]), (0.0, 1.0));
        assert!((depths[2] - 0.5).abs() < 1e-6 && fragments[2].optical_depth() == 0.3);
        assert_eq!(spread(&[(3.0, 0.5)])[0].depth(), 0.0, "one alone");
    }
}
