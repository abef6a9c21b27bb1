//! How hair shadows itself.

use egui::Ui;
use lovelock_groom::HairLook;
use lovelock_render::{MapExtent, ShadowMethod, ShadowSettings, VoxelDeposit, VoxelMapSettings};

use crate::window::control::{all_settings, note, section, setting, settings};

/// The controls of `shadow`; `memory_bytes` is the size of the maps of the last frame.
pub(crate) fn ui(
    ui: &mut Ui,
    shadow: &mut ShadowSettings,
    (look, default_look): (&mut HairLook, &HairLook),
    memory_bytes: u64,
) {
    let default = ShadowSettings::default();
    setting(ui, "method", shadow, &default);
    note(ui, shadow.method.description());
    setting(ui, "extinction_scale", look, default_look);
    of_method(ui, shadow);
    note(ui, format!("{:.1} MiB for the maps of all lights", memory_bytes as f64 / (1024.0 * 1024.0)));
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
