//! Transmittance as a piecewise linear function of depth: the record of the methods that compress the curve of each texel.
//!
//! A record has cells for a number of nodes: their count, their depths, and their transmittances. Before the first node all light is
//! left, behind the last one that of the last. Two nodes at one depth are a step.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use std::fmt::Debug;

use super::{Fragment, MapScale, TexelFilter, TexelMethod, WEIGHT_ONE};
use crate::exp::exp_of_minus;
use crate::{RayMarkKind, ShadowMethod, ShadowSettings};

/// The most nodes of a curve.
pub(crate) const MAX_NODES: usize = 32;

/// The most steps from which a curve is made. Of more fragments, several that follow each other are one step.
pub(crate) const MAX_STEPS: usize = 512;

/// A piece of a curve between two nodes.
pub(crate) const PIECE: RayMarkKind = RayMarkKind { label: "Segment of the curve", resolves_depth: false };

/// Cells of a record with `nodes` nodes.
pub(crate) const fn cells(nodes: usize) -> usize {
    1 + 2 * nodes
}

/// The curve of a texel before it is compressed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Steps<'a> {
    fragments: &'a [Fragment],
    /// Fragments per step.
    stride: usize,
    depth_per_weight: f32,
}

impl<'a> Steps<'a> {
    /// Sorts the fragments of a texel. `depth_per_weight` is the optical depth of one unit of the weights in which the GPU sums
    /// fragments: the definition rounds to them too, because compression depends on the order of numbers that may be nearly alike.
    pub(crate) fn new(fragments: &'a mut [Fragment], depth_per_weight: f32) -> Self {
        fragments.sort_unstable();
        let stride = fragments.len().div_ceil(MAX_STEPS).max(1);
        Self { fragments, stride, depth_per_weight }
    }

    /// The depth of each step, and the transmittance behind it.
    pub(crate) fn iter(self) -> impl Iterator<Item = (f32, f32)> + Clone + 'a {
        let mut sum = 0_u32;
        let depth_per_texel = self.depth_per_weight * WEIGHT_ONE;
        self.fragments.chunks(self.stride).map(move |step| {
            for fragment in step {
                // The length of the fragment in texels; 0 for NaN.
                let weight = fragment.optical_depth() / depth_per_texel * WEIGHT_ONE + 0.5;
                sum = sum.saturating_add(weight as u32);
            }
            (step[0].depth(), exp_of_minus(sum as f32 * self.depth_per_weight))
        })
    }
}

/// A method whose record is a curve. The value holds its settings, clamped to their ranges.
pub trait CurveMethod: Copy + Debug + Send + Sync {
    /// The key of the method.
    const METHOD: ShadowMethod;

    /// The method with its section of `settings`.
    fn new(settings: &ShadowSettings) -> Self;

    /// The most texels along each edge.
    fn resolution(&self) -> u32;

    /// How a point reads the texels around it.
    fn filter(&self) -> TexelFilter;

    /// The most nodes of a record.
    fn nodes(&self) -> usize;

    /// Makes a curve of steps: the depth of each, in order, and the transmittance behind it.
    fn compress(&self, steps: impl Iterator<Item = (f32, f32)> + Clone) -> Nodes;
}

/// A record is a curve of transmittance over depth, as a [`CurveMethod`] makes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve<M> {
    pub(crate) method: M,
    pub(crate) depth_per_weight: f32,
}

impl<M: CurveMethod> TexelMethod for Curve<M> {
    type Cell = f32;

    const METHOD: ShadowMethod = M::METHOD;

    fn new(settings: &ShadowSettings) -> Self {
        Self { method: M::new(settings), depth_per_weight: 0.0 }
    }

    fn within(self, scale: &MapScale) -> Self {
        Self { depth_per_weight: scale.depth_per_weight(), ..self }
    }

    fn resolution(&self) -> u32 {
        self.method.resolution()
    }

    fn filter(&self) -> TexelFilter {
        self.method.filter()
    }

    fn cells(&self) -> usize {
        cells(self.method.nodes())
    }

    fn fill(&self, fragments: &mut [Fragment], record: &mut [f32]) {
        self.method.compress(Steps::new(fragments, self.depth_per_weight).iter()).write(record);
    }

    #[inline(always)]
    fn depth_before(&self, _fragments: &[Fragment], record: &[f32], depth: f32) -> f32 {
        depth_of_light(light_before(record, depth))
    }

    fn pieces(
        &self,
        _fragments: &[Fragment],
        record: &[f32],
        put: &mut dyn FnMut(RayMarkKind, [f32; 2], f32),
    ) {
        pieces(record, put);
    }
}

