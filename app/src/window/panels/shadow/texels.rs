//! The controls of the methods that keep a record for each texel of a map across the light.

use egui::Ui;
use lovelock_render::{
    ClusterDeviation, ClusterSeeds, DeepOpacityMapsSettings, DensityClusteringSettings, ExactSettings,
    LayerGrowth, OccupancyMapsSettings, OpacityMapsSettings, TexelFilter,
};

use super::count;
use crate::window::control::{Number, choice};

/// What all of them have: the map's size and how it is read.
fn map(ui: &mut Ui, (resolution, filter): (&mut u32, &mut TexelFilter), default: (u32, TexelFilter)) {
    count(
        ui,
        "Map resolution",
        "Most texels along each edge of the map: more show finer shadows and cost more. Texels are no narrower than strands are wide.",
        resolution,
        default.0,
        &[64, 128, 256, 512, 1024, 2048],
        "²",
    );
    choice(
        ui,
        "Filter",
        "How a point reads the texels around it: the nearest alone, with hard steps, or the mean of four.",
        filter,
        default.1,
        &[
            (TexelFilter::Nearest, "Nearest"),
            (TexelFilter::Bilinear, "Bilinear"),
            (TexelFilter::Jitter, "Jitter"),
        ],
    );
}

pub(super) fn opacity_maps(ui: &mut Ui, v: &mut OpacityMapsSettings, d: &OpacityMapsSettings) {
    map(ui, (&mut v.resolution, &mut v.filter), (d.resolution, d.filter));
    count(
        ui,
        "Slices",
        "Slices of equal depth: few show bands in the shadow.",
        &mut v.slices,
        d.slices,
        &[8, 16, 32, 64, 128, 256],
        "",
    );
}

pub(super) fn deep_opacity_maps(ui: &mut Ui, v: &mut DeepOpacityMapsSettings, d: &DeepOpacityMapsSettings) {
    map(ui, (&mut v.resolution, &mut v.filter), (d.resolution, d.filter));
    count(
        ui,
        "Layers",
        "Layers that begin at the first hair of each texel; what lies behind the last belongs to it.",
        &mut v.layers,
        d.layers,
        &[3, 4, 5, 6, 8, 10, 12, 16],
        "",
    );
    choice(
        ui,
        "Growth",
        "How thick layers are: all alike, or thinner where light falls off fastest.",
        &mut v.growth,
        d.growth,
        &[(LayerGrowth::Even, "Even"), (LayerGrowth::Linear, "Thicker inward")],
    );
    Number::new("Depth", 0.05..=1.0, "Thickness of all layers together, as a share of the hair's depth.")
        .percent()
        .show(ui, &mut v.depth_share, d.depth_share);
}

pub(super) fn density_clustering(
    ui: &mut Ui,
    v: &mut DensityClusteringSettings,
    d: &DensityClusteringSettings,
) {
    map(ui, (&mut v.resolution, &mut v.filter), (d.resolution, d.filter));
    count(
        ui,
        "Clusters",
        "Clusters of hair a texel (K), each even within itself.",
        &mut v.clusters,
        d.clusters,
        &[1, 2, 3, 4, 5, 6, 7, 8],
        "",
    );
    choice(
        ui,
        "Start",
        "Where clusters start: evenly, drawn toward the light, or where the light is lost.",
        &mut v.seeds,
        d.seeds,
        &[
            (ClusterSeeds::Uniform, "Even"),
            (ClusterSeeds::TowardLight, "Toward the light"),
            (ClusterSeeds::Histogram, "By a histogram"),
        ],
    );
    count(
        ui,
        "Steps",
        "How often clusters are moved to the mean of their hair.",
        &mut v.steps,
        d.steps,
        &[1, 2, 3, 4, 6, 8],
        "",
    );
    choice(
        ui,
        "Spread",
        "How the spread of a cluster is found: in a pass of its own, or together with its centre, which is quicker.",
        &mut v.deviation,
        d.deviation,
        &[(ClusterDeviation::Exact, "Own pass"), (ClusterDeviation::Merged, "Merged")],
    );
    choice(
        ui,
        "Lines",
        "How strands are drawn into the map: into one row of texels, or shared between the two nearest, which swims half as much.",
        &mut v.prefiltered,
        d.prefiltered,
        &[(true, "Pre-filtered"), (false, "Thin")],
    );
}

pub(super) fn occupancy_maps(ui: &mut Ui, v: &mut OccupancyMapsSettings, d: &OccupancyMapsSettings) {
    map(ui, (&mut v.resolution, &mut v.filter), (d.resolution, d.filter));
    count(
        ui,
        "Slices",
        "Slices of a texel's depth range, one bit each.",
        &mut v.slices,
        d.slices,
        &OccupancyMapsSettings::SLICES,
        "",
    );
    count(
        ui,
        "Slabs",
        "Slabs of slices that count their hair; the paper has 4.",
        &mut v.slabs,
        d.slabs,
        &OccupancyMapsSettings::SLABS,
        "",
    );
}

pub(super) fn exact(ui: &mut Ui, v: &mut ExactSettings, d: &ExactSettings) {
    map(ui, (&mut v.resolution, &mut v.filter), (d.resolution, d.filter));
    let mut gib = (v.memory_limit_bytes >> 20) as f32 / 1024.0;
    let default = (d.memory_limit_bytes >> 20) as f32 / 1024.0;
    let before = gib;
    Number::new("Memory limit", 0.25..=32.0, "Hair that needs more memory than this is refused.")
        .logarithmic()
        .unit(" GiB", 1.0)
        .decimals(2)
        .show(ui, &mut gib, default);
    if gib.to_bits() != before.to_bits() {
        v.memory_limit_bytes = (f64::from(gib) * f64::from(1 << 30)) as u64;
    }
}
