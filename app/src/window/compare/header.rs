//! The line over a pane: its method, its settings, and what can be done with it.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{PopupCloseBehavior, RichText, Sense, Ui, Vec2, vec2};
use egui_material_icons::icons;
use lovelock_studio::Contender;
use lovelock_studio::render::{Backend, PictureSettings, ShadowMethod, ShadowSettings, Transparency};

use super::label;
use crate::window::control::{Number, choice, note};
use crate::window::{panels, theme};

/// Height of the line, points.
pub(super) const HEIGHT: f32 = 26.0;

/// What is asked of a pane beside other settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ask {
    /// Its settings are to be the project's.
    Use(usize),
    /// It changes places with the next one.
    Swap(usize),
    /// It goes.
    Remove(usize),
}

/// The line over pane `index` of `panes`; `pane` is changed by its controls.
pub(super) fn ui(ui: &mut Ui, index: usize, panes: usize, pane: &mut Contender) -> Option<Ask> {
    let mut ask = None;
    ui.spacing_mut().item_spacing.x = 4.0;
    let (swatch, _) = ui.allocate_exact_size(vec2(8.0, 14.0), Sense::hover());
    ui.painter().rect_filled(swatch, 2.0, theme::PLOT[index % theme::PLOT.len()]);
    // Room for the buttons at the right.
    let buttons = 4.0 * 26.0;
    let width = (ui.available_width() - buttons - 4.0).clamp(60.0, 150.0);
    let method = egui::ComboBox::from_id_salt(("method", index))
        .selected_text(pane.shadow.method.label())
        .width(width)
        .height(320.0)
        .truncate()
        .show_ui(ui, |ui| {
            for &method in ShadowMethod::ALL {
                ui.selectable_value(&mut pane.shadow.method, method, method.label())
                    .on_hover_text(method.description());
            }
        })
        .response;
    method.widget_info(|| {
        let name = format!("Method of pane {}", index + 1);
        egui::WidgetInfo::labeled(egui::Role::ComboBox, true, name)
    });
    let said = label::rest(pane);
    let room = ui.available_width() - buttons;
    let text = RichText::new(&said).small().color(theme::QUIET);
    ui.allocate_ui_with_layout(
        vec2(room.max(0.0), 20.0),
        egui::Layout::left_to_right(egui::Align::Center),
        |ui| {
            ui.set_min_width(room.max(0.0));
            if room > 40.0 {
                ui.add(egui::Label::new(text).truncate()).on_hover_text(&said);
            }
        },
    );
    settings(ui, index, pane);
    let mut button = |ui: &mut Ui, icon, name: &str, tip: &str, enabled, what| {
        let button = egui::Button::new(icon).frame(false).min_size(Vec2::splat(20.0));
        let response = ui.add_enabled(enabled, button).on_hover_text(tip);
        let name = format!("{name} {}", index + 1);
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, enabled, &name));
        if response.clicked() {
            ask = Some(what);
        }
    };
    let swap = "Changes places with the pane to the right.";
    button(ui, icons::ICON_SWAP_HORIZ, "Swap pane", swap, index + 1 < panes, Ask::Swap(index));
    let take = "Draws the project this way from now on.";
    button(ui, icons::ICON_CHECK, "Use pane", take, true, Ask::Use(index));
    button(ui, icons::ICON_CLOSE, "Remove pane", "Removes this pane.", panes > 1, Ask::Remove(index));
    ask
}

/// The button that opens all settings of a pane.
fn settings(ui: &mut Ui, index: usize, pane: &mut Contender) {
    let button = egui::Button::new(icons::ICON_TUNE).frame(false).min_size(Vec2::splat(20.0));
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let (response, _) = MenuButton::from_button(button).config(config).ui(ui, |ui| {
        ui.set_width(300.0);
        all_settings(ui, pane);
    });
    let response =
        response.on_hover_text("Transparency, backend, resolution and all settings of the method.");
    let name = format!("Settings of pane {}", index + 1);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
}

/// All settings of a pane.
pub(super) fn all_settings(ui: &mut Ui, pane: &mut Contender) {
    ui.label(RichText::new(pane.shadow.method.label()).strong());
    note(ui, pane.shadow.method.description());
    let modes = Transparency::ALL.map(|mode| (mode, mode.label()));
    choice(
        ui,
        "Transparency",
        "How overlapping strands are put together in this pane.",
        &mut pane.transparency,
        PictureSettings::default().transparency,
        &modes,
    );
    let backends = Backend::ALL.map(|backend| (backend, backend.label()));
    choice(
        ui,
        "Backend",
        "What draws this pane: a time on the processor and one on a graphics card do not compare.",
        &mut pane.backend,
        Backend::default(),
        &backends,
    );
    Number::new("Pixels", 0.1..=1.0, "Pixels that are drawn along each edge for one of the pane.")
        .percent()
        .show(ui, &mut pane.scale, 1.0);
    panels::shadow::of_method(ui, &mut pane.shadow, &ShadowSettings::default());
}
