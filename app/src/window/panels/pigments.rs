//! Natural colours as swatches, for settings of layers that hold the two pigments of hair.

use egui::Ui;
use lovelock_base::settings::{AnySettings, Value};
use lovelock_groom::{HAIR_COLOURS, HairLook};

use super::swatch::swatch;

/// Settings of the two pigments.
const PIGMENTS: [&str; 2] = ["eumelanin", "pheomelanin"];

/// Swatches of the natural colours, if `settings` has both pigments. A click sets them.
pub(super) fn pigments(ui: &mut Ui, settings: &mut dyn AnySettings) {
    let [Some(eumelanin), Some(pheomelanin)] = PIGMENTS.map(|name| number(settings, name)) else { return };
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::vec2(4.0, 4.0);
        // Grey hair is a share of strands and not a pigment.
        for colour in HAIR_COLOURS.iter().filter(|colour| colour.grey == 0.0) {
            let mut sample = HairLook::default();
            colour.apply(&mut sample);
            let is_worn = (colour.eumelanin, colour.pheomelanin) == (eumelanin as f32, pheomelanin as f32);
            if swatch(ui, colour.name, &sample, is_worn).clicked() {
                settings.assign(PIGMENTS[0], Value::Number(colour.eumelanin.into()));
                settings.assign(PIGMENTS[1], Value::Number(colour.pheomelanin.into()));
            }
        }
    });
}

fn number(settings: &dyn AnySettings, name: &str) -> Option<f64> {
    match settings.value(name)?.1 {
        Value::Number(value) => Some(value),
        _ => None,
    }
}
