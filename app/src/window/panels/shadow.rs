//! How hair shadows itself.

use egui::{RichText, Ui, WidgetInfo};
use lovelock_base::settings::AnySettings;
use lovelock_project::Project;
use lovelock_render::{
    MapExtent, MapForm, MapValue, MapView, ShadowMethod, ShadowSettings, VoxelDeposit, VoxelMapSettings,
    VoxelSlices, fallbacks_sentence,
};

use crate::window::command::Command;
use crate::window::control::{HoverTooltip, any_setting, note, section, setting, settings};
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
        let Project { shadow, look, hair, picture, .. } = project;
        setting(ui, "method", shadow, &default);
        note(ui, shadow.method.description());
        if pane.is_none() {
            setting(ui, "extinction_scale", look, &hair.groom.look);
        }
        of_method(ui, shadow);
        if let Some((bytes, fallbacks)) = pane.map_or(readings.maps, |pane| pane.maps) {
            note(ui, format!("{:.1} MiB for the maps of all lights", bytes as f64 / (1024.0 * 1024.0)));
            if let Some(sentence) = fallbacks_sentence(fallbacks) {
                note(ui, sentence);
            }
        }
        if pane.is_some() {
            shared(ui);
            setting(ui, "extinction_scale", look, &hair.groom.look);
        }
        section(ui, "Map over the hair", false, |ui| map_view(ui, &mut picture.map_view));
        chosen.map(Command::EditPane)
    }
}

/// The shadow map that is drawn over the hair.
fn map_view(ui: &mut Ui, view: &mut MapView) {
    let default = MapView::default();
    setting(ui, "value", view, &default);
    let legend = match view.value {
        MapValue::None => return,
        MapValue::Transmittance => "Dark: no light arrives. Bright: all light arrives.".to_owned(),
        MapValue::Density => format!("Dark: no hair. Bright: {:.0} /m and more.", view.density_range),
    };
    note(ui, legend);
    settings(ui, &["form", "light"], view, &default);
    let place = if view.form == MapForm::Points { "points" } else { "slice" };
    settings(ui, &[place, "opacity"], view, &default);
    if view.value == MapValue::Density {
        setting(ui, "density_range", view, &default);
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
    if let ShadowMethod::User(user) = method {
        note(ui, user.folder().display().to_string());
        if let Some(problem) = user.problem() {
            let last = if user.works() { " The last version that worked is used." } else { "" };
            ui.label(RichText::new(format!("{problem}{last}")).color(theme::wrong()));
        }
    }
    if method == ShadowMethod::VoxelMap {
        setting(ui, "resolution", &mut shadow.voxel_map, &default.voxel_map);
        memory_of_map(ui, shadow);
        voxel_map(ui, &mut shadow.voxel_map, &default.voxel_map);
        return;
    }
    let infos = shadow.of_method(method).map(AnySettings::infos).unwrap_or_default();
    for info in infos {
        if let (Some(settings), Some(default)) = (shadow.of_method_mut(method), default.of_method(method)) {
            any_setting(ui, info, settings, default);
        }
        if info.name == "resolution" {
            memory_of_map(ui, shadow);
        }
    }
}

/// The memory of a map of the chosen resolution, also while its slider is held.
fn memory_of_map(ui: &mut Ui, shadow: &ShadowSettings) {
    let mib = shadow.map_bytes() as f64 / (1024.0 * 1024.0);
    let text = match shadow.method {
        ShadowMethod::Exact => format!("{mib:.1} MiB per light, and 8 bytes per strand and texel"),
        // Each thread of the processor adds its strands to a grid of its own.
        ShadowMethod::VoxelMap => format!("At most {mib:.1} MiB per light and thread"),
        _ => format!("At most {mib:.1} MiB per light"),
    };
    note(ui, text);
}

/// The rest of the voxel map, whose choices of the published version are folded away.
fn voxel_map(ui: &mut Ui, map: &mut VoxelMapSettings, default: &VoxelMapSettings) {
    setting(ui, "slices", map, default);
    if map.slices == VoxelSlices::Adaptive {
        return;
    }
    setting(ui, "filter", map, default);
    section(ui, "As published", false, |ui| {
        settings(ui, &["deposit", "extent"], map, default);
        if map.extent == MapExtent::Paper {
            setting(ui, "head_size", map, default);
        }
        if map.deposit == VoxelDeposit::PointCount {
            setting(ui, "point_extinction", map, default);
        }
    });
}
