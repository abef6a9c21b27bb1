//! `density-clustering`: a few bins of uniform density per texel, placed where its hair is (Mertens, Kautz, Bekaert,
//! Van Reeth 2004, "A Self-Shadow Algorithm for Dynamic Hair using Density Clustering").
//!
//! The fragments of a texel are divided into clusters along the light. Each becomes a bin of uniform density as wide as its
//! spread, and optical depth rises linearly through a bin.

mod cpu;
mod gpu;
mod seeds;
mod table;

pub use cpu::{Bin, Clustering, DensityClustering};

use std::ops::RangeInclusive;

use lovelock_base::settings::Settings;
use serde::{Deserialize, Serialize};

use super::method::{MapKind, MapSize, Method};
use super::texels::{self, TexelFilter, TexelFrame, TexelShadow};
use crate::RayMarkKind;

pub(super) static METHOD: Method = Method {
    id: "density-clustering",
    label: "Density clustering",
    description: "A few bins of uniform density per light texel, placed where its hair is (Mertens and others 2004).",
    source: Some(
        "Mertens, Kautz, Bekaert, Van Reeth 2004, A Self-Shadow Algorithm for Dynamic Hair using Density \
         Clustering",
    ),
    advice: "lower the map's resolution, the clusters or the number of strands",
    map: MapKind::Texels,
    size: |settings| {
        Some(MapSize {
            edge: settings.density_clustering.resolution,
            per_texel: Some(settings.density_clustering.clusters),
        })
    },
    words: texels::gpu::map_words::<Clustering>,
    marks: &[BIN],
    settings: |settings| Some(&settings.density_clustering),
    footprint: |input, settings, bounds| {
        TexelFrame::new(input, settings.density_clustering.clamped().resolution, bounds)
    },
    counts_points: |_| false,
    sums_strands: true,
    in_world: false,
    cpu: || Box::new(DensityClustering::default()),
    gpu: |_, gpu, projected| Ok(Box::new(TexelShadow::<Clustering>::new(gpu, projected)?)),
    shaders: TexelShadow::<Clustering>::shaders,
};

/// A cluster as a bin of uniform density.
pub(crate) const BIN: RayMarkKind = RayMarkKind { label: "Bin", resolves_depth: false };

/// The initial centres of clusters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClusterSeeds {
    /// Evenly spaced between the nearest and the farthest hair of the texel.
    Uniform,
    /// The same, moved to three quarters of the distance from the nearest hair, where light falls off fastest, as in the last
    /// figure of the paper.
    #[default]
    TowardLight,
    /// Half way between the evenly spaced ones and those that divide the light lost in the texel equally, from a histogram of 32
    /// bins.
    Histogram,
}

/// How the spread of a cluster is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClusterDeviation {
    /// Relative to the final centres, in a pass of its own, as in the paper.
    #[default]
    Exact,
    /// In the pass that computes the centres; differs by hair that changes its cluster.
    Merged,
}

/// The profile of pre-filtered lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LineFilter {
    /// Each step of a strand is shared between the two nearest texels.
    #[default]
    TwoTexels,
    /// A Gaussian, integrated over each texel, as in section 3.4 of the paper.
    Gaussian,
}

/// Settings of density clustering.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct DensityClusteringSettings {
    /// The most texels along each edge; see [`TEXEL_RESOLUTIONS`](crate::TEXEL_RESOLUTIONS).
    pub resolution: u32,
    /// How a point reads the texels around it.
    pub filter: TexelFilter,
    /// Clusters per texel (the paper's *K*); see [`DensityClusteringSettings::CLUSTERS`].
    pub clusters: u32,
    /// The initial centres of clusters.
    pub seeds: ClusterSeeds,
    /// How many times each cluster is moved to the mean of its hair.
    pub steps: u32,
    /// How the spread of a cluster is computed.
    pub deviation: ClusterDeviation,
    /// Whether each step of a strand is shared between texels (the paper's pre-filtered lines) instead of being added to one.
    pub prefiltered: bool,
    /// The profile of pre-filtered lines.
    pub line_filter: LineFilter,
    /// The standard deviation of [`LineFilter::Gaussian`], in widths of a strand. It is at most two texels.
    pub line_width: f32,
}

impl DensityClusteringSettings {
    /// Clusters that a texel can have.
    pub const CLUSTERS: RangeInclusive<u32> = 1..=8;
}

impl Default for DensityClusteringSettings {
    fn default() -> Self {
        Self {
            resolution: texels::DEFAULT_RESOLUTION,
            filter: TexelFilter::default(),
            clusters: 4,
            seeds: ClusterSeeds::default(),
            steps: 1,
            deviation: ClusterDeviation::default(),
            prefiltered: true,
            line_filter: LineFilter::default(),
            line_width: 0.5,
        }
    }
}
