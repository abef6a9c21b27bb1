//! The menu of a panel's header, and the menu with the places of all panels.

use egui::{Button, Ui, WidgetInfo};
use egui_material_icons::MaterialIcon;
use egui_material_icons::icons::{
    ICON_DOCK_TO_LEFT, ICON_DOCK_TO_RIGHT, ICON_OPEN_IN_NEW, ICON_PICTURE_IN_PICTURE,
};

use super::Arrangement;
use super::{Move, Place, Spot};
use crate::window::control::HoverTooltip;
use crate::window::shelf::{Columns, Side};

/// The places to choose from.
const PLACES: [(Spot, &str, &str, MaterialIcon); 4] = [
    (
        Spot::Column(Side::Left),
        "Left column",
        "Shows the panel in the column to the left of the image.",
        ICON_DOCK_TO_RIGHT,
    ),
    (
        Spot::Column(Side::Right),
        "Right column",
        "Shows the panel in the column to the right of the image.",
        ICON_DOCK_TO_LEFT,
    ),
    (
        Spot::Floating,
        "Floating",
        "Shows the panel in a small window over the image.",
        ICON_PICTURE_IN_PICTURE,
    ),
    (
        Spot::Second,
        "Second window",
        "Shows the panel in the second window, for another screen.",
        ICON_OPEN_IN_NEW,
    ),
];

fn place_of(spot: Spot) -> Place {
    match spot {
        Spot::Column(side) => Place::Above(side, None),
        Spot::Floating => Place::Floating(None),
        Spot::Second => Place::Second,
    }
}

/// The menu of a panel. Returns the place that was chosen.
pub(crate) fn menu(ui: &mut Ui, title: &str) -> Option<Place> {
    ui.set_min_width(150.0);
    ui.label(egui::RichText::new(title).strong());
    let mut chosen = None;
    for (spot, name, tip, icon) in PLACES {
        if ui.button((icon.rich_text(), name)).hover_tooltip(tip).clicked() {
            chosen = Some(place_of(spot));
        }
    }
    if ui.button("Usual place").hover_tooltip("Shows the panel where it is by default.").clicked() {
        chosen = Some(Place::Usual);
    }
    if chosen.is_some() {
        ui.close();
    }
    chosen
}

/// A row for each panel with a button for each place.
pub(crate) fn places(ui: &mut Ui, arrangement: &Arrangement, usual: &Columns) -> Option<Move> {
    let mut moved = None;
    egui::Grid::new("places of panels").num_columns(5).spacing([6.0, 2.0]).show(ui, |ui| {
        for title in usual.iter().flatten().copied() {
            let now = arrangement.spot(title, usual);
            ui.label(title);
            for (spot, name, tip, icon) in PLACES {
                let on = now == spot;
                let button = ui.add(Button::selectable(on, icon.rich_text()));
                let named = format!("{title}: {name}");
                button.widget_info(|| WidgetInfo::selected(egui::Role::RadioButton, true, on, &named));
                if button.hover_tooltip(format!("{name}. {tip}")).clicked() && !on {
                    moved = Some(Move { title, place: place_of(spot) });
                }
            }
            ui.end_row();
        }
    });
    moved
}
