//! Deep opacity maps on the GPU: the nearest depth; all layers in one pass; then they are summed in place.
//!
//! Weights are whole numbers and sums of them exact: 2.9 million fragments of one texel fit into a word.

use lovelock_gpu::ShaderPart;

use super::Layers;
use crate::gpu::wgsl;
use crate::methods::texels::TexelMethod;
use crate::methods::texels::gpu::{GpuTexelMethod, Needs, Over, Pass};

const LAYER: ShaderPart = wgsl!("methods/deep_opacity_maps/gpu/", "layer.wgsl");
const NEAR: ShaderPart = wgsl!("methods/deep_opacity_maps/gpu/", "near.wgsl");
const WEIGHTS: ShaderPart = wgsl!("methods/deep_opacity_maps/gpu/", "weights.wgsl");
const SUMS: ShaderPart = wgsl!("methods/deep_opacity_maps/gpu/", "sums.wgsl");
const QUERY: ShaderPart = wgsl!("methods/deep_opacity_maps/gpu/", "query.wgsl");

impl GpuTexelMethod for Layers {
    const PASSES: &'static [Pass] = &[
        Pass { name: "shadow/near", over: Over::Segments, parts: &[LAYER, NEAR] },
        Pass { name: "shadow/layers", over: Over::Segments, parts: &[LAYER, WEIGHTS] },
        Pass { name: "shadow/sums", over: Over::Texels, parts: &[LAYER, SUMS] },
    ];
    const QUERY: &'static [ShaderPart] = &[LAYER, QUERY];

    fn needs(&self) -> Needs {
        Needs {
            map_words: self.cells() as u64,
            parts: self.count as u32,
            starts: self.starts,
            per_depth: self.per_depth,
            ..Needs::default()
        }
    }
}
