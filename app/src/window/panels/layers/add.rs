//! The menu of new layers.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{PopupCloseBehavior, Ui};
use lovelock_style::{Kind, Layer, Mask, MaskPart, MaskRegion, Operation, StyleStack, Subject};

use super::LayersView;

/// Menus of new layers.
const MENUS: [(Subject, &str); 4] = [
    (Subject::Shape, "Shape"),
    (Subject::Strands, "Strands"),
    (Subject::Colour, "Colour"),
    (Subject::Motion, "Motion"),
];

/// The button that adds a layer.
pub(super) fn menu(ui: &mut Ui, stack: &mut StyleStack, view: &mut LayersView) {
    let full = stack.layers.len() >= StyleStack::MOST_LAYERS;
    ui.add_enabled_ui(!full, |ui| {
        // A click on the search does not close the menu.
        let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
        let (button, menu) = MenuButton::new("Add layer").config(config).ui(ui, |ui| {
            if let Some(kind) = choose(ui, &mut view.search)
                && let Some(operation) = Operation::new(kind.id)
            {
                add(stack, view, operation);
                view.search.clear();
                ui.close();
            }
        });
        if menu.is_none() {
            view.search.clear();
        }
        let tip = "Adds a change of the hair after the selected layer.";
        let full = format!("There are {} layers, the most.", StyleStack::MOST_LAYERS);
        button.on_hover_text(tip).on_disabled_hover_text(full);
    });
}

/// Adds a layer after the selected one, in its group, and selects it.
fn add(stack: &mut StyleStack, view: &mut LayersView, operation: Operation) {
    let after = view.selected.and_then(|id| stack.layers.iter().position(|layer| layer.id == id));
    let group = after.and_then(|i| stack.layers[i].group);
    let at = after.map_or(stack.layers.len(), |i| i + 1);
    if let Some(id) = stack.insert(at, Layer { group, ..Layer::of(operation) }) {
        view.select(Some(id));
    }
}

impl LayersView {
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
        self.painting = true;
        true
    }
}

/// The kinds of layers by their subject, or those that fit what is searched. Returns the chosen one.
fn choose(ui: &mut Ui, search: &mut String) -> Option<&'static Kind> {
    ui.set_min_width(170.0);
    let field = egui::TextEdit::singleline(search).hint_text("Search").char_limit(40);
    let field = ui.add(field.desired_width(f32::INFINITY));
    field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::TextInput, true, "Search layers"));
    if ui.memory(|memory| memory.focused().is_none()) {
        field.request_focus();
    }
    let wanted = search.trim().to_lowercase();
    let mut chosen = None;
    let mut entry = |ui: &mut Ui, kind: &'static Kind| {
        if ui.button(kind.label).on_hover_text(kind.text).clicked() {
            chosen = Some(kind);
        }
    };
    // Scissors make their own layers.
    let kinds = || Operation::KINDS.iter().filter(|kind| kind.id != "scissors");
    if wanted.is_empty() {
        for (subject, name) in MENUS {
            if kinds().any(|kind| kind.subject == subject) {
                ui.menu_button(name, |ui| {
                    kinds().filter(|kind| kind.subject == subject).for_each(|kind| entry(ui, kind));
                });
            }
        }
        return chosen;
    }
    let fits = |kind: &&Kind| {
        [kind.label, kind.text].iter().any(|text| text.to_lowercase().contains(wanted.as_str()))
    };
    let found: Vec<_> = kinds().filter(fits).collect();
    for kind in &found {
        entry(ui, kind);
    }
    if found.is_empty() {
        ui.weak("No layer has that name.");
    }
    if field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter)) {
        chosen = chosen.or(found.first().copied());
    }
    chosen
}
