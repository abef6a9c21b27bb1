//! The layers of the style: the list, and the controls of the layer that is selected.

mod add;
mod keyboard;
mod list;
mod mask;
mod picked;
mod row;
mod thumbnail;

use std::collections::BTreeSet;

use egui::Ui;
use lovelock_project::Project;
use lovelock_style::{Layer, Mask, MaskBrush, Operation, StyleStack};

use super::pigments::pigments;
use crate::window::command::Command;
use crate::window::control::{all_settings, curve, note, section, settings};
use crate::window::panel::Panel;
use crate::window::picker::Picker;
use crate::window::pointer_tool::PointerTool;
use crate::window::readings::Readings;
use list::Row;
use thumbnail::Thumbnails;

/// What the panel shows of the layers, besides the stack itself.
#[derive(Clone, Debug, Default)]
pub(crate) struct LayersView {
    /// The layer whose controls are shown.
    pub(crate) selected: Option<u32>,
    /// Further layers that are picked with it.
    also: BTreeSet<u32>,
    /// Whether the image shows the mask of the selected layer.
    pub(crate) show_mask: bool,
    /// The brush that paints it.
    pub(crate) brush: MaskBrush,
    /// The row that is being renamed, and the text so far.
    renamed: Option<(Row, String)>,
    /// Groups whose layers are hidden.
    folded: BTreeSet<u32>,
    /// Whether keys go to the list, because it was clicked last.
    has_keys: bool,
    /// What is searched in the menu of new layers.
    search: Picker,
    thumbnails: Thumbnails,
    /// Passes in which the panel is scrolled to the list, while sections unfold.
    revealed: u8,
}

/// The passes after which every section is unfolded.
const UNFOLDING: u8 = 60;

impl LayersView {
    /// Selects a layer, shows its mask and scrolls to the list.
    pub(crate) fn reveal(&mut self, layer: Option<u32>) {
        if layer.is_some() {
            self.select(layer);
            (self.show_mask, self.revealed) = (true, UNFOLDING);
        }
    }

    /// Whether the list is to be unfolded.
    pub(crate) fn is_revealed(&self) -> bool {
        self.revealed > 0
    }

    /// Shows or hides the mask of the selected layer in the image.
    pub(crate) fn toggle_mask(&mut self) {
        self.show_mask = !self.show_mask;
    }

    /// Makes the brush smaller or larger.
    pub(crate) fn resize_brush(&mut self, factor: f32) {
        let radius = self.brush.radius * factor;
        self.brush = lovelock_base::settings::Settings::clamped(&MaskBrush { radius, ..self.brush });
    }

    /// The mask that the image shows, if any.
    pub(crate) fn shown_mask<'a>(&self, stack: &'a StyleStack) -> Option<&'a Mask> {
        let layer = self.selected.and_then(|id| stack.layer(id));
        layer.filter(|_| self.show_mask).map(|layer| &layer.mask)
    }

    /// The layers that are picked, in their order.
    fn picked(&self, stack: &StyleStack) -> Vec<u32> {
        let is_picked = |layer: &&Layer| self.selected == Some(layer.id) || self.also.contains(&layer.id);
        stack.layers.iter().filter(is_picked).map(|layer| layer.id).collect()
    }

    fn select(&mut self, id: Option<u32>) {
        self.selected = id;
        self.also.clear();
    }

    /// Forgets layers that are no longer there.
    fn follow(&mut self, stack: &StyleStack) {
        self.selected = self.selected.filter(|id| stack.layer(*id).is_some());
        self.also.retain(|id| stack.layer(*id).is_some());
        self.folded.retain(|id| stack.group(*id).is_some());
    }
}

impl Panel for LayersView {
    fn title(&self) -> &'static str {
        "Layers"
    }

    fn opens(&self, _project: &Project, _readings: &Readings<'_>) -> bool {
        self.is_revealed()
    }

    fn ui(&mut self, ui: &mut Ui, project: &mut Project, readings: &Readings<'_>) -> Option<Command> {
        stack_of_layers(ui, &mut project.hair.stack, self, readings.tool)
    }
}

/// The list of layers and the controls of the one that is selected.
fn stack_of_layers(
    ui: &mut Ui,
    stack: &mut StyleStack,
    view: &mut LayersView,
    tool: PointerTool,
) -> Option<Command> {
    if view.revealed > 0 {
        view.revealed -= 1;
        ui.scroll_to_cursor(Some(egui::Align::TOP));
    }
    view.follow(stack);
    add::menu(ui, stack, view);
    if stack.layers.is_empty() {
        note(ui, "No layers. A layer changes the hair, everywhere or within its mask.");
        return None;
    }
    keyboard::run(ui, stack, view);
    list::show(ui, stack, view);
    view.follow(stack);
    let Some(id) = view.selected else {
        note(ui, "Click a layer to edit it.");
        return None;
    };
    let layer = stack.layer_mut(id)?;
    ui.separator();
    ui.push_id(id, |ui| controls(ui, layer, view, tool)).inner
}

/// The controls of one layer.
fn controls(ui: &mut Ui, layer: &mut Layer, view: &mut LayersView, tool: PointerTool) -> Option<Command> {
    let fresh = Operation::new(layer.operation.id());
    match (layer.operation.known_mut(), fresh.as_ref().and_then(Operation::known)) {
        (Some(operation), Some(default)) => {
            note(ui, operation.kind().text);
            pigments(ui, operation.settings_mut());
            all_settings(ui, operation.settings_mut(), default.settings());
            for (i, info) in operation.ramps().iter().enumerate() {
                ui.push_id(info.name, |ui| {
                    curve(ui, info.label, info.text, operation.ramp_mut(i), default.ramp(i));
                });
            }
        }
        _ => note(ui, "This version does not support this operation. The layer is kept and has no effect."),
    }
    let default = Layer::default();
    settings(ui, &["weight", "seed"], layer, &default);
    section(ui, "Along the hair", false, |ui| {
        let tip = "Strength of the layer from the root to the tip.";
        curve(ui, "Strength along the hair", tip, &mut layer.ramp, &default.ramp);
    });
    let open = tool == PointerTool::Mask || view.show_mask;
    section(ui, "Mask", open, |ui| mask::ui(ui, &mut layer.mask, view, tool)).flatten()
}
