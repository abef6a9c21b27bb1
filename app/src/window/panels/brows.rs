//! Brows and lashes.

use egui::Ui;
use lovelock_groom::carried::{BROWS, LOWER_LASHES, UPPER_LASHES};
use lovelock_project::project::{BrowColour, BrowSection};

use crate::window::control::{note, section, settings};
use crate::window::readings::Readings;

/// The controls of brows and lashes.
pub(super) fn ui(ui: &mut Ui, brows: &mut BrowSection, readings: &Readings<'_>) {
    section(ui, "Brows and lashes", false, |ui| {
        let default = BrowSection::default();
        settings(ui, &["brows", "lashes", "length", "thickness", "colour"], brows, &default);
        if brows.colour == BrowColour::Own {
            settings(ui, &["color"], brows, &default);
        }
        settings(ui, &["grey"], brows, &default);
        let masks = readings.frame.map(|frame| &frame.scene.body.mesh.masks);
        let names = [BROWS, UPPER_LASHES, LOWER_LASHES].map(|groom| groom.mask);
        if masks.is_some_and(|masks| !names.iter().any(|name| masks.contains_key(*name))) {
            let names = names.join(", ");
            note(
                ui,
                format!("This body has none. They grow where its file has the vertex attributes {names}."),
            );
        }
    });
}
