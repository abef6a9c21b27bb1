//! A record of the database of hair clusters, as a picture.

use std::thread;

use egui::{
    Color32, ColorImage, DragValue, Image, Rect, Slider, TextureHandle, TextureOptions, Ui, pos2, vec2,
};
use lovelock_satf::cache::{ready, shared};
use lovelock_satf::features::features_of;
use lovelock_satf::layout::{ANGLES, SECTORS, TEXELS};
use lovelock_satf::{Curl, Database, Features};

use crate::window::control::HoverTooltip;
use crate::window::control::{Limits, is_escaped, note, row, typed};

/// Height of a row of texels in the picture, points.
const ROW: f32 = 7.0;
/// Width that the slider leaves for its number, points.
const NUMBER_WIDTH: f32 = 78.0;
/// Degrees between two azimuths.
const STEP: f64 = 360.0 / ANGLES as f64;
/// The sector that is shown first: half opaque, with its hair in the middle.
const FIRST: usize = 58;

/// The record that is shown, with its texture.
#[derive(Clone, Default)]
pub(crate) struct RecordView {
    shown: Shown,
    /// The texture and what it shows.
    texture: Option<(Shown, TextureHandle)>,
    /// Whether a thread reads the database or makes it.
    is_asked: bool,
    /// Whether the note on the database was shown, if there is one.
    pub(crate) is_noted: bool,
}

/// A sector and an azimuth of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Shown {
    sector: usize,
    light: usize,
}

impl Default for Shown {
    fn default() -> Self {
        Self { sector: FIRST, light: 0 }
    }
}

/// Shows the record of a sector from all sides, with the choice of sector and light.
pub(super) fn ui(ui: &mut Ui, view: &mut RecordView) {
    let Shown { sector, light } = &mut view.shown;
    let tip = "The sector of the database whose records are shown, 0 to 383.";
    row(ui, "Sector", tip, *sector != FIRST, sector, FIRST, |ui, sector| {
        let limits = Limits::of(ui, "Sector", [0.0, (SECTORS - 1) as f64], ("", 0));
        let drag = DragValue::new(sector).range(0..=SECTORS - 1).update_while_editing(false);
        ui.add(drag.custom_parser(limits.parser()))
    });
    let tip = "The azimuth of the light in the plane of the sector, from the outward normal.";
    row(ui, "Light angle", tip, *light != 0, light, 0, |ui, light| {
        let canceled = is_escaped(ui);
        ui.spacing_mut().slider_width = (ui.available_width() - NUMBER_WIDTH).max(40.0);
        let slider = Slider::new(light, 0..=ANGLES - 1).update_while_editing(false);
        let slider = slider.custom_formatter(|light, _| format!("{}°", light * STEP));
        ui.add(
            slider
                .custom_parser(move |text| typed(text, "°").filter(|_| !canceled).map(|angle| angle / STEP)),
        )
    });
    let Some((database, _)) = ready() else {
        note(ui, "The database is being read.");
        view.ask(ui.ctx());
        return;
    };
    let shown = view.shown;
    let texture = match &view.texture {
        Some((of, texture)) if *of == shown => texture.clone(),
        _ => {
            let image = image_of(database, shown);
            let texture = ui.ctx().load_texture("record", image, TextureOptions::NEAREST);
            view.texture = Some((shown, texture.clone()));
            texture
        }
    };
    let size = vec2(ui.available_width().min(8.0 * TEXELS as f32), ROW * ANGLES as f32);
    for (name, from, tip) in [
        (
            "Opacity",
            0.0,
            "Opacity along the outer arc of the sector; each row is an azimuth of view, the outward normal on top.",
        ),
        ("Reflectance", 0.5, "Light that hair reflects, along the same arc and from the same azimuths."),
    ] {
        note(ui, name);
        let uv = Rect::from_min_max(pos2(0.0, from), pos2(1.0, from + 0.5));
        let image = Image::new((texture.id(), size)).uv(uv).fit_to_exact_size(size).alt_text(name);
        ui.add(image).hover_tooltip(tip);
    }
    note(ui, sentence(&features_of(shown.sector)));
}

