//! The controls of the voxel map.

use egui::Ui;
use lovelock_render::{MapExtent, VoxelDeposit, VoxelFilter, VoxelMapSettings};

use super::count;
use crate::window::control::{Number, choice, section};

pub(super) fn ui(ui: &mut Ui, v: &mut VoxelMapSettings, d: &VoxelMapSettings) {
    count(
        ui,
        "Map resolution",
        "Cells along each edge of the map (N): more show finer shadows and cost more; the brightness stays.",
        &mut v.resolution,
        d.resolution,
        &[32, 48, 64, 96, 128, 192, 256, 384, 512],
        "³",
    );
    section(ui, "As published", false, |ui| {
        choice(
            ui,
            "Filter",
            "How a point reads the cells around it. As printed, shadows lie half a cell aside.",
            &mut v.filter,
            d.filter,
            &[(VoxelFilter::Centred, "Centred"), (VoxelFilter::Paper, "As printed")],
        );
        choice(
            ui,
            "Density",
            "What strands add to the cells: the optical depth of their length, or one a point as printed, which makes the brightness depend on the resolution.",
            &mut v.deposit,
            d.deposit,
            &[(VoxelDeposit::Length, "By length"), (VoxelDeposit::PointCount, "By points, as printed")],
        );
        choice(
            ui,
            "Extent",
            "How large the map is: the hair's own size, or the paper's bound for any pose.",
            &mut v.extent,
            d.extent,
            &[(MapExtent::Fit, "The hair's size"), (MapExtent::Paper, "The paper's bound")],
        );
        if v.deposit == VoxelDeposit::PointCount {
            Number::new("Point extinction", 0.1..=1000.0, "What one point adds (f), per metre.")
                .logarithmic()
                .unit(" /m", 1.0)
                .decimals(1)
                .show(ui, &mut v.point_extinction, d.point_extinction);
        }
    });
}
