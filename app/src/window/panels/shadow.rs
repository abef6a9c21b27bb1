//! How hair shadows itself.

use egui::{RichText, Ui, WidgetInfo};
use lovelock_project::Project;
use lovelock_render::{MapExtent, ShadowMethod, ShadowSettings, VoxelDeposit, VoxelMapSettings};

use crate::window::command::Command;
use crate::window::control::{HoverTooltip, all_settings, note, section, setting, settings};
use crate::window::panel::Panel;
use crate::window::readings::{PaneReading, Readings};
use crate::window::theme;

/// The shadow method of the project, or of a pane while panes are shown.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ShadowPanel;

impl Panel for ShadowPanel {
    fn title(&self) -> &'static str {
        "Shadow"
    }

    fn opens(&self, _project: &Project, _readings: &Readings<'_>) -> bool {
        true
    }

    fn ui(&mut self, ui: &mut Ui, project: &mut Project, readings: &Readings<'_>) -> Option<Command> {
        let pane = readings.pane.as_ref();
        let chosen = pane.and_then(|pane| choose_pane(ui, pane));
        let default = ShadowSettings::default();
        let Project { shadow, look, hair, .. } = project;
        setting(ui, "method", shadow, &default);
        note(ui, shadow.method.description());
        if pane.is_none() {
            setting(ui, "extinction_scale", look, &hair.groom.look);
        }
        of_method(ui, shadow);
        let memory_bytes = pane.map_or(readings.shadow_bytes, |pane| pane.shadow_bytes);
        if let Some(bytes) = memory_bytes {
            note(ui, format!("{:.1} MiB for the maps of all lights", bytes as f64 / (1024.0 * 1024.0)));
        }
        if pane.is_some() {
            shared(ui);
            setting(ui, "extinction_scale", look, &hair.groom.look);
        }
        chosen.map(Command::EditPane)
    }
}

/// The choice of the pane that the panels edit.
fn choose_pane(ui: &mut Ui, reading: &PaneReading) -> Option<usize> {
    let mut chosen = None;
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new("Edits pane").strong());
        for &pane in &reading.visible {
            let text = RichText::new(format!("{}", pane + 1)).color(theme::PLOT[pane % theme::PLOT.len()]);
            let tip = "Shows the settings of this pane below. Clicking the pane also selects it.";
            let on = pane == reading.pane;
            let response = ui.selectable_label(on, text).hover_tooltip(tip);
            let name = format!("Edit pane {}", pane + 1);
            response.widget_info(|| WidgetInfo::selected(egui::Role::RadioButton, true, on, &name));
            if response.clicked() {
                chosen = Some(pane);
            }
        }
    });
    chosen
}

/// The heading of settings that all panes share.
pub(super) fn shared(ui: &mut Ui) {
    ui.add_space(4.0);
    ui.label(RichText::new("Shared by all panes").strong());
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
