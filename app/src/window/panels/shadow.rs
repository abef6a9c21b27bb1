//! How hair shadows itself.

use egui::Ui;
use lovelock_studio::render::{MapExtent, ShadowMethod, ShadowSettings, VoxelDeposit, VoxelFilter};

use crate::window::control::{Number, choice, note, section};

/// The controls of `settings`; `memory_bytes` is what the maps of the last frame took.
pub(crate) fn ui(ui: &mut Ui, settings: &mut ShadowSettings, memory_bytes: u64) {
    let d = ShadowSettings::default();
    let s = settings;
    let methods: Vec<_> = ShadowMethod::ALL.iter().map(|&method| (method, method.label())).collect();
    choice(
        ui,
        "Method",
        "How the light that reaches a hair through other hair is found.",
        &mut s.method,
        d.method,
        &methods,
    );
    Number::new("Extinction", 0.01..=4.0, "How much light a hair takes away (s): low values let light fall through the hair, high ones make its inside dark. 1 is a head of opaque fibres.")
        .logarithmic()
        .decimals(3)
        .show(ui, &mut s.extinction_scale, d.extinction_scale);
    match s.method {
        ShadowMethod::None => note(ui, "Hair is lit as if no other hair were there."),
        ShadowMethod::VoxelMap => {
            let (v, d) = (&mut s.voxel_map, &d.voxel_map);
            let mut sizes = vec![32, 48, 64, 96, 128, 192, 256, 384, 512];
            if !sizes.contains(&v.resolution) {
                sizes.push(v.resolution);
            }
            let sizes: Vec<(u32, String)> = sizes.into_iter().map(|n| (n, format!("{n}³"))).collect();
            let sizes: Vec<(u32, &str)> = sizes.iter().map(|(n, name)| (*n, name.as_str())).collect();
            choice(
                ui,
                "Map resolution",
                "Cells along each edge of the map: more show finer shadows and cost more; the brightness stays.",
                &mut v.resolution,
                d.resolution,
                &sizes,
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
                    &[
                        (VoxelDeposit::Length, "By length"),
                        (VoxelDeposit::PointCount, "By points, as printed"),
                    ],
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
    }
    note(ui, format!("{:.1} MiB for the maps of all lights", memory_bytes as f64 / (1024.0 * 1024.0)));
}
