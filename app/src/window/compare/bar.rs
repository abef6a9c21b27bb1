//! The toolbar above the panes: what they show, and actions on all of them.

use egui::{DragValue, RichText, Ui, Vec2};
use egui_material_icons::{MaterialIcon, icons};
use lovelock_panes::view::LiveShows;
use lovelock_project::Project;
use lovelock_project::project::CompareSection;

use super::layout::CompareLayout;
use super::legend::LARGEST;
use crate::window::command::Command;
use crate::window::control::HoverTooltip;
use crate::window::page::Page;
use crate::window::purpose::Purpose;
use crate::window::theme;

/// An action that the toolbar requests.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum ToolbarAction {
    /// Add a pane.
    Add,
    /// Show the whole images again.
    WholePicture,
    /// Run a command.
    Run(Command),
}

/// Shows the toolbar. `magnified` is the magnification of the panes.
pub(super) fn ui(
    ui: &mut Ui,
    layout: &mut CompareLayout,
    project: &mut Project,
    magnified: f32,
) -> Option<ToolbarAction> {
    let mut action = None;
    let panes = project.compare.panes.len();
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = Vec2::new(6.0, 4.0);
        for (wipe, name, tip) in [
            (
                false,
                "Grid",
                "Shows all panes side by side. Hold V to see the second of a pair in place of a pane.",
            ),
            (
                true,
                "Wipe",
                "Shows two panes on one page, divided by a line that can be dragged. Hold V to swap them.",
            ),
        ] {
            if ui.selectable_label(layout.wipe == wipe, name).hover_tooltip(tip).clicked() {
                layout.wipe = wipe;
            }
        }
        if layout.wipe {
            pair(ui, layout, project);
        }
        ui.separator();
        shows(ui, layout);
        ui.separator();
        let mut stops = project.picture.exposure_stops;
        let drag = DragValue::new(&mut stops).range(-6.0..=6.0).speed(0.02).fixed_decimals(2).suffix(" EV");
        let response = ui.add(drag).hover_tooltip("Exposure of all panes, in stops.");
        response
            .widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, true, "Exposure of all panes"));
        if response.changed() {
            project.picture.exposure_stops = stops;
        }
        if magnified > 1.001 {
            let tip = "Shows the whole image again. Ctrl+wheel over a pane magnifies all panes.";
            if ui.button(format!("{magnified:.1}×")).hover_tooltip(tip).clicked() {
                action = Some(ToolbarAction::WholePicture);
            }
        }
        ui.separator();
        toggle(
            ui,
            &mut layout.probe,
            icons::ICON_COLORIZE,
            "Probe",
            "Plots the transmittance along the light ray through the hair that you click.",
        );
        toggle(
            ui,
            &mut layout.costs,
            icons::ICON_QUERY_STATS,
            "Costs",
            "Plots the rendering times of the panes, and their errors against cost.",
        );
        let measures =
            "Measures the error of every pane against the exact method, for the first light that is on. This slows down rendering.";
        toggle(ui, &mut layout.measures, icons::ICON_STRAIGHTEN, "Measure errors", measures);
        ui.separator();
        let mut button =
            |ui: &mut Ui, icon: MaterialIcon, name: &str, tip: &str, enabled: bool, what: ToolbarAction| {
                let response = ui.add_enabled(enabled, egui::Button::new(icon)).hover_tooltip(tip);
                let response = response.disabled_hover_tooltip(FULL);
                response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, enabled, name));
                if response.clicked() {
                    action = Some(what);
                }
            };
        let room = panes < CompareSection::MAX_PANES;
        button(
            ui,
            icons::ICON_ADD,
            "Add pane",
            "Adds a pane: the next method that no pane shows.",
            room,
            ToolbarAction::Add,
        );
        button(
            ui,
            icons::ICON_PHOTO_CAMERA,
            "Save comparison",
            "Saves the panes with their labels as an image (Ctrl+P).",
            true,
            ToolbarAction::Run(Command::PickFile(Purpose::Picture)),
        );
        button(
            ui,
            icons::ICON_VIDEOCAM,
            "Record comparison",
            "Records the dance as a film of all panes (Ctrl+R).",
            true,
            ToolbarAction::Run(Command::Record),
        );
        button(
            ui,
            icons::ICON_SUMMARIZE,
            "Export report",
            "Compares any number of methods and writes a report with errors, times and images.",
            true,
            ToolbarAction::Run(Command::ExportReport),
        );
        let close = ToolbarAction::Run(Command::Show(Page::Compare));
        button(ui, icons::ICON_CLOSE, "Close comparison", "Closes the comparison (C).", true, close);
    });
    action
}

/// Why no pane can be added.
const FULL: &str = "The limit of nine panes is reached. Remove one first, choose another method in the title bar of a pane, \
                    or compare any number of methods in a report (Export report…).";

/// The two panes of the wipe.
fn pair(ui: &mut Ui, layout: &mut CompareLayout, project: &Project) {
    let panes = &project.compare.panes;
    let mut pair = layout.pair_of(panes.len());
    let before = pair;
    for (side, name) in ["Left pane", "Right pane"].into_iter().enumerate() {
        let said = |index: usize| {
            let method = panes.get(index).map_or("", |pane| pane.shadow.method.label());
            format!("{} {method}", index + 1)
        };
        let color = theme::PLOT[pair[side] % theme::PLOT.len()];
        let response = egui::ComboBox::from_id_salt(("pair", side))
            .selected_text(RichText::new(said(pair[side])).color(color))
            .width(132.0)
            .truncate()
            .show_ui(ui, |ui| {
                for index in 0..panes.len() {
                    ui.selectable_value(&mut pair[side], index, said(index));
                }
            })
            .response;
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, name));
        response.hover_tooltip("The pane that the wipe shows on this side.");
    }
    if pair != before {
        layout.pair = pair;
    }
}

/// The quantity that the panes show, and the largest value of its scale.
fn shows(ui: &mut Ui, layout: &mut CompareLayout) {
    let response = egui::ComboBox::from_id_salt("shows")
        .selected_text(layout.shows.label())
        .width(150.0)
        .show_ui(ui, |ui| {
            for shows in LiveShows::ALL {
                ui.selectable_value(&mut layout.shows, shows, shows.label())
                    .hover_tooltip(shows.description());
            }
        })
        .response;
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "What panes show"));
    response.hover_tooltip("The quantity that all panes show.");
    let Some(_) = layout.shows.colors() else { return };
    let response = egui::ComboBox::from_id_salt("largest")
        .selected_text(format!("to {}", layout.largest))
        .width(70.0)
        .show_ui(ui, |ui| {
            for largest in LARGEST {
                ui.selectable_value(&mut layout.largest, largest, format!("to {largest}"));
            }
        })
        .response;
    response
        .widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Largest value of the scale"));
    response.hover_tooltip("The value at the end of the colour scale.");
}

/// A button that stays pressed.
fn toggle(ui: &mut Ui, on: &mut bool, icon: MaterialIcon, name: &str, tip: &str) {
    let response = ui.selectable_label(*on, icon).hover_tooltip(tip);
    response.widget_info(|| egui::WidgetInfo::selected(egui::Role::CheckBox, true, *on, name));
    if response.clicked() {
        *on = !*on;
    }
}
