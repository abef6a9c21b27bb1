//! Moments on the GPU: range and weight of each texel; sums of powers in one pass, as integers; then the record.
//!
//! A fragment adds its share of the weight of all hair, in steps of 2⁻²⁹, so that sums are exact in any order and never overflow.

use lovelock_gpu::{Constant, ShaderPart};

use super::PowerMoments;
use crate::gpu::wgsl;
use crate::methods::texels::TexelMethod;
use crate::methods::texels::gpu::{
    GpuTexelMethod, Needs, Over, Pass, RANGE, RANGE_WORDS, WHOLE, WHOLE_BUILD,
};

const MOMENTS: ShaderPart = wgsl!("methods/moments/gpu/", "moments.wgsl");
const SUMS: ShaderPart = wgsl!("methods/moments/gpu/", "sums.wgsl");
const ADD: ShaderPart = wgsl!("methods/moments/gpu/", "add.wgsl");
const PACK: ShaderPart = wgsl!("methods/moments/gpu/", "pack.wgsl");
const SEAL: ShaderPart = wgsl!("methods/moments/gpu/", "seal.wgsl");
const SOLVE: ShaderPart = wgsl!("methods/moments/gpu/", "solve.wgsl");
const QUERY: ShaderPart = wgsl!("methods/moments/gpu/", "query.wgsl");

/// Words of scratch memory for the integer sums of a texel.
const SUM_WORDS: u64 = 4;

impl GpuTexelMethod for PowerMoments {
    const PASSES: &'static [Pass] = &[
        Pass { name: "shadow/range", over: Over::Segments, parts: &[RANGE] },
        Pass {
            name: "shadow/moments",
            over: Over::Segments,
            parts: &[WHOLE, WHOLE_BUILD[0], WHOLE_BUILD[1], MOMENTS, SUMS, ADD],
        },
        Pass {
            name: "shadow/seal",
            over: Over::Texels,
            parts: &[WHOLE, WHOLE_BUILD[0], WHOLE_BUILD[1], MOMENTS, SUMS, PACK, SEAL],
        },
    ];
    const QUERY: &'static [ShaderPart] = &[WHOLE, MOMENTS, PACK, SOLVE, QUERY];

    fn needs(&self) -> Needs {
        Needs {
            map_words: self.cells() as u64,
            scratch_words: RANGE_WORDS + SUM_WORDS,
            bias: self.bias,
            overestimation: self.overestimation(),
            ..Needs::default()
        }
    }

    fn constants(&self) -> Vec<Constant> {
        let constants = [("SHORT", self.is_short()), ("OF_MAP", self.is_of_map())];
        constants.map(|(name, value)| (name, f64::from(u8::from(value)))).to_vec()
    }
}
