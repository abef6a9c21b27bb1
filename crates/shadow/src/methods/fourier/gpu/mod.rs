//! Fourier opacity maps on the GPU: range and weight of each texel; coefficients in one pass, as integers; then they are turned into
//! numbers in place.
//!
//! A fragment adds its share of the weight of all hair, in steps of 2⁻²⁹, so that sums are exact in any order and never overflow.

use lovelock_gpu::{Constant, ShaderPart};

use super::Series;
use crate::gpu::wgsl;
use crate::methods::texels::TexelMethod;
use crate::methods::texels::gpu::{
    GpuTexelMethod, Needs, Over, Pass, RANGE, RANGE_WORDS, TURN, WHOLE, WHOLE_BUILD,
};

const SERIES: ShaderPart = wgsl!("methods/fourier/gpu/", "series.wgsl");
const ADD: ShaderPart = wgsl!("methods/fourier/gpu/", "add.wgsl");
const SEAL: ShaderPart = wgsl!("methods/fourier/gpu/", "seal.wgsl");
const QUERY: ShaderPart = wgsl!("methods/fourier/gpu/", "query.wgsl");

impl GpuTexelMethod for Series {
    const PASSES: &'static [Pass] = &[
        Pass { name: "shadow/range", over: Over::Segments, parts: &[RANGE] },
        Pass {
            name: "shadow/series",
            over: Over::Segments,
            parts: &[WHOLE, WHOLE_BUILD[0], WHOLE_BUILD[1], TURN, SERIES, ADD],
        },
        Pass {
            name: "shadow/seal",
            over: Over::Texels,
            parts: &[WHOLE, WHOLE_BUILD[0], WHOLE_BUILD[1], SERIES, SEAL],
        },
    ];
    const QUERY: &'static [ShaderPart] = &[WHOLE, TURN, SERIES, QUERY];

    fn needs(&self) -> Needs {
        let mut starts = [0.0; 16];
        starts[..self.factors.len()].copy_from_slice(&self.factors);
        Needs { map_words: self.cells() as u64, scratch_words: RANGE_WORDS, starts, ..Needs::default() }
    }

    fn constants(&self) -> Vec<Constant> {
        vec![("TERMS", self.terms as f64), ("OF_MAP", f64::from(u8::from(self.is_of_map())))]
    }
}
