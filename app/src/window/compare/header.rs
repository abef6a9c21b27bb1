//! The title bar of a pane: its method, its settings, and its buttons.

use egui::{Rect, RichText, Ui, UiBuilder, pos2, vec2};
use egui_material_icons::{MaterialIcon, icons};
use lovelock_base::settings::Choices;
use lovelock_panes::request::LivePane;
use lovelock_project::Project;
use lovelock_project::project::Contender;
use lovelock_render::ShadowMethod;

use crate::window::control::HoverTooltip;
use crate::window::control::{note, popup, settings as setting_rows};
use crate::window::{panels, theme};

/// Height of a row of the title bar, points.
pub(super) const HEIGHT: f32 = 26.0;

/// Panes that are narrower have a title bar of two rows, points.
const NARROW: f32 = 420.0;

/// Panes that are narrower have the button that swaps them in their settings, points.
const SWAPS: f32 = 250.0;

/// Height of the title bar of a pane of that width, points.
pub(super) fn height(width: f32) -> f32 {
    if width < NARROW { 2.0 * HEIGHT - 4.0 } else { HEIGHT }
}

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
    let is_narrow = line.width() < NARROW;
    let row = |nth: f32| line.top() + 0.5 * HEIGHT + nth * (HEIGHT - 4.0);
    let part = |y: f32, from: f32, to: f32| Rect::from_x_y_ranges(from..=to.max(from), y - 10.0..=y + 10.0);
    let swatch = Rect::from_center_size(pos2(line.left() + 11.0, row(0.0)), vec2(8.0, 14.0));
    ui.painter().rect_filled(swatch, 2.0, theme::PLOT[index % theme::PLOT.len()]);
    // The places of the buttons: settings, swap, use and remove.
    let can_show_swap = line.width() >= SWAPS;
    let end = line.right() - 4.0;
    let place = |from_end: f32, y: f32| part(y, end - from_end * BUTTON, end - (from_end - 1.0) * BUTTON);
    let places = if is_narrow {
        let swap = can_show_swap.then(|| place(2.0, row(1.0)));
        let first = if can_show_swap { 3.0 } else { 2.0 };
        [Some(place(first, row(1.0))), swap, Some(place(1.0, row(1.0))), Some(place(1.0, row(0.0)))]
    } else {
        [4.0, 3.0, 2.0, 1.0].map(|from_end| Some(place(from_end, row(0.0))))
    };
    let left = line.left() + 20.0;
    let width = if is_narrow { end - BUTTON - left - 4.0 } else { end - 4.0 * BUTTON - left - 4.0 };
    let width = width.clamp(50.0, 168.0);
    ui.scope_builder(UiBuilder::new().max_rect(part(row(0.0), left, left + width)), |ui| {
        method(ui, index, pane, width);
    });
    // The adapter, which does not follow from the chosen backend.
    let drawn = drawn.filter(|drawn| drawn.contender == *pane && !drawn.adapter.name.is_empty());
    let said = drawn.map_or_else(|| pane.settings_label(), LivePane::settings_label);
    let tip = drawn.map_or_else(|| said.clone(), |drawn| format!("{said}\n{}", drawn.adapter.name));
    let room = if is_narrow {
        let buttons = if can_show_swap { 3.0 } else { 2.0 };
        part(row(1.0), line.left() + 7.0, end - buttons * BUTTON - 2.0)
    } else {
        part(row(0.0), left + width + 8.0, end - 4.0 * BUTTON - 2.0)
    };
    if room.width() > 36.0 {
        let text = egui::Label::new(RichText::new(&said).small().color(theme::quiet())).truncate();
        ui.scope_builder(
            UiBuilder::new().max_rect(room).layout(egui::Layout::left_to_right(egui::Align::Center)),
            |ui| ui.add(text).hover_tooltip(&tip),
        );
    }
    let can_swap = index + 1 < panes;
    if let Some(place) = places[0] {
        let swaps = ui.scope_builder(UiBuilder::new().max_rect(place), |ui| {
            settings(ui, index, pane, (!can_show_swap).then_some(can_swap))
        });
        action = swaps.inner.then_some(PaneAction::Swap(index));
    }
    let mut button =
        |nth: usize, icon: MaterialIcon, name: &str, tip: &str, enabled: bool, what: PaneAction| {
            let Some(place) = places[nth] else { return };
            let button = egui::Button::new(icon).frame(false);
            let response = ui
                .scope_builder(UiBuilder::new().max_rect(place), |ui| ui.add_enabled(enabled, button))
                .inner;
            let response = response.hover_tooltip(tip).disabled_hover_tooltip(tip);
            let name = format!("{name} {}", index + 1);
            response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, enabled, &name));
            if response.clicked() {
                action = Some(what);
            }
        };
    let swap = "Swaps this pane with the next one.";
    button(1, icons::ICON_SWAP_HORIZ, "Swap pane", swap, can_swap, PaneAction::Swap(index));
    let take = "Uses these settings for the project.";
    button(2, icons::ICON_CHECK, "Use pane", take, true, PaneAction::Use(index));
    let remove = if panes > 1 { "Removes this pane." } else { "Removes this pane. The last one stays." };
    button(3, icons::ICON_CLOSE, "Remove pane", remove, panes > 1, PaneAction::Remove(index));
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
            for method in ShadowMethod::offered() {
                ui.selectable_value(&mut pane.shadow.method, method, method.label())
                    .hover_tooltip(method.description());
            }
        })
        .response;
    response.widget_info(|| {
        let name = format!("Method of pane {}", index + 1);
        egui::WidgetInfo::labeled(egui::Role::ComboBox, true, name)
    });
    // The whole name, where the bar is too short for it.
    response.hover_tooltip(pane.shadow.method.label());
}

