//! Colour and width of the hair, and the image as a whole.

use egui::Ui;
use lovelock_groom::{HAIR_COLOURS, HairColour, HairLook, HairShading};
use lovelock_project::Project;
use lovelock_project::error::Place;
use lovelock_render::{ClusterShading, HairDrawing, LocalShadow, PictureSettings, StrandCount};

use super::records::RecordView;
use super::swatch::swatch;
use crate::window::command::Command;
use crate::window::control::{section, setting, settings, unless};
use crate::window::panel::Panel;
use crate::window::readings::Readings;

const PIGMENT: [&str; 5] = ["eumelanin", "pheomelanin", "variation", "grey", "tip_lightening"];

const LIGHTENED: [&str; 2] = ["highlights", "highlight_lightening"];

const DYE: [&str; 2] = ["dye_amount", "dye"];

/// What only scattering in fibres uses.
const SCATTERING: [&str; 4] = ["roughness_around", "scale_tilt", "refraction", "many_scattering"];

/// What only the two highlights use; the published model of Kajiya and Kay uses the first.
const HIGHLIGHTS: [&str; 2] = ["primary_strength", "secondary_strength"];

const WIDTH: [&str; 3] = ["width_scale", "diameter", "real_hairs"];

const PICTURE: [&str; 6] =
    ["exposure_stops", "ambient", "transparency", "backend", "simulate", "strand_opacity"];

/// The settings that each pane of a comparison has separately, besides how hair is drawn.
const OF_PANE: [&str; 2] = ["transparency", "backend"];

/// How hair is divided into clusters.
const DIVISION: [&str; 6] = ["layers", "core", "around", "along", "macro_tolerance", "curls"];

/// What only the published lighting of clusters uses.
const PUBLISHED: [&str; 3] = ["diffuse", "primary", "secondary"];

/// Colour and width of the hair.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LookPanel;

impl Panel for LookPanel {
    fn title(&self) -> &'static str {
        "Look"
    }

    fn ui(&mut self, ui: &mut Ui, project: &mut Project, readings: &Readings<'_>) -> Option<Command> {
        let Project { look, picture, hair, .. } = project;
        hair_look(ui, look, &hair.groom.look, picture, readings.pane.is_some());
        None
    }
}

/// The image as a whole.
#[derive(Clone, Default)]
pub(crate) struct PicturePanel {
    /// The shown record of the database of clusters.
    pub(crate) record: RecordView,
}

impl Panel for PicturePanel {
    fn title(&self) -> &'static str {
        "Picture"
    }

    fn places(&self) -> &'static [Place] {
        &[Place::Backdrop, Place::Reference]
    }

    fn ui(&mut self, ui: &mut Ui, project: &mut Project, readings: &Readings<'_>) -> Option<Command> {
        picture(ui, &mut project.picture, readings.pane.is_some());
        let asked = section(ui, "Background", false, |ui| super::background::ui(ui, project)).flatten();
        let reference =
            section(ui, "Reference picture", false, |ui| super::background::reference(ui, project));
        let asked = asked.or(reference.flatten());
        if project.picture.draw != HairDrawing::Strands {
            section(ui, "Record of the database", false, |ui| super::records::ui(ui, &mut self.record));
        }
        asked
    }
}

/// The controls of the hair's look; `default` is that of the style. `picture` has the number of strands. `compares` says that panes are
/// shown.
fn hair_look(
    ui: &mut Ui,
    look: &mut HairLook,
    default: &HairLook,
    picture: &mut PictureSettings,
    compares: bool,
) {
    swatches(ui, look);
    section(ui, "Pigment", true, |ui| settings(ui, &PIGMENT, look, default));
    section(ui, "Lightened locks", false, |ui| settings(ui, &LIGHTENED, look, default));
    section(ui, "Dye", false, |ui| settings(ui, &DYE, look, default));
    section(ui, "Fibre", true, |ui| fibre(ui, look, default));
    section(ui, "Strands", false, |ui| {
        let none = (picture.draw == HairDrawing::Clusters).then_some(NO_STRANDS);
        unless(ui, compares.then_some(STORED_STRANDS).or(none), |ui| strands(ui, picture));
        settings(ui, &WIDTH, look, default);
    });
}

/// The natural colours as swatches. They keep the variation and the lighter tips of `look`.
fn swatches(ui: &mut Ui, look: &mut HairLook) {
    let worn = HairColour::of(look);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::vec2(4.0, 4.0);
        for colour in &HAIR_COLOURS {
            let mut sample = *look;
            colour.apply(&mut sample);
            if swatch(ui, colour.name, &sample, worn == Some(colour)).clicked() {
                *look = sample;
            }
        }
    });
}

fn fibre(ui: &mut Ui, look: &mut HairLook, default: &HairLook) {
    settings(ui, &["shading", "roughness"], look, default);
    match look.shading {
        HairShading::Fibre => settings(ui, &SCATTERING, look, default),
        HairShading::TwoHighlights => settings(ui, &HIGHLIGHTS, look, default),
        HairShading::KajiyaKayPublished => settings(ui, &HIGHLIGHTS[..1], look, default),
    }
}

/// Why the number of strands has no effect.
const NO_STRANDS: &str = "Clusters are drawn instead of strands.";

/// Why the number of strands has no effect on panes.
const STORED_STRANDS: &str =
    "Panes draw the strands that the hairstyle stores, at which errors are measured.";

/// How many strands are drawn.
fn strands(ui: &mut Ui, picture: &mut PictureSettings) {
    let default = PictureSettings::default();
    setting(ui, "strands", picture, &default);
    match picture.strands {
        StrandCount::BySize => drop(setting(ui, "strand_detail", picture, &default)),
        StrandCount::Fixed => drop(setting(ui, "strand_number", picture, &default)),
        StrandCount::Stored => {}
    }
}

/// The controls of the image. `compares` says that a pane is edited, which shares the rest with the others.
fn picture(ui: &mut Ui, picture: &mut PictureSettings, compares: bool) {
    let default = PictureSettings::default();
    setting(ui, "draw", picture, &default);
    if compares {
        settings(ui, &OF_PANE, picture, &default);
        super::shadow::shared(ui);
    }
    if picture.draw == HairDrawing::Auto {
        setting(ui, "cluster_size", picture, &default);
    }
    let own = |name: &&str| !compares || !OF_PANE.contains(name);
    let rest: Vec<&str> = PICTURE.into_iter().filter(own).collect();
    settings(ui, &rest, picture, &default);
    if picture.draw != HairDrawing::Strands {
        section(ui, "Clusters", true, |ui| clusters(ui, picture));
    }
}

/// The controls of hair that is drawn as clusters.
fn clusters(ui: &mut Ui, picture: &mut PictureSettings) {
    let default = PictureSettings::default().clusters;
    let clusters = &mut picture.clusters;
    settings(ui, &DIVISION, clusters, &default);
    settings(ui, &["lookup", "shading"], clusters, &default);
    match clusters.shading {
        ClusterShading::AsStrands => drop(setting(ui, "detail", clusters, &default)),
        ClusterShading::Paper => settings(ui, &PUBLISHED, clusters, &default),
    }
    setting(ui, "local_shadow", clusters, &default);
    if clusters.local_shadow != LocalShadow::Map {
        setting(ui, "shadow_strength", clusters, &default);
    }
    setting(ui, "view", clusters, &default);
}
