//! Optical depth at the ends of layers that start at the first fragment.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use lovelock_base::settings::Settings;

use super::super::texels::{Fragment, TexelFilter, TexelMap, TexelMethod};
use super::{DeepOpacityMapsSettings, LAYER, LayerGrowth};
use crate::{RayMarkKind, ShadowMethod, ShadowSettings};

/// The map of [`ShadowMethod::DeepOpacityMaps`].
pub type DeepOpacityMaps = TexelMap<Layers>;

const MAX_LAYERS: usize = *DeepOpacityMapsSettings::LAYERS.end() as usize;

/// A record is the depth of the first fragment, then the optical depth before the end of each layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layers {
    settings: DeepOpacityMapsSettings,
    pub(super) count: usize,
    /// The start of each layer, relative to the first fragment.
    pub(super) starts: [f32; MAX_LAYERS],
    /// 1 over the thickness of each layer.
    pub(super) per_depth: [f32; MAX_LAYERS],
}

impl Layers {
    /// The layer at `depth` (not negative) behind the first fragment. The last layer is unbounded.
    #[inline(always)]
    fn layer(&self, depth: f32) -> usize {
        self.starts[1..self.count].iter().filter(|start| **start <= depth).count()
    }
}

impl TexelMethod for Layers {
    type Cell = f32;

    const METHOD: ShadowMethod = ShadowMethod::DeepOpacityMaps;

    fn new(settings: &ShadowSettings) -> Self {
        let settings = settings.deep_opacity_maps.clamped();
        let count = settings.layers as usize;
        let weight = |layer: usize| match settings.growth {
            LayerGrowth::Even => 1.0,
            LayerGrowth::Linear => (layer + 1) as f32,
        };
        let thinnest = settings.depth_share / (0..count).map(weight).sum::<f32>();
        let (mut starts, mut per_depth) = ([0.0; MAX_LAYERS], [0.0; MAX_LAYERS]);
        let mut start = 0.0;
        for layer in 0..count {
            let thickness = thinnest * weight(layer);
            (starts[layer], per_depth[layer]) = (start, 1.0 / thickness);
            start += thickness;
        }
        Self { settings, count, starts, per_depth }
    }

    fn resolution(&self) -> u32 {
        self.settings.resolution
    }

    fn filter(&self) -> TexelFilter {
        self.settings.filter
    }

    fn cells(&self) -> usize {
        1 + self.count
    }

    fn fill(&self, fragments: &mut [Fragment], record: &mut [f32]) {
        let near = fragments.iter().map(|fragment| fragment.depth()).fold(1.0, f32::min);
        let (first, sums) = record.split_at_mut(1);
        first[0] = near;
        sums.fill(0.0);
        for fragment in fragments {
            sums[self.layer(fragment.depth() - near)] += fragment.optical_depth();
        }
        let mut sum = 0.0;
        for cell in sums {
            sum += *cell;
            *cell = sum;
        }
    }

    #[inline(always)]
    fn depth_before(&self, _fragments: &[Fragment], record: &[f32], depth: f32) -> f32 {
        let behind = depth - record[0];
        if behind <= 0.0 {
            return 0.0;
        }
        let layer = self.layer(behind);
        let part = ((behind - self.starts[layer]) * self.per_depth[layer]).min(1.0);
        let sums = &record[1..];
        let before = layer.checked_sub(1).map_or(0.0, |last| sums[last]);
        before + (sums[layer] - before) * part
    }

    fn pieces(
        &self,
        _fragments: &[Fragment],
        record: &[f32],
        put: &mut dyn FnMut(RayMarkKind, [f32; 2], f32),
    ) {
        let Some((near, sums)) = record.split_first() else { return };
        let mut before = 0.0;
        for ((sum, start), per_depth) in sums.iter().zip(&self.starts).zip(&self.per_depth) {
            put(LAYER, [near + start, near + (start + 1.0 / per_depth)], sum - before);
            before = *sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn method(layers: u32, growth: LayerGrowth) -> Layers {
        let mut settings = ShadowSettings::default();
        settings.deep_opacity_maps = DeepOpacityMapsSettings { layers, growth, ..settings.deep_opacity_maps };
        Layers::new(&settings)
    }

    #[test]
    fn layers_grow_and_together_cover_their_share() {
        let linear = method(4, LayerGrowth::Linear);
        for (start, expected) in linear.starts.iter().zip([0.0, 0.05, 0.15, 0.3]) {
            assert!((start - expected).abs() < 1e-6, "{:?}", linear.starts);
        }
        assert!((1.0 / linear.per_depth[3] - 0.2).abs() < 1e-6);
        let even = method(5, LayerGrowth::Even);
        for (start, expected) in even.starts.iter().zip([0.0, 0.1, 0.2, 0.3, 0.4]) {
            assert!((start - expected).abs() < 1e-6, "{:?}", even.starts);
        }
    }

    #[test]
    fn optical_depth_rises_through_layers_and_stays_behind_them() {
        // Layers of 0.05, 0.1, 0.15 and 0.2, starting at the first fragment.
        let method = method(4, LayerGrowth::Linear);
        let mut record = [0.0; 5];
        let mut fragments =
            [(0.95, 2.0), (0.25, 0.5), (0.28, 0.5), (0.35, 1.0)].map(|(z, b)| Fragment::new(z, b));
        method.fill(&mut fragments, &mut record);
        assert_eq!(record, [0.25, 1.0, 2.0, 2.0, 4.0]);
        let cases = [
            (0.1, 0.0),
            (0.25, 0.0),
            (0.275, 0.5),
            (0.35, 1.5),
            (0.5, 2.0),
            (0.65, 3.0),
            (0.75, 4.0),
            (2.0, 4.0),
        ];
        for (depth, before) in cases {
            let found = method.depth_before(&[], &record, depth);
            assert!((found - before).abs() < 1e-5, "at {depth}: {found}");
        }
    }

    #[test]
    fn one_fragment_shadows_what_lies_behind_it() {
        for layers in [0, 3, 16, u32::MAX] {
            let method = method(layers, LayerGrowth::Linear);
            let mut record = vec![0.0; method.cells()];
            method.fill(&mut [Fragment::new(1.0, 0.5)], &mut record);
            assert_eq!(method.depth_before(&[], &record, 1.0), 0.0);
            assert_eq!(method.depth_before(&[], &record, 2.0), 0.5);
        }
    }
}
