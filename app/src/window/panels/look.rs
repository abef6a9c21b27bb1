//! Colour and width of the hair, and the picture as a whole.

use egui::{Color32, Ui};
use glam::Vec3;
use lovelock_groom::HairLook;
use lovelock_render::{Backend, PictureSettings, Transparency};

use crate::window::control::{Number, choice, color, row, section, toggle};
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
    Number::new("Eumelanin", 0.0..=8.0, "The pigment of brown and black hair: more is darker.").show(
        ui,
        &mut look.eumelanin,
        default.eumelanin,
    );
    Number::new("Pheomelanin", 0.0..=8.0, "The pigment of red hair.").show(
        ui,
        &mut look.pheomelanin,
        default.pheomelanin,
    );
    Number::new("Variation", 0.0..=1.0, "How much the colour of strands differs.").percent().show(
        ui,
        &mut look.variation,
        default.variation,
    );
    Number::new("Lighter tips", 0.0..=1.0, "How much lighter hair is at its tips.").percent().show(
        ui,
        &mut look.tip_lightening,
        default.tip_lightening,
    );
    Number::new("First highlight", 0.0..=2.0, "Strength of the highlight in the light's colour.").show(
        ui,
        &mut look.primary_strength,
        default.primary_strength,
    );
    Number::new("Second highlight", 0.0..=2.0, "Strength of the highlight in the hair's colour.").show(
        ui,
        &mut look.secondary_strength,
        default.secondary_strength,
    );
    Number::new(
        "Roughness",
        0.05..=1.0,
        "Width of the highlights: silky hair has narrow ones, dull hair broad ones.",
    )
    .show(ui, &mut look.roughness, default.roughness);
    Number::new(
        "Strand width",
        0.05..=2.0,
        "Width of a drawn strand, as a share of all the hairs that it stands for.",
    )
    .logarithmic()
    .show(ui, &mut look.width_scale, default.width_scale);
    Number::new(
        "Hair diameter",
        17e-6..=100e-6,
        "Thickness of one real hair: thicker hair is denser to light.",
    )
    .unit(" µm", 1e6)
    .decimals(0)
    .show(ui, &mut look.diameter, default.diameter);
    Number::new(
        "Number of hairs",
        10_000.0..=200_000.0,
        "Real hairs that all drawn strands together stand for: more is denser to light.",
    )
    .unit(" k", 1e-3)
    .decimals(0)
    .show(ui, &mut look.real_hairs, default.real_hairs);
}

/// The controls of the picture.
pub(crate) fn picture(ui: &mut Ui, picture: &mut PictureSettings) {
    let d = PictureSettings::default();
    Number::new("Exposure", -6.0..=6.0, "Brightness of the whole picture; one stop doubles the light.")
        .unit(" stops", 1.0)
        .decimals(1)
        .show(ui, &mut picture.exposure_stops, d.exposure_stops);
    Number::new(
        "Ambient light",
        0.0..=4.0,
        "Light from everywhere, which reaches the inside of the hair too.",
    )
    .show(ui, &mut picture.ambient, d.ambient);
    let modes = Transparency::ALL.map(|mode| (mode, mode.label()));
    choice(
        ui,
        "Transparency",
        "How strands that overlap in a pixel are put together: each hiding what is behind it, averaged, weighted by an estimated order, blended segment by segment, or sorted exactly.",
        &mut picture.transparency,
        d.transparency,
        &modes,
    );
    let backends = Backend::ALL.map(|backend| (backend, backend.label()));
    choice(
        ui,
        "Drawn by",
        "What draws the picture: the graphics card, or the processor alone. Automatic takes the card where there is a real one.",
        &mut picture.backend,
        d.backend,
        &backends,
    );
    Number::new("Strand opacity", 0.05..=1.0, "How much a strand hides of what is behind it.")
        .percent()
        .show(ui, &mut picture.strand_opacity, d.strand_opacity);
    section(ui, "Background", false, |ui| {
        toggle(ui, "Ground", "Draws the ground with the dancer's shadow.", &mut picture.ground, d.ground);
        edit(
            ui,
            "Above",
            "Colour of the background at the top.",
            &mut picture.background_top,
            d.background_top,
        );
        edit(
            ui,
            "Below",
            "Colour of the background at the bottom, and of the ground.",
            &mut picture.background_bottom,
            d.background_bottom,
        );
    });
}

fn edit(ui: &mut Ui, label: &'static str, tip: &'static str, value: &mut Vec3, default: Vec3) {
    let mut rgb = value.to_array();
    color(ui, label, tip, &mut rgb, default.to_array());
    *value = Vec3::from_array(rgb);
}

/// About the colour that hair of this look has.
fn swatch(look: &HairLook) -> Color32 {
    theme::from_linear((0.7 * HairLook::body_color(look.absorption())).to_array())
}
