//! The list of layers.

use egui::{Id, Rect, Response, RichText, Sense, Stroke, Ui, vec2};
use egui_material_icons::MaterialIcon;
use egui_material_icons::icons::{ICON_CHEVRON_RIGHT, ICON_EXPAND_MORE};
use lovelock_style::{Layer, StyleStack};

use super::{LayersView, picked, row};
use crate::window::control::HoverTooltip;
use crate::window::theme;

/// A row of the list, by the number of its layer or group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Row {
    Layer(u32),
    Group(u32),
}

/// What a row asks for.
#[derive(Clone, Copy, Debug)]
enum Action {
    /// Selects a layer; adds it to those that are picked, or takes it away, if `bool`.
    Select(u32, bool),
    Rename(Row),
    Duplicate,
    Remove,
    Group,
    /// Takes a layer out of its group.
    Leave(u32),
    Ungroup(u32),
    RemoveGroup(u32),
    /// A row is to stand before the place of a layer, in a group.
    Move(Row, usize, Option<u32>),
}

/// Shows the list and runs the requested action.
pub(super) fn show(ui: &mut Ui, stack: &mut StyleStack, view: &mut LayersView) {
    let before = ui.spacing().item_spacing;
    let top = ui.cursor().top();
    ui.spacing_mut().item_spacing.y = 0.0;
    let mut action = None;
    let mut last_group = None;
    for i in 0..stack.layers.len() {
        let group = stack.layers[i].group;
        if group != last_group {
            last_group = group;
            if let Some(id) = group {
                ui.push_id(("group", id), |ui| group_row(ui, stack, view, (id, i), &mut action));
            }
        }
        if group.is_none_or(|id| !view.folded.contains(&id)) {
            let id = stack.layers[i].id;
            ui.push_id(("layer", id), |ui| layer_row(ui, stack, view, i, &mut action));
        }
    }
    // What is dropped below the last row stands at the end, in no group.
    let (end, _) = ui.allocate_exact_size(vec2(ui.available_width(), 8.0), Sense::hover());
    drop_on(ui, end, ui.scope_id().with("end"), (stack.layers.len(), None), None, &mut action);
    let whole = Rect::from_min_max(egui::pos2(end.left(), top), end.max);
    if ui.input(|input| input.pointer.any_pressed()) {
        let pressed = ui.input(|input| input.pointer.interact_pos());
        view.has_keys = pressed.is_some_and(|at| whole.contains(at)) && ui.is_enabled();
    }
    ui.spacing_mut().item_spacing = before;
    view.thumbnails.keep(|id| stack.layer(id).is_some());
    if let Some(action) = action {
        run(action, stack, view);
    }
}

fn run(action: Action, stack: &mut StyleStack, view: &mut LayersView) {
    match action {
        Action::Select(id, false) => view.select(Some(id)),
        Action::Select(id, true) if view.selected == Some(id) => {
            view.selected = view.also.pop_first();
        }
        Action::Select(id, true) => {
            if !view.also.remove(&id) {
                view.also.extend(view.selected.replace(id));
            }
        }
        Action::Rename(row) => {
            let name = match row {
                Row::Layer(id) => stack.layer(id).map(|layer| layer.label().to_owned()),
                Row::Group(id) => stack.group(id).map(|group| group.name.clone()),
            };
            view.renamed = name.map(|name| (row, name));
        }
        Action::Duplicate => picked::duplicate(stack, view),
        Action::Remove => picked::remove(stack, view),
        Action::Group => {
            stack.make_group(&view.picked(stack), "Group");
        }
        Action::Leave(id) => {
            // After the rest of its group.
            let group = stack.layer(id).and_then(|layer| layer.group);
            let end = stack.layers.iter().rposition(|layer| layer.group == group).map_or(0, |i| i + 1);
            stack.move_to(id, end, None);
        }
        Action::Ungroup(id) => stack.ungroup(id),
        Action::RemoveGroup(id) => stack.remove_group(id),
        Action::Move(Row::Layer(id), to, group) => stack.move_to(id, to, group),
        Action::Move(Row::Group(id), to, _) => stack.move_group(id, to),
    }
}

