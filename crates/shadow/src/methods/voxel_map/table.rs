//! The table of settings.

use lovelock_base::field;
use lovelock_base::settings::{Choices, Setting, Settings, Unit};

use super::{MapExtent, VoxelDeposit, VoxelFilter, VoxelMapSettings, VoxelSlices};

impl Settings for VoxelMapSettings {
    const TABLE: &'static [Setting<Self>] = &[
        Setting::count(
            field!(Self, resolution),
            [16, 512],
            "Map resolution",
            "Number of cells along each edge of the map. More cells show finer shadows and take longer; the brightness does \
             not change.",
        )
        .symbol("N")
        .unit(Unit::CELLS)
        .step(8)
        .stops(&[16, 32, 48, 64, 96, 128, 192, 256, 384, 512]),
        Setting::choice::<VoxelSlices>(
            field!(Self, slices),
            "Slices",
            "Where cells end along the light: at even distances, or where each column has its hair. Then twice as many \
             columns fit along each edge in the same memory; extent, filter and density are the default ones.",
        ),
        Setting::choice::<MapExtent>(
            field!(Self, extent),
            "Map extent",
            "How large the map is: the size of the hair, or the paper's bound for any pose.",
        ),
        Setting::number(
            field!(Self, head_size),
            [0.05, 1.0],
            "Head size",
            "Size of the head in the paper's bound for any pose.",
        )
        .symbol("h_max")
        .unit(Unit::METRES_AS_CM),
        Setting::choice::<VoxelFilter>(
            field!(Self, filter),
            "Filter",
            "How a point reads the cells: the closest one, whose pattern shows; linearly between those around it; or the same as \
             printed, which displaces shadows by half a cell.",
        ),
        Setting::choice::<VoxelDeposit>(
            field!(Self, deposit),
            "Density",
            "What strands add to the cells: the optical depth of their length across the light, so that a strand seen end-on \
             covers less; of their length in any direction; or one per point as published, and then the brightness depends on \
             the resolution.",
        ),
        Setting::number(
            field!(Self, point_extinction),
            [0.0, 1e4],
            "Point extinction",
            "Extinction that one point adds to a cell where points are counted. Higher values cast \
             darker shadows.",
        )
        .symbol("f")
        .unit(Unit::PER_METRE)
        .soft([0.1, 1000.0])
        .logarithmic(),
    ];
}

impl Choices for VoxelSlices {
    const ALL: &'static [Self] = &[Self::Uniform, Self::Adaptive];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Uniform => ("uniform", "Uniform"),
            Self::Adaptive => ("adaptive", "Adaptive"),
        }
    }
}

impl Choices for MapExtent {
    const ALL: &'static [Self] = &[Self::Fit, Self::Paper];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Fit => ("fit", "Size of the hair"),
            Self::Paper => ("paper", "Bound of the paper"),
        }
    }
}

impl Choices for VoxelFilter {
    // A track stores the place in this list.
    const ALL: &'static [Self] = &[Self::Centred, Self::Paper, Self::Closest];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Centred => ("centred", "Linear"),
            Self::Paper => ("paper", "Linear, as printed"),
            Self::Closest => ("closest", "Closest"),
        }
    }
}

impl Choices for VoxelDeposit {
    const ALL: &'static [Self] = &[Self::Length, Self::Isotropic, Self::PointCount];

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Length => ("length", "By length"),
            Self::Isotropic => ("isotropic", "Isotropic"),
            Self::PointCount => ("point-count", "By points, as printed"),
        }
    }
}
