//! How hair shadows itself.

mod texels;
mod voxel_map;

use egui::Ui;
use lovelock_render::{ShadowMethod, ShadowSettings};

use crate::window::control::{Number, choice, note};

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
    note(ui, s.method.description());
    Number::new("Extinction", 0.01..=4.0, "How much light a hair takes away (s): low values let light fall through the hair, high ones make its inside dark. 1 is a head of opaque fibres.")
        .logarithmic()
        .decimals(3)
        .show(ui, &mut s.extinction_scale, d.extinction_scale);
    of_method(ui, s, &d);
    note(ui, format!("{:.1} MiB for the maps of all lights", memory_bytes as f64 / (1024.0 * 1024.0)));
}

/// The controls of the method in use.
pub(crate) fn of_method(ui: &mut Ui, s: &mut ShadowSettings, d: &ShadowSettings) {
    match s.method {
        ShadowMethod::None => {}
        ShadowMethod::VoxelMap => voxel_map::ui(ui, &mut s.voxel_map, &d.voxel_map),
        ShadowMethod::OpacityMaps => texels::opacity_maps(ui, &mut s.opacity_maps, &d.opacity_maps),
        ShadowMethod::DeepOpacityMaps => {
            texels::deep_opacity_maps(ui, &mut s.deep_opacity_maps, &d.deep_opacity_maps);
        }
        ShadowMethod::DensityClustering => {
            texels::density_clustering(ui, &mut s.density_clustering, &d.density_clustering);
        }
        ShadowMethod::OccupancyMaps => texels::occupancy_maps(ui, &mut s.occupancy_maps, &d.occupancy_maps),
        ShadowMethod::Exact => texels::exact(ui, &mut s.exact, &d.exact),
    }
}

/// A whole number out of some, each shown with `suffix`; a value that is none of them is shown too.
fn count(
    ui: &mut Ui,
    label: &'static str,
    tip: &'static str,
    value: &mut u32,
    default: u32,
    offered: &[u32],
    suffix: &str,
) {
    let mut offered = offered.to_vec();
    if !offered.contains(value) {
        offered.push(*value);
        offered.sort_unstable();
    }
    let names: Vec<String> = offered.iter().map(|n| format!("{n}{suffix}")).collect();
    let choices: Vec<(u32, &str)> = offered.iter().zip(&names).map(|(&n, name)| (n, name.as_str())).collect();
    choice(ui, label, tip, value, default, &choices);
}