/// The row of the layer at `index`.
fn layer_row(
    ui: &mut Ui,
    stack: &mut StyleStack,
    view: &mut LayersView,
    index: usize,
    action: &mut Option<Action>,
) {
    let factor = stack.factor(&stack.layers[index]);
    let soloed = stack.solo;
    let StyleStack { layers, solo, solo_group, .. } = &mut *stack;
    let layer = &mut layers[index];
    let (id, group, own) = (layer.id, layer.group, Row::Layer(layer.id));
    let (rect, response) = begin(ui, own, view);
    let columns = row::Columns::of(rect, group.is_some());
    row::grip(ui, columns.grip).dnd_set_drag_payload(own);
    row::eye(ui, columns.eye, &mut layer.on, ("Layer on", "Turns the layer on or off."));
    let alpha = if factor > 0.0 { 1.0 } else { 0.4 };
    let disk = view.thumbnails.mesh(id, &layer.mask, columns.picture, alpha);
    row::picture(ui, columns.picture, disk, !layer.mask.is_everywhere());
    let known = layer.operation.known().is_some();
    if !renamed(ui, columns.name, own, view, |name| set_name(layer, name)) {
        let text = RichText::new(layer.label());
        let text = match (known, factor > 0.0) {
            (false, _) => text.color(theme::watch()),
            (_, true) => text.color(theme::bright()),
            _ => text.color(theme::quiet()),
        };
        row::name(ui, columns.name, text);
    }
    row::weight(ui, columns.weight, &mut layer.weight, ("Layer weight", "Strength of the layer."));
    let heard = soloed == Some(id);
    if row::solo(ui, columns.solo, heard, "Shows this layer alone.") {
        (*solo, *solo_group) = (if heard { None } else { Some(id) }, None);
    }
    let label = layer.label().to_owned();
    let selected = view.selected == Some(id);
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, selected, &label));
    if response.clicked() {
        let adds = ui.input(|input| input.modifiers.command || input.modifiers.shift);
        *action = Some(Action::Select(id, adds));
    }
    if response.double_clicked() {
        *action = Some(Action::Rename(own));
    }
    response.context_menu(|ui| layer_menu(ui, view, (id, group), action));
    let place = (index, group);
    drop_on(ui, rect, response.id.with("drop"), place, Some(index + 1), action);
    let what = layer.operation.known().map_or("", |operation| operation.kind().text);
    response.hover_tooltip(format!(
        "{what}\n\nDouble-click renames, Ctrl+D duplicates, Delete removes, Ctrl+click selects several."
    ));
}

/// Names a layer; the name of its operation is the default and is not stored.
fn set_name(layer: &mut Layer, name: String) {
    layer.name = if name == layer.operation.label() { String::new() } else { name };
}

fn layer_menu(
    ui: &mut Ui,
    view: &mut LayersView,
    (id, group): (u32, Option<u32>),
    action: &mut Option<Action>,
) {
    if view.selected != Some(id) && !view.also.contains(&id) {
        view.select(Some(id));
    }
    let mut entry = |ui: &mut Ui, label: &str, keys: &str, wanted: Action| {
        if ui.add(egui::Button::new(label).shortcut_text(keys)).clicked() {
            *action = Some(wanted);
            ui.close();
        }
    };
    entry(ui, "Rename", "F2", Action::Rename(Row::Layer(id)));
    entry(ui, "Duplicate", "Ctrl+D", Action::Duplicate);
    entry(ui, "Group", "Ctrl+G", Action::Group);
    if let Some(group) = group {
        entry(ui, "Move out of the group", "", Action::Leave(id));
        entry(ui, "Ungroup", "", Action::Ungroup(group));
    }
    entry(ui, "Remove", "Delete", Action::Remove);
}

