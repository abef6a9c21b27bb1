//! The layers of the style: the list, and the controls of the layer that is selected.

use egui::{Sense, Stroke, Ui};
use egui_material_icons::icons::{ICON_DRAG_INDICATOR, ICON_TONALITY, ICON_VISIBILITY, ICON_VISIBILITY_OFF};
use lovelock_style::{Kind, Layer, Mask, MaskPart, MaskRegion, Operation, StyleStack, Subject};

use super::pigments::pigments;
use crate::window::control::{all_settings, curve, note, section, settings};

/// Menus of new layers.
const MENUS: [(Subject, &str); 4] = [
    (Subject::Shape, "Shape"),
    (Subject::Strands, "Strands"),
    (Subject::Colour, "Colour"),
    (Subject::Motion, "Motion"),
];

/// What a row of the list asks for.
enum Action {
    Duplicate(u32),
    Remove(u32),
    Group(u32),
    Ungroup(u32),
    /// A layer is to stand before the place of another, in its group.
    Move(u32, usize, Option<u32>),
}

/// The list of layers and the controls of the one whose number is `selected`.
pub(crate) fn ui(ui: &mut Ui, stack: &mut StyleStack, selected: &mut Option<u32>) {
    add_menu(ui, stack, selected);
    if stack.layers.is_empty() {
        note(ui, "No layers: the hair is as it grows. A layer changes it, wholly or where its mask is.");
        return;
    }
    list(ui, stack, selected);
    *selected = selected.filter(|id| stack.layer(*id).is_some());
    if let Some(layer) = selected.and_then(|id| stack.layer_mut(id)) {
        ui.separator();
        ui.push_id(layer.id, |ui| controls(ui, layer));
    }
}

fn add_menu(ui: &mut Ui, stack: &mut StyleStack, selected: &mut Option<u32>) {
    let full = stack.layers.len() >= StyleStack::MOST_LAYERS;
    ui.add_enabled_ui(!full, |ui| {
        let menu = ui.menu_button("Add layer", |ui| {
            for (subject, name) in MENUS {
                let kinds: Vec<&Kind> = Operation::KINDS
                    .iter()
                    .filter(|kind| kind.subject == subject && kind.id != "scissors")
                    .collect();
                if kinds.is_empty() {
                    continue;
                }
                ui.menu_button(name, |ui| {
                    for kind in kinds {
                        if ui.button(kind.label).on_hover_text(kind.text).clicked() {
                            let at = selected
                                .and_then(|id| stack.layers.iter().position(|layer| layer.id == id))
                                .map_or(stack.layers.len(), |i| i + 1);
                            if let Some(operation) = Operation::new(kind.id) {
                                *selected = stack.insert(at, Layer::of(operation)).or(*selected);
                            }
                            ui.close();
                        }
                    }
                });
            }
        });
        menu.response.on_hover_text("Adds a change of the hair after the selected layer.");
    });
}

/// An eye that switches something, which screen readers call `name`.
fn eye(ui: &mut Ui, on: &mut bool, name: &str, tip: &str) {
    let icon = if *on { ICON_VISIBILITY } else { ICON_VISIBILITY_OFF };
    let response = ui.add(egui::Button::new(icon).frame(false)).on_hover_text(tip);
    if response.clicked() {
        *on = !*on;
    }
    let on = *on;
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, true, on, name));
}

fn list(ui: &mut Ui, stack: &mut StyleStack, selected: &mut Option<u32>) {
    let mut action = None;
    let mut group_shown = None;
    for i in 0..stack.layers.len() {
        let group = stack.layers[i].group;
        if group != group_shown {
            group_shown = group;
            if let Some(group) = stack.groups.iter_mut().find(|shown| Some(shown.id) == group) {
                ui.horizontal(|ui| {
                    eye(ui, &mut group.on, "Group on", "Switches the layers of the group.");
                    ui.add(egui::TextEdit::singleline(&mut group.name).desired_width(120.0));
                    weight(ui, &mut group.weight, "Factor on the weights of the layers of the group.");
                });
            }
        }
        let soloed = stack.solo;
        let StyleStack { layers, solo, .. } = &mut *stack;
        let layer = &mut layers[i];
        let row = ui.horizontal(|ui| {
            if group.is_some() {
                ui.add_space(14.0);
            }
            let grip = ui.add(egui::Label::new(ICON_DRAG_INDICATOR).sense(Sense::drag()));
            grip.on_hover_text("Drag to move the layer. Layers act from the top to the bottom.")
                .dnd_set_drag_payload(layer.id);
            eye(ui, &mut layer.on, "Layer on", "Switches the layer.");
            let name = ui.selectable_label(*selected == Some(layer.id), layer.label());
            if name.clicked() {
                *selected = Some(layer.id);
            }
            name.context_menu(|ui| {
                let entries = [
                    ("Duplicate", Action::Duplicate(layer.id)),
                    if let Some(id) = group {
                        ("Ungroup", Action::Ungroup(id))
                    } else {
                        ("Group", Action::Group(layer.id))
                    },
                    ("Remove", Action::Remove(layer.id)),
                ];
                for (label, wanted) in entries {
                    if ui.button(label).clicked() {
                        action = Some(wanted);
                        ui.close();
                    }
                }
            });
            weight(ui, &mut layer.weight, "How much the layer acts.");
            let heard = soloed == Some(layer.id);
            if ui.selectable_label(heard, "S").on_hover_text("Shows this layer alone.").clicked() {
                *solo = if heard { None } else { Some(layer.id) };
            }
            if !layer.mask.is_everywhere() {
                ui.weak(ICON_TONALITY).on_hover_text("The layer has a mask.");
            }
        });
        let response = ui.interact(row.response.rect, row.response.id.with("drop"), Sense::hover());
        let below =
            ui.input(|input| input.pointer.hover_pos()).is_some_and(|at| at.y > response.rect.center().y);
        if response.dnd_hover_payload::<u32>().is_some() {
            let y = if below { response.rect.bottom() } else { response.rect.top() };
            let stroke = Stroke::new(2.0, ui.visuals().selection.bg_fill);
            ui.painter().hline(response.rect.x_range(), y, stroke);
        }
        if let Some(moved) = response.dnd_release_payload::<u32>() {
            action = Some(Action::Move(*moved, i + usize::from(below), group));
        }
    }
    match action {
        Some(Action::Duplicate(id)) => *selected = stack.duplicate(id).or(*selected),
        Some(Action::Remove(id)) => stack.remove(id),
        Some(Action::Group(id)) => {
            stack.make_group(&[id], "Group");
        }
        Some(Action::Ungroup(id)) => stack.ungroup(id),
        Some(Action::Move(id, to, group)) => stack.move_to(id, to, group),
        None => {}
    }
}

