//! Every fragment on the GPU: a count a texel; places in a list; the fragments, put there and sorted, a thread a texel, or a
//! workgroup where there are many.
//!
//! Weights are whole numbers, so that their sums are exact in any order.

use lovelock_gpu::ShaderPart;

use super::SortedFragments;
use crate::gpu::wgsl;
use crate::methods::texels::gpu::list::{LIST_BODY, LIST_HEAD};
use crate::methods::texels::gpu::{GpuTexelMethod, Needs, Over, Pass};

const COUNT: ShaderPart = wgsl!("methods/exact/gpu/", "count.wgsl");
const PLACE: ShaderPart = wgsl!("methods/exact/gpu/", "place.wgsl");
const SCATTER: ShaderPart = wgsl!("methods/exact/gpu/", "scatter.wgsl");
const ORDER: ShaderPart = wgsl!("methods/exact/gpu/", "order.wgsl");
const SORT: ShaderPart = wgsl!("methods/exact/gpu/", "sort.wgsl");
const SORT_LONG: ShaderPart = wgsl!("methods/exact/gpu/", "sort_long.wgsl");
const QUERY: ShaderPart = wgsl!("methods/exact/gpu/", "query.wgsl");

/// The passes that list all fragments of each texel, sorted by depth, with running sums of their weights.
pub(crate) const SORTED_LIST: [Pass; 5] = [
    Pass { name: "shadow/count", over: Over::Segments, parts: &[COUNT] },
    Pass { name: "shadow/place", over: Over::Groups, parts: &[LIST_HEAD, PLACE] },
    Pass { name: "shadow/scatter", over: Over::Segments, parts: &[LIST_BODY, SCATTER] },
    Pass { name: "shadow/sort", over: Over::Texels, parts: &[LIST_BODY, ORDER, SORT] },
    Pass { name: "shadow/sort", over: Over::Groups, parts: &[LIST_BODY, ORDER, SORT_LONG] },
];

impl GpuTexelMethod for SortedFragments {
    const PASSES: &'static [Pass] = &SORTED_LIST;
    const QUERY: &'static [ShaderPart] = &[QUERY];
    const LISTS: bool = true;

    fn needs(&self) -> Needs {
        Needs { map_words: 2, ..Needs::default() }
    }
}
