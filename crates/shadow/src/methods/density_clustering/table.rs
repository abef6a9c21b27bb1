//! The table of settings.

use lovelock_base::field;
use lovelock_base::settings::{Choices, Setting, Settings, Unit};

use super::super::texels;
use super::{ClusterDeviation, ClusterSeeds, DensityClusteringSettings, LineFilter};

impl Settings for DensityClusteringSettings {
    const TABLE: &'static [Setting<Self>] = &[
        texels::resolution(field!(Self, resolution)),
        texels::filter(field!(Self, filter)),
        Setting::count(
            field!(Self, clusters),
            [*Self::CLUSTERS.start() as u64, *Self::CLUSTERS.end() as u64],
            "Clusters",
            "Number of clusters of hair per texel, each of even density. More clusters follow the \
             hair more closely and take longer.",
        )
        .symbol("K")
        .offered(&[1, 2, 3, 4, 5, 6, 7, 8]),
        Setting::choice::<ClusterSeeds>(
            field!(Self, seeds),
            "Initial clusters",
            "Where clusters start: evenly spaced, drawn toward the light, or where most light is \
             lost.",
        ),
        Setting::count(
            field!(Self, steps),
            [1, 8],
            "Steps",
            "How many times each cluster is moved to the mean of its hair.",
        )
        .offered(&[1, 2, 3, 4, 6, 8]),
        Setting::choice::<ClusterDeviation>(
            field!(Self, deviation),
            "Cluster spread",
            "How the spread of a cluster is computed: in a pass of its own, or together with its \
             centre, which is faster.",
        ),
        Setting::switch(
            field!(Self, prefiltered),
            "Pre-filtered lines",
            "Shares each strand between rows of texels, which halves the swimming of shadows. Off, it is \
             drawn into one row.",
        ),
        Setting::choice::<LineFilter>(
            field!(Self, line_filter),
            "Line filter",
            "How rows of texels share a pre-filtered strand: the two nearest ones by their distance, or all that a \
             Gaussian of the chosen width reaches, as published.",
        ),
        Setting::number(
            field!(Self, line_width),
            [0.0, 2.0],
            "Line width",
            "Standard deviation of the Gaussian, in widths of a strand. Wider lines make smoother shadows and take \
             longer.",
        )
        .unit(Unit::TIMES),
    ];
}

impl Choices for ClusterSeeds {
    const ALL: &'static [Self] = &[Self::Uniform, Self::TowardLight, Self::Histogram];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Uniform => ("uniform", "Even"),
            Self::TowardLight => ("toward-light", "Toward the light"),
            Self::Histogram => ("histogram", "By a histogram"),
        }
    }
}

impl Choices for LineFilter {
    const ALL: &'static [Self] = &[Self::TwoTexels, Self::Gaussian];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::TwoTexels => ("two-texels", "Two texels"),
            Self::Gaussian => ("gaussian", "Gaussian"),
        }
    }
}

impl Choices for ClusterDeviation {
    const ALL: &'static [Self] = &[Self::Exact, Self::Merged];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Exact => ("exact", "Own pass"),
            Self::Merged => ("merged", "Merged"),
        }
    }
}
