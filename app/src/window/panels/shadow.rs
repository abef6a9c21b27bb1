//! How hair shadows itself.

use egui::Ui;
use lovelock_groom::HairLook;
use lovelock_render::{MapExtent, ShadowMethod, ShadowSettings, VoxelDeposit, VoxelMapSettings};

use crate::window::control::{all_settings, note, section, setting, settings};

/// The controls of `shadow`; `memory_bytes` is the size of the maps of the last frame, if there is one. `compares` says that `shadow` is
/// that of a pane and the rest is shared.
pub(crate) fn ui(
    ui: &mut Ui,
    shadow: &mut ShadowSettings,
    (look, default_look): (&mut HairLook, &HairLook),
    memory_bytes: Option<u64>,
    compares: bool,
) {
    let default = ShadowSettings::default();
    setting(ui, "method", shadow, &default);
    note(ui, shadow.method.description());
    if !compares {
        setting(ui, "extinction_scale", look, default_look);
    }
    of_method(ui, shadow);
    if let Some(bytes) = memory_bytes {
        note(ui, format!("{:.1} MiB for the maps of all lights", bytes as f64 / (1024.0 * 1024.0)));
    }
    if compares {
        shared(ui);
        setting(ui, "extinction_scale", look, default_look);
    }
}

/// The heading of settings that all panes share.
pub(crate) fn shared(ui: &mut Ui) {
    ui.add_space(4.0);
    ui.label(egui::RichText::new("Shared by all panes").strong());
}

/// The controls of the method in use: every setting of its table.
pub(crate) fn of_method(ui: &mut Ui, shadow: &mut ShadowSettings) {
    let default = ShadowSettings::default();
    let method = shadow.method;
    if method == ShadowMethod::VoxelMap {
        voxel_map(ui, &mut shadow.voxel_map, &default.voxel_map);
    } else if let (Some(settings), Some(default)) = (shadow.of_method_mut(method), default.of_method(method))
    {
        all_settings(ui, settings, default);
    }
}

/// The voxel map, whose choices of the published version are folded away.
fn voxel_map(ui: &mut Ui, map: &mut VoxelMapSettings, default: &VoxelMapSettings) {
    setting(ui, "resolution", map, default);
    section(ui, "As published", false, |ui| {
        settings(ui, &["filter", "deposit", "extent"], map, default);
        if map.extent == MapExtent::Paper {
            setting(ui, "head_size", map, default);
        }
        if map.deposit == VoxelDeposit::PointCount {
            setting(ui, "point_extinction", map, default);
        }
    });
}