/// The button that opens all settings of a pane. `can_swap` adds a button there that swaps it with the next one; returns whether that was
/// clicked.
fn settings(ui: &mut Ui, index: usize, pane: &mut Contender, can_swap: Option<bool>) -> bool {
    let mut swaps = false;
    let button = egui::Button::new(icons::ICON_TUNE).frame(false);
    let response = ui.add(button);
    popup(&response, |ui| {
        ui.set_width(300.0);
        all_settings(ui, pane);
        if let Some(can_swap) = can_swap {
            ui.separator();
            swaps = ui.add_enabled(can_swap, egui::Button::new("Swap with the next pane")).clicked();
        }
    });
    let response = response.hover_tooltip(
        "How hair is drawn, transparency, backend, resolution and all settings of the method.",
    );
    let name = format!("Settings of pane {}", index + 1);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
    swaps
}

/// All settings of a pane.
pub(super) fn all_settings(ui: &mut Ui, pane: &mut Contender) {
    if let Some(take) = pane.take_name() {
        ui.horizontal(|ui| {
            ui.label(format!("Shows the {take}"));
            let tip = "Shows the scene of the other panes instead of the take.";
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

#[cfg(test)]
mod tests {
    use egui::Vec2;
    use egui::accesskit::Role;
    use egui_kittest::kittest::Queryable;
    use lovelock_render::{Backend, Transparency};

    use super::*;
    use crate::window::testing::{choose_in_popup, click_at, control, cut_texts, screen_of};

    /// A pane of that width on a screen that has room for its settings.
    fn bar(
        width: f32,
        method: ShadowMethod,
    ) -> egui_kittest::Harness<'static, crate::window::testing::Shown<Contender>> {
        let mut pane = Contender { backend: Backend::Cpu, ..Contender::default() };
        pane.shadow.method = method;
        screen_of(Vec2::new(800.0, 1000.0), pane, move |ui, pane: &mut Contender| {
            let line = Rect::from_min_size(ui.min_rect().min, vec2(width, height(width)));
            super::ui(ui, line, (0, 6), pane, None);
        })
    }

    #[test]
    fn names_and_settings_fit_where_six_panes_share_a_small_window() {
        // Two columns at 1024 points with both panels open.
        for &method in ShadowMethod::ALL {
            let harness = bar(198.0, method);
            assert_eq!(cut_texts(&harness), [""; 0], "{method}");
        }
        // Negative control: some width is too little.
        assert!(!cut_texts(&bar(90.0, ShadowMethod::DensityClustering)).is_empty());
    }

    #[test]
    fn lists_in_the_settings_of_a_pane_leave_them_open() {
        for width in [198.0, 500.0] {
            let mut harness = bar(width, ShadowMethod::VoxelMap);
            let at = control(&harness, Role::Button, "Settings of pane 1").rect().center();
            click_at(&mut harness, at);
            choose_in_popup(&mut harness, "Transparency", "Exact");
            assert_eq!(harness.state().state.transparency, Transparency::Exact);
            choose_in_popup(&mut harness, "Draw hair as", "Clusters");
            let swaps = harness.query_by_role_and_label(Role::Button, "Swap with the next pane").is_some();
            assert_eq!(swaps, width < SWAPS, "in the bar where there is room");
        }
    }
}