/// A record that is being made.
#[derive(Clone, Copy, Debug)]
pub struct Nodes {
    pub(crate) count: usize,
    pub(crate) depths: [f32; MAX_NODES + 1],
    pub(crate) lights: [f32; MAX_NODES + 1],
}

impl Nodes {
    pub(crate) const NONE: Self =
        Self { count: 0, depths: [0.0; MAX_NODES + 1], lights: [0.0; MAX_NODES + 1] };

    /// Writes the nodes into a record.
    pub(crate) fn write(&self, record: &mut [f32]) {
        let (first, rest) = record.split_at_mut(1);
        let (depths, lights) = rest.split_at_mut(rest.len() / 2);
        let count = self.count.min(depths.len());
        first[0] = count as f32;
        rest_of(depths, &self.depths, count);
        rest_of(lights, &self.lights, count);
    }
}

/// Copies `count` values; the rest is 0.
fn rest_of(into: &mut [f32], from: &[f32], count: usize) {
    into[..count].copy_from_slice(&from[..count]);
    into[count..].fill(0.0);
}

/// The depths and the transmittances of the nodes of a record.
#[inline(always)]
fn nodes(record: &[f32]) -> (&[f32], &[f32]) {
    let (depths, lights) = record[1..].split_at(record.len() / 2);
    let count = record[0] as usize;
    (&depths[..count], &lights[..count])
}

/// Transmittance before `depth`. A step at exactly this depth does not count.
#[inline(always)]
pub(crate) fn light_before(record: &[f32], depth: f32) -> f32 {
    let (depths, lights) = nodes(record);
    let next = depths.partition_point(|node| *node < depth);
    if next == 0 {
        return 1.0;
    }
    let (last_depth, last) = (depths[next - 1], lights[next - 1]);
    if next == depths.len() {
        return last;
    }
    last + (lights[next] - last) * ((depth - last_depth) / (depths[next] - last_depth))
}

/// Optical depth of a transmittance.
#[inline(always)]
pub(crate) fn depth_of_light(light: f32) -> f32 {
    // Below, light is 0 in any picture.
    if light > 1e-28 { -light.ln() } else { 64.0 }
}

/// Calls `put` for each piece of the curve.
pub(crate) fn pieces(record: &[f32], put: &mut dyn FnMut(RayMarkKind, [f32; 2], f32)) {
    let (depths, lights) = nodes(record);
    let mut before = 1.0;
    for (at, (depth, light)) in depths.iter().zip(lights).enumerate() {
        let start = at.checked_sub(1).map_or(*depth, |last| depths[last]);
        // The first node is where all light is left.
        if at > 0 {
            put(PIECE, [start, *depth], (depth_of_light(*light) - depth_of_light(before)).max(0.0));
        }
        before = *light;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_is_linear_between_nodes_and_falls_at_steps() {
        let mut made = Nodes::NONE;
        for (at, (depth, light)) in [(0.2, 1.0), (0.4, 0.5), (0.4, 0.3), (0.8, 0.1)].into_iter().enumerate() {
            (made.depths[at], made.lights[at], made.count) = (depth, light, at + 1);
        }
        let mut record = [f32::NAN; cells(6)];
        made.write(&mut record);
        for (depth, light) in
            [(0.0, 1.0), (0.2, 1.0), (0.3, 0.75), (0.4, 0.5), (0.6, 0.2), (0.8, 0.1), (2.0, 0.1)]
        {
            let found = light_before(&record, depth);
            assert!((found - light).abs() < 1e-6, "at {depth}: {found}");
        }
        assert!((light_before(&record, 0.400_001) - 0.3).abs() < 1e-5);
        let mut sum = 0.0;
        pieces(&record, &mut |_, _, depth| sum += depth);
        assert!((sum - 10.0_f32.ln()).abs() < 1e-5, "{sum}");
    }

    #[test]
    fn long_lists_are_thinned_and_keep_all_hair() {
        let per_weight = 1e-3 / WEIGHT_ONE;
        for count in [1, 512, 513, 100_000] {
            let mut fragments: Vec<_> =
                (0..count).map(|i| Fragment::new(i as f32 / count as f32, 1e-3)).collect();
            let steps = Steps::new(&mut fragments, per_weight);
            let all: Vec<_> = steps.iter().collect();
            assert!(all.len() <= MAX_STEPS && (all.len() == count || count > MAX_STEPS));
            let last = all[all.len() - 1].1;
            assert!((last - (-1e-3 * count as f32).exp()).abs() < 1e-4, "{count}: {last}");
        }
    }
}
