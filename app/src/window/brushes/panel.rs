//! The settings of the brush, in the panel and in its menu.

use egui::{RichText, Ui, WidgetInfo};
use egui_material_icons::icons::{ICON_AC_UNIT, ICON_BRUSH, ICON_PAUSE};
use lovelock_base::settings::Choices as _;
use lovelock_brush::{BrushSettings, Tool};
use lovelock_project::Project;

use super::{Brushes, Kept};
use crate::window::command::Command;
use crate::window::control::HoverTooltip;
use crate::window::control::{context_popup, curve, note, restore_all, section, settings};
use crate::window::panel::Panel;
use crate::window::pointer_tool::PointerTool;
use crate::window::purpose::Purpose;
use crate::window::readings::Readings;

/// Operations that are painted as maps of the scalp, and what painting does.
const MAPS: [(&str, &str, &str); 5] = [
    ("density", "Density", "Paints where hair is thinned out."),
    ("length", "Length", "Paints where hair is shorter."),
    ("width", "Width", "Paints where strands are thinner or thicker."),
    ("stiffness", "Stiffness", "Paints where hair is stiffer."),
    ("dye", "Colour", "Paints where hair is dyed."),
];

impl Panel for Brushes {
    fn title(&self) -> &'static str {
        "Brushes"
    }

    fn opens(&self, _project: &Project, readings: &Readings<'_>) -> bool {
        readings.tool == PointerTool::Brush
    }

    fn ui(&mut self, ui: &mut Ui, _project: &mut Project, readings: &Readings<'_>) -> Option<Command> {
        controls(ui, self, readings.tool)
    }
}

/// The switches of brushes and the settings of the tool.
fn controls(ui: &mut Ui, brushes: &mut Brushes, pointer: PointerTool) -> Option<Command> {
    let mut request = None;
    ui.horizontal_wrapped(|ui| {
        let mut toggle = |icon: egui_material_icons::MaterialIcon, name: &str, on: &mut bool, tip: &str| {
            let response = ui.add(egui::Button::selectable(*on, (icon.rich_text(), name)));
            response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, *on, name));
            if response.hover_tooltip(tip).clicked() {
                *on = !*on;
            }
        };
        let tip = "Brushes the hair with the pointer, even during playback. Drag outside the hair to move the camera. Key: H";
        let mut used = pointer == PointerTool::Brush;
        toggle(ICON_BRUSH, "Brush", &mut used, tip);
        if used != (pointer == PointerTool::Brush) {
            request = Some(Command::Use(PointerTool::Brush));
        }
        let tip = "Shows the hairstyle without its simulation. Pause (Space) instead to brush one pose of the moving hair.";
        toggle(ICON_PAUSE, "No physics", &mut brushes.still, tip);
        if brushes.strokes.frozen.contains(&true) {
            let thaw = ui.button((ICON_AC_UNIT.rich_text(), "Unfreeze all"));
            if thaw.hover_tooltip("Unfreezes all locks, so that tools act on them again.").clicked() {
                request = Some(Command::Unfreeze);
            }
        }
    });
    let tools = egui::ComboBox::from_id_salt("tool")
        .selected_text(brushes.tool.names().1)
        .width(ui.available_width() - 8.0)
        .show_ui(ui, |ui| {
            for tool in Tool::ALL {
                ui.selectable_value(&mut brushes.tool, *tool, tool.names().1);
            }
        });
    tools.response.widget_info(|| WidgetInfo::labeled(egui::Role::ComboBox, true, "Tool"));
    tools.response.hover_tooltip("What the brush does to the hair.");
    note(ui, brushes.tool.text());
    tool_settings(ui, brushes.tool, &mut brushes.kept);
    let recorded = brushes.strokes.recorded.len();
    let save = ui.add_enabled(recorded > 0, egui::Button::new("Save strokes…"));
    let tip = "Saves the strokes made since the program started, for replay with `lovelock style`.";
    if save.hover_tooltip(tip).disabled_hover_tooltip("There are no strokes yet.").clicked() {
        request = Some(Command::PickFile(Purpose::SaveStrokes));
    }
    note(ui, "Strokes go into the selected By hand layer, or into the last one.");
    ui.horizontal_wrapped(|ui| {
        ui.label("Paint a map:");
        for (id, name, tip) in MAPS {
            let tip = format!(
                "{tip} The map is the painted mask of a layer, and the layer's settings set the amount. Ctrl erases."
            );
            if ui.button(name).hover_tooltip(tip).clicked() {
                request = Some(Command::PaintMap(id));
            }
        }
    });
    request
}

/// The settings of a tool.
pub(super) fn tool_settings(ui: &mut Ui, tool: Tool, kept: &mut Kept) {
    let default = BrushSettings::default();
    let before = kept.of(tool);
    let mut now = before.clone();
    settings(ui, &["radius", "strength", "share", "front_only"], &mut now, &default);
    super::mirror::choose(ui, &mut now, &default);
    match tool {
        Tool::Comb | Tool::Attract | Tool::Place | Tool::Part => {
            settings(ui, &["keep_lengths"], &mut now, &default);
        }
        Tool::Curl => settings(ui, &["curl_radius", "curl_pitch"], &mut now, &default),
        _ => {}
    }
    section(ui, "Falloff", false, |ui| {
        let tip = "Strength of the brush from its centre (left) to its edge (right).";
        curve(ui, "From the centre", tip, &mut now.falloff, &default.falloff);
        let tip = "Strength of the brush from the root of the hair (left) to its tip (right).";
        curve(ui, "Root to tip", tip, &mut now.along, &default.along);
    });
    restore_all(ui, "Defaults", "Restores the defaults of this tool.", &mut now, &default);
    if now != before {
        kept.set(tool, now);
    }
}

impl Brushes {
    /// The menu of the brush, opened by a right click on the image.
    pub(in crate::window) fn menu(&mut self, response: &egui::Response) {
        context_popup(response, |ui| {
            ui.set_width(260.0);
            ui.label(RichText::new(self.tool.names().1).strong());
            tool_settings(ui, self.tool, &mut self.kept);
        });
    }
}
