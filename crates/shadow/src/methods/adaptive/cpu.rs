//! Curves that lose their least important node.

use lovelock_base::settings::Settings;

use super::super::texels::{Curve, CurveMethod, Nodes, TexelFilter, TexelMap};
use super::AdaptiveSettings;
use crate::{ShadowMethod, ShadowSettings};

/// The map of [`ShadowMethod::Adaptive`].
pub type Adaptive = TexelMap<AdaptiveCurve>;

/// A record is a curve of transmittance over depth.
pub type AdaptiveCurve = Curve<AdaptiveNodes>;

/// Curves that lose the node that changes the area below them least.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AdaptiveNodes(AdaptiveSettings);

/// Twice the area between the curve and that without node `at`.
fn loss(nodes: &Nodes, at: usize) -> f32 {
    let (d, t) = (&nodes.depths, &nodes.lights);
    let before = (d[at] - d[at - 1]) * (t[at + 1] - t[at - 1]);
    let all = (d[at + 1] - d[at - 1]) * (t[at] - t[at - 1]);
    (all - before).abs()
}

/// Adds a node behind the others. If there are then more than `most`, the one whose loss is least is removed; of several, the first.
fn add(nodes: &mut Nodes, most: usize, depth: f32, light: f32) {
    (nodes.depths[nodes.count], nodes.lights[nodes.count]) = (depth, light);
    nodes.count += 1;
    if nodes.count <= most {
        return;
    }
    let (mut least, mut of) = (f32::INFINITY, 1);
    for at in 1..nodes.count - 1 {
        let loss = loss(nodes, at);
        if loss < least {
            (least, of) = (loss, at);
        }
    }
    nodes.depths.copy_within(of + 1..nodes.count, of);
    nodes.lights.copy_within(of + 1..nodes.count, of);
    nodes.count -= 1;
}

impl CurveMethod for AdaptiveNodes {
    const METHOD: ShadowMethod = ShadowMethod::Adaptive;

    fn new(settings: &ShadowSettings) -> Self {
        Self(settings.adaptive.clamped())
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
        let mut nodes = Nodes::NONE;
        let mut before = 1.0;
        for (depth, light) in steps {
            add(&mut nodes, self.nodes(), depth, before);
            add(&mut nodes, self.nodes(), depth, light);
            before = light;
        }
        nodes
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::texels::{Fragment, TexelMethod};
    use super::*;

    fn filled(nodes: u32, fragments: &[(f32, f32)]) -> (AdaptiveCurve, Vec<f32>) {
        let mut settings = ShadowSettings::default();
        settings.adaptive.nodes = nodes;
        // One unit of weight is 10⁻⁶ of optical depth.
        let method =
            AdaptiveCurve { depth_per_weight: 1e-6, ..<AdaptiveCurve as TexelMethod>::new(&settings) };
        let mut record = vec![f32::NAN; method.cells()];
        let mut fragments: Vec<_> = fragments.iter().map(|(z, b)| Fragment::new(*z, *b)).collect();
        method.fill(&mut fragments, &mut record);
        (method, record)
    }

    fn light((method, record): &(AdaptiveCurve, Vec<f32>), depth: f32) -> f32 {
        (-method.depth_before(&[], record, depth)).exp()
    }

    /// A slab as fragments.
    fn slab(start: f32, end: f32, depth: f32) -> impl Iterator<Item = (f32, f32)> {
        (0..400).map(move |i| (start + (end - start) * (i as f32 + 0.5) / 400.0, depth / 400.0))
    }

    #[test]
    fn cards_are_steps_while_there_are_nodes_for_them() {
        let made = filled(8, &[(0.7, 1.0), (0.2, 0.5), (0.4, 0.25)]);
        for (depth, before) in [(0.2, 0.0), (0.201, 0.5), (0.4, 0.5), (0.401, 0.75), (0.7, 0.75), (0.9, 1.75)]
        {
            let expected = (-before as f32).exp();
            assert!((light(&made, depth) - expected).abs() < 1e-4, "at {depth}: {}", light(&made, depth));
        }
    }

    #[test]
    fn the_node_that_changes_the_area_least_goes() {
        // Light by hand: 1, e^-0.5 = 0.607, 0.605 (a hair of 0.003), e^-1 … of five steps the thinnest and nearest go.
        let made = filled(4, &[(0.1, 0.5), (0.12, 0.003), (0.8, 1.0)]);
        // First and last stay, and both large steps are kept but for the thin one.
        for (depth, expected) in [(0.05, 1.0), (0.5, 0.605), (0.9, 0.2225)] {
            assert!((light(&made, depth) - expected).abs() < 0.01, "at {depth}: {}", light(&made, depth));
        }
    }

    #[test]
    fn more_nodes_come_nearer_to_one_slab_and_to_two_with_a_gap() {
        for of in [&[(0.2, 0.7, 3.0)][..], &[(0.1, 0.3, 1.0), (0.6, 0.9, 2.0)]] {
            let fragments: Vec<_> =
                of.iter().flat_map(|&(start, end, depth)| slab(start, end, depth)).collect();
            let errors = [4, 8, 16, 32].map(|nodes| {
                let made = filled(nodes, &fragments);
                let error = |i: u16| {
                    let depth = f32::from(i) * 0.01;
                    let before: f32 =
                        of.iter().map(|(a, b, all)| all * ((depth - a) / (b - a)).clamp(0.0, 1.0)).sum();
                    (light(&made, depth) - (-before).exp()).abs()
                };
                (1..100).map(error).fold(0.0, f32::max)
            });
            assert!(errors.is_sorted_by(|more, less| more > less), "{errors:?}");
            assert!(errors[3] < 0.01, "{errors:?}");
        }
    }
}