/// The row of a group whose first layer is at `index`.
fn group_row(
    ui: &mut Ui,
    stack: &mut StyleStack,
    view: &mut LayersView,
    (id, index): (u32, usize),
    action: &mut Option<Action>,
) {
    let StyleStack { groups, solo, solo_group, .. } = &mut *stack;
    let Some(group) = groups.iter_mut().find(|group| group.id == id) else { return };
    let own = Row::Group(id);
    let (rect, response) = begin(ui, own, view);
    let columns = row::Columns::of(rect, false);
    row::grip(ui, columns.grip).dnd_set_drag_payload(own);
    row::eye(ui, columns.eye, &mut group.on, ("Group on", "Turns the layers of the group on or off."));
    let is_folded = view.folded.contains(&id);
    let icon = if is_folded { ICON_CHEVRON_RIGHT } else { ICON_EXPAND_MORE };
    if fold(ui, columns.picture, icon, is_folded) {
        if is_folded {
            view.folded.remove(&id);
        } else {
            view.folded.insert(id);
        }
    }
    if !renamed(ui, columns.name, own, view, |name| {
        if !name.is_empty() {
            group.name = name;
        }
    }) {
        row::name(ui, columns.name, RichText::new(&group.name).strong());
    }
    let weight = ("Group weight", "Multiplies the weights of the layers in the group.");
    row::weight(ui, columns.weight, &mut group.weight, weight);
    let heard = *solo_group == Some(id);
    if row::solo(ui, columns.solo, heard, "Shows the layers of this group alone.") {
        (*solo, *solo_group) = (None, if heard { None } else { Some(id) });
    }
    let label = group.name.clone();
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &label));
    if response.double_clicked() {
        *action = Some(Action::Rename(own));
    }
    response.context_menu(|ui| {
        let entries = [
            ("Rename", Action::Rename(own)),
            ("Ungroup", Action::Ungroup(id)),
            ("Remove with its layers", Action::RemoveGroup(id)),
        ];
        for (label, wanted) in entries {
            if ui.button(label).clicked() {
                *action = Some(wanted);
                ui.close();
            }
        }
    });
    // Above the group, or as its first layer.
    let drop = response.id.with("drop");
    let dragged = egui::DragAndDrop::payload::<Row>(ui.ctx());
    let inside = dragged.is_some_and(|row| matches!(*row, Row::Layer(_)));
    let lower = inside.then_some(index);
    drop_into(ui, rect, drop, [(index, None), (lower.unwrap_or(index), inside.then_some(id))], action);
    response.hover_tooltip("A group of layers. Double-click to rename it. Drag layers into it or out of it.");
}

/// The triangle that hides the layers of a group.
fn fold(ui: &mut Ui, rect: Rect, icon: MaterialIcon, is_folded: bool) -> bool {
    let place = egui::UiBuilder::new().id_salt("fold").max_rect(rect);
    let response = ui.new_child(place).add_sized(rect.size(), egui::Button::new(icon).frame(false));
    response
        .widget_info(|| egui::WidgetInfo::selected(egui::Role::Button, true, !is_folded, "Fold the group"));
    response.hover_tooltip("Hides or shows the layers of the group.").clicked()
}

/// The area of a row, with its background.
fn begin(ui: &mut Ui, own: Row, view: &LayersView) -> (Rect, Response) {
    let size = vec2(ui.available_width(), row::HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    response.dnd_set_drag_payload(own);
    let [selected, also] = match own {
        Row::Layer(id) => [view.selected == Some(id), view.also.contains(&id)],
        Row::Group(_) => [false; 2],
    };
    let hovered = response.hovered() || response.has_focus();
    if let Some(color) = row::background(ui, selected, also, hovered) {
        ui.painter().rect_filled(rect.shrink2(vec2(0.0, 1.0)), 3.0, color);
    }
    (rect, response)
}

/// Shows the field for a new name if this row is being renamed, and gives it with `set`.
fn renamed(ui: &mut Ui, rect: Rect, own: Row, view: &mut LayersView, set: impl FnOnce(String)) -> bool {
    let Some((row, text)) = &mut view.renamed else { return false };
    if *row != own {
        return false;
    }
    let (entered, ends) = row::rename(ui, rect, text, Layer::LONGEST_NAME);
    if let Some(name) = entered {
        set(name);
    }
    if ends {
        view.renamed = None;
    }
    true
}

/// Lets rows be dropped on the upper or lower half of `rect`: before the layer at `place`, or before the one at `below` in the same group.
fn drop_on(
    ui: &Ui,
    rect: Rect,
    id: Id,
    place: (usize, Option<u32>),
    below: Option<usize>,
    action: &mut Option<Action>,
) {
    drop_into(ui, rect, id, [place, (below.unwrap_or(place.0), place.1)], action);
}

fn drop_into(ui: &Ui, rect: Rect, id: Id, halves: [(usize, Option<u32>); 2], action: &mut Option<Action>) {
    let response = ui.interact(rect, id, Sense::hover());
    let pointer = ui.input(|input| input.pointer.hover_pos());
    let is_below = pointer.is_some_and(|at| at.y > rect.center().y);
    if response.dnd_hover_payload::<Row>().is_some() {
        let y = if is_below { rect.bottom() } else { rect.top() };
        let stroke = Stroke::new(2.0, theme::accent());
        ui.painter().hline(rect.x_range(), y, stroke);
    }
    if let Some(moved) = response.dnd_release_payload::<Row>() {
        let (to, group) = halves[usize::from(is_below)];
        *action = Some(Action::Move(*moved, to, group));
    }
}
