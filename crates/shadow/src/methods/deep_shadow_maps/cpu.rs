//! Compressed curves.

use lovelock_base::settings::Settings;

use super::super::texels::{Curve, CurveMethod, Nodes, TexelFilter, TexelMap};
use super::DeepShadowMapsSettings;
use super::compress::compressed;
use crate::{ShadowMethod, ShadowSettings};

/// The map of [`ShadowMethod::DeepShadowMaps`].
pub type DeepShadowMaps = TexelMap<DeepCurve>;

/// A record is a curve of transmittance over depth.
pub type DeepCurve = Curve<DeepNodes>;

/// Curves with as few nodes as their error allows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeepNodes(pub(super) DeepShadowMapsSettings);

impl CurveMethod for DeepNodes {
    const METHOD: ShadowMethod = ShadowMethod::DeepShadowMaps;

    fn new(settings: &ShadowSettings) -> Self {
        Self(settings.deep_shadow_maps.clamped())
    }

    fn resolution(&self) -> u32 {
        self.0.resolution
    }

    fn filter(&self) -> TexelFilter {
        self.0.filter
    }

    fn nodes(&self) -> usize {
        self.0.nodes as usize
    }

    fn compress(&self, steps: impl Iterator<Item = (f32, f32)> + Clone) -> Nodes {
        compressed(&steps, self.0.tolerance, self.nodes())
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::texels::{Fragment, TexelMethod};
    use super::*;

    fn filled(tolerance: f32, nodes: u32, fragments: &[(f32, f32)]) -> (DeepCurve, Vec<f32>) {
        let mut settings = ShadowSettings::default();
        (settings.deep_shadow_maps.tolerance, settings.deep_shadow_maps.nodes) = (tolerance, nodes);
        // One unit of weight is 10⁻⁶ of optical depth.
        let method = DeepCurve { depth_per_weight: 1e-6, ..<DeepCurve as TexelMethod>::new(&settings) };
        let mut record = vec![f32::NAN; method.cells()];
        let mut fragments: Vec<_> = fragments.iter().map(|(z, b)| Fragment::new(*z, *b)).collect();
        method.fill(&mut fragments, &mut record);
        (method, record)
    }

    fn light((method, record): &(DeepCurve, Vec<f32>), depth: f32) -> f32 {
        (-method.depth_before(&[], record, depth)).exp()
    }

    /// Two slabs with a gap, or one.
    fn slabs(of: &[(f32, f32, f32)]) -> Vec<(f32, f32)> {
        let fragment = |&(start, end, depth): &(f32, f32, f32)| {
            (0..300).map(move |i| (start + (end - start) * (i as f32 + 0.5) / 300.0, depth / 300.0))
        };
        of.iter().flat_map(fragment).collect()
    }

    /// The largest error at the near and the far side of every fragment.
    fn worst(made: &(DeepCurve, Vec<f32>), fragments: &[(f32, f32)]) -> f32 {
        let (mut sum, mut worst) = (0.0_f32, 0.0_f32);
        for (depth, optical) in fragments {
            worst = worst.max((light(made, *depth) - (-sum).exp()).abs());
            sum += optical;
            worst = worst.max((light(made, depth.next_up()) - (-sum).exp()).abs());
        }
        worst
    }

    #[test]
    fn no_step_errs_by_more_than_the_tolerance_and_fewer_nodes_do_for_more() {
        for of in [&[(0.2, 0.7, 3.0)][..], &[(0.1, 0.3, 1.0), (0.6, 0.9, 2.0)], &[(0.0, 1.0, 0.1)]] {
            let fragments = slabs(of);
            let mut last = usize::MAX;
            for tolerance in [0.01, 0.02, 0.05, 0.1] {
                let made = filled(tolerance, 32, &fragments);
                let error = worst(&made, &fragments);
                assert!(error <= tolerance * 1.001, "{of:?}: {error} with {tolerance}");
                let count = made.1[0] as usize;
                assert!(count <= last && count >= 2, "{count} nodes after {last}");
                last = count;
            }
            assert!(last <= 6, "{last}");
        }
    }

    #[test]
    fn cards_are_steps() {
        let cards = [(0.2, 0.5), (0.4, 0.25), (0.7, 4.0)];
        let made = filled(0.01, 16, &cards);
        assert!(worst(&made, &cards) < 1e-5);
        assert_eq!(made.1[0], 6.0, "two nodes for each: {:?}", made.1);
        assert!((light(&made, 0.3) - (-0.5_f32).exp()).abs() < 1e-5);
    }

    #[test]
    fn a_texel_that_needs_more_nodes_than_there_are_errs_more() {
        // Twenty cards of 4 % each.
        let cards: Vec<_> = (0..20).map(|i| (0.03 + 0.047 * i as f32, 0.04)).collect();
        let made = filled(1e-4, 8, &cards);
        let error = worst(&made, &cards);
        assert!(made.1[0] <= 8.0 && error > 1e-3 && error < 0.1, "{error}: {:?}", made.1);
        assert!(worst(&filled(1e-4, 32, &cards), &cards) < error, "control: 32 are more");
    }
}