fn weight(ui: &mut Ui, value: &mut f32, tip: &str) {
    let mut percent = *value * 100.0;
    let drag = egui::DragValue::new(&mut percent).range(0.0..=200.0).suffix(" %").max_decimals(0);
    if ui.add(drag).on_hover_text(tip).changed() {
        *value = percent / 100.0;
    }
}

/// The controls of one layer.
fn controls(ui: &mut Ui, layer: &mut Layer) {
    ui.horizontal(|ui| {
        ui.label("Name");
        let hint = layer.operation.label().to_owned();
        ui.add(egui::TextEdit::singleline(&mut layer.name).hint_text(hint).char_limit(Layer::LONGEST_NAME));
    });
    let fresh = Operation::new(layer.operation.id());
    match (layer.operation.known_mut(), fresh.as_ref().and_then(Operation::known)) {
        (Some(operation), Some(default)) => {
            note(ui, operation.kind().text);
            pigments(ui, operation.settings_mut());
            all_settings(ui, operation.settings_mut(), default.settings());
            for (i, info) in operation.ramps().iter().enumerate() {
                ui.push_id(info.name, |ui| curve(ui, info.label, info.text, operation.ramp_mut(i)));
            }
        }
        _ => note(ui, "This version does not know the operation. It is kept and does nothing."),
    }
    settings(ui, &["weight", "seed"], layer, &Layer::default());
    section(ui, "Along the hair", false, |ui| {
        curve(
            ui,
            "Strength along the hair",
            "How much the layer acts from the root to the tip.",
            &mut layer.ramp,
        );
    });
    section(ui, "Mask", false, |ui| mask(ui, &mut layer.mask));
}

/// The parts of a mask.
fn mask(ui: &mut Ui, mask: &mut Mask) {
    let mut removed = None;
    for (i, part) in mask.parts.iter_mut().enumerate() {
        ui.push_id(i, |ui| {
            ui.horizontal(|ui| {
                egui::ComboBox::from_id_salt("region").selected_text(part.region.label().to_owned()).show_ui(
                    ui,
                    |ui| {
                        for (region, _, label) in MaskRegion::ALL {
                            ui.selectable_value(&mut part.region, region, label);
                        }
                    },
                );
                if ui.button("Remove").on_hover_text("Removes the region from the mask.").clicked() {
                    removed = Some(i);
                }
            });
            let default = MaskPart::default();
            if i > 0 {
                settings(ui, &["mix"], part, &default);
            }
            settings(ui, &["inverted"], part, &default);
            match part.region {
                MaskRegion::All | MaskRegion::Painted | MaskRegion::Unknown(_) => {}
                MaskRegion::Patch => settings(ui, &["centre", "radius", "softness"], part, &default),
                _ => settings(ui, &["border", "softness"], part, &default),
            }
        });
    }
    if let Some(i) = removed {
        mask.parts.remove(i);
    }
    ui.horizontal(|ui| {
        let full = mask.parts.len() >= Mask::MOST_PARTS;
        let add = ui.add_enabled(!full, egui::Button::new("Add region"));
        if add.on_hover_text("Limits the layer to a region of the head.").clicked() {
            mask.parts.push(MaskPart::region(MaskRegion::Front));
        }
        ui.checkbox(&mut mask.inverted, "Invert all").on_hover_text("Takes the rest of the head.");
    });
}
