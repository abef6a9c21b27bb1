//! Approximate deep shadow maps on the GPU: the nearest depth, in one word per texel.

use lovelock_gpu::ShaderPart;

use super::NearestHair;
use crate::gpu::wgsl;
use crate::methods::texels::gpu::{GpuTexelMethod, Needs, Over, Pass};

const NEAR: ShaderPart = wgsl!("methods/approximate_deep/gpu/", "near.wgsl");
const QUERY: ShaderPart = wgsl!("methods/approximate_deep/gpu/", "query.wgsl");

impl GpuTexelMethod for NearestHair {
    const PASSES: &'static [Pass] = &[Pass { name: "shadow/near", over: Over::Segments, parts: &[NEAR] }];
    const QUERY: &'static [ShaderPart] = &[QUERY];

    fn needs(&self) -> Needs {
        Needs { map_words: 1, slope: self.slope, most: self.most, ..Needs::default() }
    }
}