impl RecordView {
    /// Reads the database or makes it on a thread of its own, which takes up to half a second.
    fn ask(&mut self, ctx: &egui::Context) {
        if !self.is_asked {
            let ctx = ctx.clone();
            let made = thread::Builder::new().name("hair database".to_owned()).spawn(move || {
                shared();
                ctx.request_repaint();
            });
            self.is_asked = made.is_ok();
        }
    }
}

/// Texels along the arc by azimuths of view: opacities above reflectances.
fn image_of(database: &Database, Shown { sector, light }: Shown) -> ColorImage {
    let opacities = (0..ANGLES).map(|view| &database.opacity_record(sector, view)[..TEXELS]);
    let reflectances = (0..ANGLES).map(|view| &database.reflectance_record(sector, view, light)[..TEXELS]);
    let texels = opacities.chain(reflectances).flatten();
    ColorImage::new([TEXELS, 2 * ANGLES], texels.map(|&value| Color32::from_gray(value)).collect())
}

/// The features of a sector in words.
fn sentence(features: &Features) -> String {
    let Features { optical_depth, s_centroid, t_centroid, curl } = features;
    let curl = match curl {
        Curl::Straight => "straight",
        Curl::Loose => "loosely curled",
        Curl::Tight => "tightly curled",
    };
    format!(
        "This sector represents {curl} hair with an optical depth of {optical_depth:.2} along the radius and centroids at \
         {s_centroid:.2} of the arc and {t_centroid:.2} of the radius."
    )
}

#[cfg(test)]
mod tests {
    use egui::accesskit::Role;
    use egui_kittest::kittest::Queryable as _;

    use super::*;
    use crate::window::testing::{WIDTH, control, screen, type_at};

    #[test]
    fn a_record_is_shown_with_its_features_and_its_texture_is_made_once() {
        let (database, _) = shared();
        let mut harness = screen(RecordView::default(), super::ui);
        harness.run();
        let first = harness.state().state.texture.as_ref().map(|(_, texture)| texture.id());
        assert!(first.is_some());
        harness.run_steps(4);
        let again = harness.state().state.texture.as_ref().map(|(_, texture)| texture.id());
        assert_eq!(first, again, "nothing changed");
        let at = control(&harness, Role::SpinButton, "Sector").rect().center();
        type_at(&mut harness, at, "383");
        let view = &harness.state().state;
        assert_eq!(view.shown.sector, 383);
        assert_ne!(first, view.texture.as_ref().map(|(_, texture)| texture.id()));
        let said = sentence(&features_of(383));
        assert!(said.contains("tightly curled") && said.contains("8.00"), "{said}");
        harness.get_by_label(&said);
        for name in ["Opacity", "Reflectance"] {
            assert!(harness.query_all_by_label(name).next().is_some(), "{name}");
        }
        assert!(harness.state().taken.right() <= WIDTH);
        let image = image_of(database, Shown { sector: 383, light: 0 });
        assert_eq!(image.size, [32, 32]);
        let middle = |row: usize| image.pixels[row * TEXELS + TEXELS / 2].r();
        assert!(middle(0) > 200, "optical depth 8 is opaque: {}", middle(0));
    }

    #[test]
    fn typed_sectors_and_angles_stay_in_range() {
        shared();
        let mut harness = screen(RecordView::default(), super::ui);
        for text in ["1e300", "-5", "nan", "words"] {
            for name in ["Sector", "Light angle"] {
                let at = control(&harness, Role::SpinButton, name).rect().center();
                type_at(&mut harness, at, text);
                let Shown { sector, light } = harness.state().state.shown;
                assert!(sector < SECTORS && light < ANGLES, "{name} from {text}: {sector}, {light}");
            }
        }
        let at = control(&harness, Role::SpinButton, "Light angle").rect().center();
        type_at(&mut harness, at, "90°");
        assert_eq!(harness.state().state.shown.light, 4);
    }
}
