//! The title bar of a pane: its method, its settings, and its buttons.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{PopupCloseBehavior, Rect, RichText, Ui, UiBuilder, pos2, vec2};
use egui_material_icons::{MaterialIcon, icons};
use lovelock_panes::request::LivePane;
use lovelock_project::Project;
use lovelock_project::project::Contender;
use lovelock_render::ShadowMethod;

use crate::window::control::HoverTooltip;
use crate::window::control::{note, settings as setting_rows};
use crate::window::{panels, theme};

/// Height of the title bar, points.
pub(super) const HEIGHT: f32 = 26.0;

/// An action on a pane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PaneAction {
    /// Use its settings for the project.
    Use(usize),
    /// Swap it with the next one.
    Swap(usize),
    /// Remove it.
    Remove(usize),
}

/// Width of one of the buttons at the right, points.
const BUTTON: f32 = 24.0;

/// Shows the title bar of pane `index` of `panes` in `line`. Its controls change `pane`; `drawn` is its last image.
pub(super) fn ui(
    ui: &mut Ui,
    line: Rect,
    (index, panes): (usize, usize),
    pane: &mut Contender,
    drawn: Option<&LivePane>,
) -> Option<PaneAction> {
    let mut action = None;
    let middle = line.center().y;
    let part = |from: f32, to: f32| Rect::from_x_y_ranges(from..=to.max(from), middle - 10.0..=middle + 10.0);
    let swatch = Rect::from_center_size(pos2(line.left() + 11.0, middle), vec2(8.0, 14.0));
    ui.painter().rect_filled(swatch, 2.0, theme::PLOT[index % theme::PLOT.len()]);
    let buttons = line.right() - 4.0 * BUTTON - 4.0;
    let left = line.left() + 20.0;
    let width = (buttons - left - 4.0).clamp(50.0, 148.0);
    ui.scope_builder(UiBuilder::new().max_rect(part(left, left + width)), |ui| {
        method(ui, index, pane, width);
    });
    // The adapter, which does not follow from the chosen backend.
    let drawn = drawn.filter(|drawn| drawn.contender == *pane && !drawn.adapter.name.is_empty());
    let said = drawn.map_or_else(|| pane.settings_label(), LivePane::settings_label);
    let tip = drawn.map_or_else(|| said.clone(), |drawn| format!("{said}\n{}", drawn.adapter.name));
    let room = part(left + width + 8.0, buttons - 2.0);
    if room.width() > 36.0 {
        let text = egui::Label::new(RichText::new(&said).small().color(theme::QUIET)).truncate();
        ui.scope_builder(
            UiBuilder::new().max_rect(room).layout(egui::Layout::left_to_right(egui::Align::Center)),
            |ui| ui.add(text).hover_tooltip(&tip),
        );
    }
    let place = |nth: u8| part(buttons + BUTTON * f32::from(nth), buttons + BUTTON * f32::from(nth + 1));
    ui.scope_builder(UiBuilder::new().max_rect(place(0)), |ui| settings(ui, index, pane));
    let mut button = |nth: u8, icon: MaterialIcon, name: &str, tip: &str, enabled: bool, what: PaneAction| {
        let button = egui::Button::new(icon).frame(false);
        let response = ui
            .scope_builder(UiBuilder::new().max_rect(place(nth)), |ui| ui.add_enabled(enabled, button))
            .inner;
        let response = response.hover_tooltip(tip);
        let name = format!("{name} {}", index + 1);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, enabled, &name));
        if response.clicked() {
            action = Some(what);
        }
    };
    let swap = "Swaps this pane with the next one.";
    button(1, icons::ICON_SWAP_HORIZ, "Swap pane", swap, index + 1 < panes, PaneAction::Swap(index));
    let take = "Uses these settings for the project.";
    button(2, icons::ICON_CHECK, "Use pane", take, true, PaneAction::Use(index));
    button(3, icons::ICON_CLOSE, "Remove pane", "Removes this pane.", panes > 1, PaneAction::Remove(index));
    action
}

/// The choice of method.
fn method(ui: &mut Ui, index: usize, pane: &mut Contender, width: f32) {
    let response = egui::ComboBox::from_id_salt(("method", index))
        .selected_text(pane.shadow.method.label())
        .width(width)
        .height(320.0)
        .truncate()
        .show_ui(ui, |ui| {
            for &method in ShadowMethod::ALL {
                ui.selectable_value(&mut pane.shadow.method, method, method.label())
                    .hover_tooltip(method.description());
            }
        })
        .response;
    response.widget_info(|| {
        let name = format!("Method of pane {}", index + 1);
        egui::WidgetInfo::labeled(egui::Role::ComboBox, true, name)
    });
}

/// The button that opens all settings of a pane.
fn settings(ui: &mut Ui, index: usize, pane: &mut Contender) {
    let button = egui::Button::new(icons::ICON_TUNE).frame(false);
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let (response, _) = MenuButton::from_button(button).config(config).ui(ui, |ui| {
        ui.set_width(300.0);
        all_settings(ui, pane);
    });
    let response = response.hover_tooltip(
        "What hair is drawn as, transparency, backend, resolution and all settings of the method.",
    );
    let name = format!("Settings of pane {}", index + 1);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
}

/// All settings of a pane.
pub(super) fn all_settings(ui: &mut Ui, pane: &mut Contender) {
    if let Some(take) = pane.take_name() {
        ui.horizontal(|ui| {
            ui.label(format!("Shows the {take}"));
            let tip = "Shows the scene of the other panes in place of the take.";
            if ui.button("Remove take").hover_tooltip(tip).clicked() {
                pane.take = None;
            }
        });
    }
    ui.label(RichText::new(pane.shadow.method.label()).strong());
    note(ui, pane.shadow.method.description());
    setting_rows(ui, &["draw", "transparency", "backend", "scale"], pane, &pane_defaults());
    panels::shadow::of_method(ui, &mut pane.shadow);
}

/// The values to which the controls of a pane return.
fn pane_defaults() -> Contender {
    Contender { scale: 1.0, ..Contender::of(&Project::default()) }
}
