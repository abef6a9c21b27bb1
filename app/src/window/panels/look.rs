//! Colour and width of the hair, and the image as a whole.

use egui::{Color32, Ui};
use lovelock_groom::HairLook;
use lovelock_render::PictureSettings;

use crate::window::control::{row, section, settings};
use crate::window::theme;

/// Natural colours: name, eumelanin, pheomelanin.
const COLORS: [(&str, f32, f32); 6] = [
    ("Black", 8.0, 0.0),
    ("Dark brown", 2.6, 0.1),
    ("Brown", 1.3, 0.1),
    ("Red", 0.25, 0.8),
    ("Blond", 0.3, 0.05),
    ("White", 0.03, 0.0),
];

const HAIR: [&str; 10] = [
    "eumelanin",
    "pheomelanin",
    "variation",
    "tip_lightening",
    "primary_strength",
    "secondary_strength",
    "roughness",
    "width_scale",
    "diameter",
    "real_hairs",
];

const PICTURE: [&str; 5] = ["exposure_stops", "ambient", "transparency", "backend", "strand_opacity"];

const BACKGROUND: [&str; 3] = ["ground", "background_top", "background_bottom"];

/// The controls of the hair's look; `default` is that of the style.
pub(crate) fn hair(ui: &mut Ui, look: &mut HairLook, default: &HairLook) {
    row(ui, "Natural colours", "Sets the melanin of a natural colour.", false, look, *default, |ui, look| {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 3.0;
            for (name, eumelanin, pheomelanin) in COLORS {
                let sample = HairLook { eumelanin, pheomelanin, ..*look };
                let button = egui::Button::new("  ").fill(swatch(&sample));
                let response = ui.add(button).on_hover_text(name);
                response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
                if response.clicked() {
                    (look.eumelanin, look.pheomelanin) = (eumelanin, pheomelanin);
                }
            }
        })
        .response
    });
    settings(ui, &HAIR, look, default);
}

/// The controls of the image.
pub(crate) fn picture(ui: &mut Ui, picture: &mut PictureSettings) {
    let default = PictureSettings::default();
    settings(ui, &PICTURE, picture, &default);
    section(ui, "Background", false, |ui| settings(ui, &BACKGROUND, picture, &default));
}

/// The approximate colour of hair with this look.
fn swatch(look: &HairLook) -> Color32 {
    theme::from_linear((0.7 * HairLook::body_color(look.absorption())).to_array())
}
