//! Occupancy maps on the GPU: range; bits and counts in one pass; then range and mean are put into the record.
//!
//! A record of 128 slices and 8 slabs has 44 bytes, 4 more than published: 11 MiB at 512². They hold the mean weight of a fragment, so
//! that the total of a texel is exact.

use lovelock_gpu::{Constant, ShaderPart};

use super::Occupancy;
use crate::gpu::wgsl;
use crate::methods::texels::TexelMethod;
use crate::methods::texels::gpu::{GpuTexelMethod, Needs, Over, Pass, RANGE, RANGE_READ, RANGE_WORDS};

const RECORD: ShaderPart = wgsl!("methods/occupancy_maps/gpu/", "record.wgsl");
const BITS: ShaderPart = wgsl!("methods/occupancy_maps/gpu/", "bits.wgsl");
const SEAL: ShaderPart = wgsl!("methods/occupancy_maps/gpu/", "seal.wgsl");
const QUERY: ShaderPart = wgsl!("methods/occupancy_maps/gpu/", "query.wgsl");

impl GpuTexelMethod for Occupancy {
    const PASSES: &'static [Pass] = &[
        Pass { name: "shadow/range", over: Over::Segments, parts: &[RANGE] },
        Pass { name: "shadow/occupancy", over: Over::Segments, parts: &[RANGE_READ, RECORD, BITS] },
        Pass { name: "shadow/seal", over: Over::Texels, parts: &[RANGE_READ, RECORD, SEAL] },
    ];
    const QUERY: &'static [ShaderPart] = &[RECORD, QUERY];

    fn needs(&self) -> Needs {
        Needs { map_words: self.cells() as u64, scratch_words: RANGE_WORDS, ..Needs::default() }
    }

    fn constants(&self) -> Vec<Constant> {
        let constants = [("SLICES", self.slices), ("SLABS", self.slabs), ("SLAB_SHIFT", self.slab_shift())];
        constants.map(|(name, value)| (name, f64::from(value))).to_vec()
    }
}
