//! `density-clustering`: a few bins of even density a texel, placed where its hair is (Mertens, Kautz, Bekaert,
//! Van Reeth 2004, "A Self-Shadow Algorithm for Dynamic Hair using Density Clustering").
//!
//! The fragments of a texel are divided into clusters along the light. Each becomes a bin of even density as wide
//! as its spread, and optical depth rises evenly through a bin.

mod cpu;
mod gpu;
mod seeds;
mod table;

pub use cpu::{Bin, Clustering, DensityClustering};

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use super::texels::{self, TexelFilter, TexelShadow};
use crate::RayMarkKind;
use crate::method::{MapKind, MapSize, Method};

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
    marks: &[BIN],
    counts_points: |_| false,
    cpu: || Box::new(DensityClustering::default()),
    gpu: |gpu| Ok(Box::new(TexelShadow::<Clustering>::new(gpu)?)),
    shaders: TexelShadow::<Clustering>::shaders,
};

/// A cluster as a bin of even density.
pub(crate) const BIN: RayMarkKind = RayMarkKind { label: "Bin", resolves_depth: false };

/// Where clusters start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClusterSeeds {
    /// Evenly between the nearest and the farthest hair of the texel.
    Uniform,
    /// The same, drawn to three quarters of the distance from the nearest hair, as in the paper's last figure:
    /// light falls off fastest there.
    #[default]
    TowardLight,
    /// Half way between the even ones and those that divide the light lost in the texel evenly, read from a
    /// histogram of 32 bins.
    Histogram,
}

/// How the spread of a cluster is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ClusterDeviation {
    /// About the centres that were found, in a pass of its own, as the paper has it.
    #[default]
    Exact,
    /// In the pass that finds the centres: differs by the hair that changes its cluster.
    Merged,
}

/// What a user sets about density clustering.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct DensityClusteringSettings {
    /// Most texels along each edge; see [`TEXEL_RESOLUTIONS`](crate::TEXEL_RESOLUTIONS).
    pub resolution: u32,
    /// How a point reads the texels around it.
    pub filter: TexelFilter,
    /// Clusters a texel (the paper's *K*); see [`DensityClusteringSettings::CLUSTERS`].
    pub clusters: u32,
    /// Where clusters start.
    pub seeds: ClusterSeeds,
    /// How many times each cluster is moved to the mean of its hair.
    pub steps: u32,
    /// How the spread of a cluster is found.
    pub deviation: ClusterDeviation,
    /// Whether each step of a strand is shared between the two nearest texels (the paper's pre-filtered lines) and not put
    /// into one.
    pub prefiltered: bool,
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
        }
    }
}
