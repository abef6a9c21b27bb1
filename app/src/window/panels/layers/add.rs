//! The menu of new layers.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Button, PopupCloseBehavior, ScrollArea, Ui};
use lovelock_style::{Kind, Layer, Mask, MaskPart, MaskRegion, Operation, StyleStack, Subject};

use super::LayersView;
use crate::window::control::HoverTooltip;
use crate::window::picker::Picker;
use crate::window::search::{best_first, fit};

/// Greatest height of the list of matches, points.
const LIST: f32 = 320.0;

/// Menus of new layers.
const MENUS: [(Subject, &str); 4] = [
    (Subject::Shape, "Shape"),
    (Subject::Strands, "Strands"),
    (Subject::Colour, "Colour"),
    (Subject::Motion, "Motion"),
];

/// The button that adds a layer.
pub(super) fn menu(ui: &mut Ui, stack: &mut StyleStack, view: &mut LayersView) {
    let full = stack.layers.len() >= StyleStack::MAX_LAYERS;
    ui.add_enabled_ui(!full, |ui| {
        // A click on the search does not close the menu.
        let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
        let (button, menu) = MenuButton::new("Add layer").config(config).ui(ui, |ui| {
            if let Some(kind) = choose(ui, &mut view.search)
                && let Some(operation) = Operation::new(kind.id)
            {
                view.add(stack, operation);
                view.search.clear();
                ui.close();
            }
        });
        if menu.is_none() {
            view.search.clear();
        }
        let tip = "Adds a layer after the selected one.";
        let full =
            format!("The limit of {} layers is reached. Remove a layer first.", StyleStack::MAX_LAYERS);
        button.hover_tooltip(tip).disabled_hover_tooltip(full);
    });
}

impl LayersView {
    /// Adds a layer after the selected one, in its group, and selects it. Returns whether there was room for it.
    pub(crate) fn add(&mut self, stack: &mut StyleStack, operation: Operation) -> bool {
        let after = self.selected.and_then(|id| stack.layers.iter().position(|layer| layer.id == id));
        let group = after.and_then(|i| stack.layers[i].group);
        let at = after.map_or(stack.layers.len(), |i| i + 1);
        let added = stack.insert(at, Layer { group, ..Layer::of(operation) });
        if added.is_some() {
            self.select(added);
        }
        added.is_some()
    }

    /// Starts to paint where an operation acts: in the selected layer or in the last one that has a painted mask, or in a new layer, which
    /// acts where it is painted. Returns whether there was room for one.
    pub(crate) fn paint_map(&mut self, stack: &mut StyleStack, id: &str) -> bool {
        let acts = |layer: &Layer| layer.on && layer.weight > 0.0 && stack.factor(layer) > 0.0;
        let fits =
            |layer: &&Layer| layer.operation.id() == id && layer.mask.painted().is_some() && acts(layer);
        let selected = self.selected.and_then(|id| stack.layer(id)).filter(fits);
        let layer = selected.or_else(|| stack.layers.iter().rev().find(fits)).map(|layer| layer.id);
        let new = |stack: &mut StyleStack| {
            let mask = Mask::of(MaskPart::region(MaskRegion::Painted));
            stack.push(Layer { mask, ..Layer::of(Operation::new(id)?) })
        };
        let Some(layer) = layer.or_else(|| new(stack)) else { return false };
        self.reveal(Some(layer));
        true
    }
}

/// The kinds of layers by their subject, or those that fit what is searched, the best first. Returns the chosen one.
fn choose(ui: &mut Ui, search: &mut Picker) -> Option<&'static Kind> {
    ui.set_min_width(170.0);
    let (field, picked) = search.field(ui, "Search layers", 170.0, true);
    let mut chosen = None;
    // Scissors make their own layers.
    let kinds = || Operation::KINDS.iter().filter(|kind| kind.id != "scissors");
    if search.typed.trim().is_empty() {
        for (subject, name) in MENUS {
            if kinds().any(|kind| kind.subject == subject) {
                let menu = ui.menu_button(name, |ui| {
                    for kind in kinds().filter(|kind| kind.subject == subject) {
                        if ui.button(kind.label).hover_tooltip(kind.text).clicked() {
                            chosen = Some(kind);
                        }
                    }
                });
                // From here on the arrow keys move through the menus.
                if picked.down && field.has_focus() {
                    menu.response.request_focus();
                }
            }
        }
        return chosen;
    }
    let found = best_first(&search.typed, kinds(), |typed, kind| fit(typed, kind.label, &[kind.text]));
    search.among(found.len());
    let most = ScrollArea::vertical().max_height(LIST);
    most.show(ui, |ui| {
        for (i, kind) in found.iter().enumerate() {
            let row = ui.add(Button::selectable(search.is_chosen(i), kind.label)).hover_tooltip(kind.text);
            search.show(i, &row);
            if row.clicked() || (picked.entered && search.is_chosen(i)) {
                chosen = Some(*kind);
            }
        }
    });
    if found.is_empty() {
        ui.weak("No layer has that name.");
    }
    chosen
}
