//! Adaptive slices on the GPU: the range of each column, the shares of its bins, then density and sums.

use lovelock_gpu::ShaderPart;

use super::columns::{BINS, Columns};
use crate::gpu::wgsl;
use crate::methods::texels::TexelMethod;
use crate::methods::texels::gpu::{GpuTexelMethod, Needs, Over, Pass, RANGE, RANGE_READ, RANGE_WORDS};

const COLUMNS: ShaderPart = wgsl!("methods/voxel_map/adaptive/gpu/", "columns.wgsl");
const BINS_OF: ShaderPart = wgsl!("methods/voxel_map/adaptive/gpu/", "bins.wgsl");
const SHARES: ShaderPart = wgsl!("methods/voxel_map/adaptive/gpu/", "shares.wgsl");
const PLACES: ShaderPart = wgsl!("methods/voxel_map/adaptive/gpu/", "places.wgsl");
const DENSITY: ShaderPart = wgsl!("methods/voxel_map/adaptive/gpu/", "density.wgsl");
const SUMS: ShaderPart = wgsl!("methods/voxel_map/adaptive/gpu/", "sums.wgsl");
const QUERY: ShaderPart = wgsl!("methods/voxel_map/adaptive/gpu/", "query.wgsl");

impl GpuTexelMethod for Columns {
    const PASSES: &'static [Pass] = &[
        Pass { name: "shadow/range", over: Over::FilteredSegments, parts: &[RANGE] },
        Pass {
            name: "shadow/shares",
            over: Over::FilteredSegments,
            parts: &[RANGE_READ, COLUMNS, BINS_OF, SHARES],
        },
        Pass { name: "shadow/places", over: Over::Texels, parts: &[RANGE_READ, COLUMNS, BINS_OF, PLACES] },
        Pass { name: "shadow/density", over: Over::FilteredSegments, parts: &[COLUMNS, DENSITY] },
        Pass { name: "shadow/sums", over: Over::Texels, parts: &[COLUMNS, SUMS] },
    ];
    const QUERY: &'static [ShaderPart] = &[COLUMNS, QUERY];

    fn needs(&self) -> Needs {
        Needs {
            map_words: self.cells() as u64,
            scratch_words: RANGE_WORDS + BINS as u64,
            parts: self.slices() as u32,
            ..Needs::default()
        }
    }
}
