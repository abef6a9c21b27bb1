//! The toolbar above the wall: how far variants go, and what stays.

use egui::{RichText, ScrollArea, Ui, Vec2};
use egui_material_icons::icons::{ICON_ARROW_BACK, ICON_CASINO, ICON_CLOSE, ICON_LOCK, ICON_LOCK_OPEN};
use lovelock_project::Project;
use lovelock_project::variants::{Family, Locks, label_of, varied};

use super::WallLayout;
use super::rounds::Rounds;
use crate::window::control::{HoverTooltip, popup};
use crate::window::theme;

/// What the toolbar asks for.
pub(super) enum Action {
    /// Other variants.
    Again,
    /// The variants before.
    Back,
    /// Close the wall.
    Close,
}

/// Shows the toolbar. `ms` is the time of the last round of images.
pub(super) fn ui(
    ui: &mut Ui,
    layout: &mut WallLayout,
    project: &Project,
    rounds: &Rounds,
    ms: Option<f64>,
) -> Option<Action> {
    let mut action = None;
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = Vec2::new(6.0, 4.0);
        let other = ui.button(format!("{} Others", ICON_CASINO.codepoint)).accessible_name("Others");
        if other.hover_tooltip("Shows other variants of the current hairstyle.").clicked() {
            action = Some(Action::Again);
        }
        let back = ui.add_enabled(rounds.has_before(), egui::Button::new(ICON_ARROW_BACK));
        back.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Variants before"));
        if back.hover_tooltip("Returns to the previous variants.").clicked() {
            action = Some(Action::Back);
        }
        ui.separator();
        let mut percent = 100.0 * layout.amount;
        let slider =
            egui::Slider::new(&mut percent, 0.0..=100.0).fixed_decimals(0).suffix(" %").text("Range");
        if ui.add(slider).hover_tooltip("How much variants differ from the current hairstyle.").changed() {
            layout.amount = percent / 100.0;
        }
        ui.separator();
        for family in Family::ALL {
            let locked = layout.locks.families.contains(&family);
            let icon = if locked { ICON_LOCK } else { ICON_LOCK_OPEN };
            let text = format!("{} {}", icon.codepoint, family.label());
            let tip = format!("{} Lock it to keep it the same in all variants.", family.text());
            let response = ui.selectable_label(locked, text).hover_tooltip(tip);
            response.widget_info(|| {
                egui::WidgetInfo::selected(
                    egui::Role::CheckBox,
                    true,
                    locked,
                    format!("Lock {}", family.label()),
                )
            });
            if response.clicked() {
                toggle(&mut layout.locks.families, family);
            }
        }
        let more = ui.button("Keep");
        popup(&more, |ui| single_locks(ui, &mut layout.locks, project));
        more.hover_tooltip("Holds single settings fixed.");
        ui.separator();
        if let Some(ms) = ms {
            let rate =
                RichText::new(format!("{:.1} images/s", 1e3 / ms.max(1.0))).small().color(theme::quiet());
            ui.add(egui::Label::new(rate).extend())
                .hover_tooltip("Rounds of nine images per second, each with its own simulation.");
        }
        let close = ui.button(ICON_CLOSE);
        close.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, "Close the wall"));
        if close.hover_tooltip("Returns to the single image.").clicked() {
            action = Some(Action::Close);
        }
        ui.label(
            RichText::new("Click a variant to adopt it, Shift+click two to make a child of both.")
                .small()
                .color(theme::quiet()),
        );
    });
    action
}

/// Every number that varies, with a checkbox that locks it.
fn single_locks(ui: &mut Ui, locks: &mut Locks, project: &Project) {
    ScrollArea::vertical().max_height(420.0).show(ui, |ui| {
        let mut family_shown = None;
        for (family, entry) in varied(project) {
            if family_shown != Some(family) {
                family_shown = Some(family);
                ui.label(RichText::new(family.label()).strong());
            }
            let whole = locks.families.contains(&family);
            let mut locked = locks.holds(family, &entry.path);
            ui.add_enabled_ui(!whole, |ui| {
                if ui
                    .checkbox(&mut locked, label_of(project, &entry))
                    .hover_tooltip(entry.info.text)
                    .changed()
                {
                    toggle(&mut locks.paths, entry.path);
                }
            });
        }
        if ui.button("Unlock all").clicked() {
            *locks = Locks::default();
        }
    });
}

fn toggle<T: Ord>(set: &mut std::collections::BTreeSet<T>, item: T) {
    if !set.remove(&item) {
        set.insert(item);
    }
}
