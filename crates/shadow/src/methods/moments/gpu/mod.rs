//! Moments on the GPU: range and weight of each texel; sums of the functions of means.wgsl in one pass, as integers; then the record.
//!
//! A fragment adds its share of the weight of all hair, in steps of 2⁻²⁹, so that sums are exact in any order and never overflow.

use lovelock_gpu::{Constant, ShaderPart};

use super::DepthMoments;
use crate::gpu::wgsl;
use crate::methods::texels::TexelMethod;
use crate::methods::texels::gpu::{
    FALLBACKS, GpuTexelMethod, Needs, Over, Pass, RANGE, RANGE_WORDS, TURN, WHOLE, WHOLE_BUILD,
};

const MOMENTS: ShaderPart = wgsl!("methods/moments/gpu/", "moments.wgsl");
const SUMS: ShaderPart = wgsl!("methods/moments/gpu/", "sums.wgsl");
const ADD: ShaderPart = wgsl!("methods/moments/gpu/", "add.wgsl");
const MEANS: ShaderPart = wgsl!("methods/moments/gpu/", "means.wgsl");
const ROOTS: ShaderPart = wgsl!("methods/moments/gpu/", "roots.wgsl");
const SEAL: ShaderPart = wgsl!("methods/moments/gpu/", "seal.wgsl");
const SOLVE: ShaderPart = wgsl!("methods/moments/gpu/", "solve.wgsl");
const QUERY: ShaderPart = wgsl!("methods/moments/gpu/", "query.wgsl");

impl GpuTexelMethod for DepthMoments {
    const PASSES: &'static [Pass] = &[
        Pass { name: "shadow/range", over: Over::Segments, parts: &[RANGE] },
        Pass {
            name: "shadow/moments",
            over: Over::Segments,
            parts: &[WHOLE, WHOLE_BUILD[0], WHOLE_BUILD[1], TURN, MOMENTS, MEANS, SUMS, ADD],
        },
        Pass {
            name: "shadow/seal",
            over: Over::Texels,
            parts: &[
                WHOLE,
                WHOLE_BUILD[0],
                WHOLE_BUILD[1],
                TURN,
                MOMENTS,
                MEANS,
                SUMS,
                ROOTS,
                SOLVE,
                FALLBACKS,
                SEAL,
            ],
        },
    ];
    const QUERY: &'static [ShaderPart] = &[WHOLE, TURN, MOMENTS, MEANS, ROOTS, SOLVE, QUERY];
    const COUNTS_FALLBACKS: bool = true;

    fn needs(&self) -> Needs {
        Needs {
            map_words: self.cells() as u64,
            scratch_words: RANGE_WORDS + self.count() as u64,
            bias: self.bias,
            overestimation: self.overestimation(),
            ..Needs::default()
        }
    }

    fn constants(&self) -> Vec<Constant> {
        let mut constants = vec![("ORDER", (self.count() / 2) as f64)];
        let flags =
            [("TURNED", self.is_trigonometric()), ("SHORT", self.is_short()), ("OF_MAP", self.is_of_map())];
        constants.extend(flags.map(|(name, value)| (name, f64::from(u8::from(value)))));
        constants
    }
}
