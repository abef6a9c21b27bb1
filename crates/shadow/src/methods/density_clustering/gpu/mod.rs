//! Density clustering on the GPU: the paper's passes.
//!
//! Range; centres, as often as `steps` says; spread, where it has a pass of its own; the weight of each bin. Sums are whole
//! numbers of 64 bits, in two words with a carry, and so the same in any order. 2.9 million fragments of one texel fit in.

use lovelock_gpu::ShaderPart;

use super::{ClusterDeviation, ClusterSeeds, Clustering};
use crate::gpu::wgsl;
use crate::methods::texels::TexelMethod;
use crate::methods::texels::gpu::{GpuTexelMethod, Needs, Over, Pass};

const CLUSTER: ShaderPart = wgsl!("methods/density_clustering/gpu/", "cluster.wgsl");
const RANGE: ShaderPart = wgsl!("methods/density_clustering/gpu/", "range.wgsl");
const HISTOGRAM: ShaderPart = wgsl!("methods/density_clustering/gpu/", "histogram.wgsl");
const SEEDS: ShaderPart = wgsl!("methods/density_clustering/gpu/", "seeds.wgsl");
const MEANS: ShaderPart = wgsl!("methods/density_clustering/gpu/", "means.wgsl");
const MEANS_AND_SQUARES: ShaderPart = wgsl!("methods/density_clustering/gpu/", "means_and_squares.wgsl");
const MOVE: ShaderPart = wgsl!("methods/density_clustering/gpu/", "move.wgsl");
const SPREAD: ShaderPart = wgsl!("methods/density_clustering/gpu/", "spread.wgsl");
const BINS: ShaderPart = wgsl!("methods/density_clustering/gpu/", "bins.wgsl");
const FILL: ShaderPart = wgsl!("methods/density_clustering/gpu/", "fill.wgsl");
const QUERY: ShaderPart = wgsl!("methods/density_clustering/gpu/", "query.wgsl");

/// Words of scratch memory before those of the clusters.
const RANGE_WORDS: u64 = 2;
/// Words of the histogram that seeds can be read from, which clusters take over.
const HISTOGRAM_WORDS: u64 = 32;

const fn over_segments(name: &'static str, parts: &'static [ShaderPart]) -> Pass {
    Pass { name, over: Over::FilteredSegments, parts }
}

const fn over_texels(name: &'static str, parts: &'static [ShaderPart]) -> Pass {
    Pass { name, over: Over::Texels, parts }
}

impl GpuTexelMethod for Clustering {
    const PASSES: &'static [Pass] = &[
        over_segments("shadow/range", &[CLUSTER, RANGE]),
        over_segments("shadow/histogram", &[CLUSTER, HISTOGRAM]),
        over_texels("shadow/seeds", &[CLUSTER, SEEDS]),
        over_segments("shadow/clusters", &[CLUSTER, MEANS]),
        over_segments("shadow/clusters and spread", &[CLUSTER, MEANS_AND_SQUARES]),
        over_texels("shadow/centres", &[CLUSTER, MOVE]),
        over_segments("shadow/spread", &[CLUSTER, SPREAD]),
        over_texels("shadow/bins", &[CLUSTER, BINS]),
        over_segments("shadow/fill", &[CLUSTER, FILL]),
    ];
    const QUERY: &'static [ShaderPart] = &[QUERY];

    fn needs(&self) -> Needs {
        let clusters = self.cells() as u64;
        let seeds = match self.settings.seeds {
            ClusterSeeds::Uniform => 0,
            ClusterSeeds::TowardLight => 1,
            ClusterSeeds::Histogram => 2,
        };
        let histogram = if seeds == 2 { HISTOGRAM_WORDS } else { 0 };
        let merged = self.settings.deviation == ClusterDeviation::Merged;
        Needs {
            map_words: 3 * clusters,
            scratch_words: RANGE_WORDS + histogram.max(3 * clusters),
            parts: clusters as u32,
            seeds,
            merged: u32::from(merged),
            ..Needs::default()
        }
    }

    fn schedule(&self) -> Vec<usize> {
        let mut passes = vec![0];
        if self.settings.seeds == ClusterSeeds::Histogram {
            passes.push(1);
        }
        passes.push(2);
        for _ in 1..self.settings.steps {
            passes.extend([3, 5]);
        }
        match self.settings.deviation {
            ClusterDeviation::Exact => passes.extend([3, 5, 6]),
            ClusterDeviation::Merged => passes.push(4),
        }
        passes.extend([7, 8]);
        passes
    }
}
