//! Opacity maps on the GPU: one pass over the segments fills all slices, and one over the texels sums them in place.
//!
//! Weights are whole numbers and sums of them exact: 2.9 million fragments of one texel fit into a word.

use lovelock_gpu::ShaderPart;

use super::Slices;
use crate::gpu::wgsl;
use crate::methods::texels::TexelMethod;
use crate::methods::texels::gpu::{GpuTexelMethod, Needs, Over, Pass};

const SLICE: ShaderPart = wgsl!("methods/opacity_maps/gpu/", "slice.wgsl");
const WEIGHTS: ShaderPart = wgsl!("methods/opacity_maps/gpu/", "weights.wgsl");
const SUMS: ShaderPart = wgsl!("methods/opacity_maps/gpu/", "sums.wgsl");
const QUERY: ShaderPart = wgsl!("methods/opacity_maps/gpu/", "query.wgsl");

impl GpuTexelMethod for Slices {
    const PASSES: &'static [Pass] = &[
        Pass { name: "shadow/slices", over: Over::Segments, parts: &[SLICE, WEIGHTS] },
        Pass { name: "shadow/sums", over: Over::Texels, parts: &[SUMS] },
    ];
    const QUERY: &'static [ShaderPart] = &[SLICE, QUERY];

    fn needs(&self) -> Needs {
        let slices = self.cells();
        Needs { map_words: slices as u64, scratch_words: 1, parts: slices as u32, ..Needs::default() }
    }
}
