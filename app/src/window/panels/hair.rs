//! The hairstyle: a shipped style and its controls, or a file and how it is placed.

use egui::Ui;
use lovelock_base::settings::Choices;
use lovelock_base::words::counted;
use lovelock_groom::{HAIR_FORMATS, ImportSettings, Unit};
use lovelock_project::Project;
use lovelock_project::error::Place;
use lovelock_project::project::{HairSection, HairSource};

use crate::window::command::Command;
use crate::window::control::HoverTooltip;
use crate::window::control::{choice, entry, note, restore_all, section, setting, settings};
use crate::window::panel::Panel;
use crate::window::purpose::Purpose;
use crate::window::readings::{LoadedHair, Readings};
use crate::window::styles::{self, Browser};

/// The styles, and the controls of the project's hairstyle.
#[derive(Clone, Default)]
pub(crate) struct HairPanel {
    pub(crate) styles: Browser,
}

impl Panel for HairPanel {
    fn title(&self) -> &'static str {
        "Hairstyle"
    }

    fn opens(&self, _project: &Project, _readings: &Readings<'_>) -> bool {
        true
    }

    fn places(&self) -> &'static [Place] {
        &[Place::Hair]
    }

    fn ui(&mut self, ui: &mut Ui, project: &mut Project, readings: &Readings<'_>) -> Option<Command> {
        let asked = styles::ui(ui, project, &mut self.styles);
        source(ui, project, readings.hair).or(asked)
    }
}

/// The unit and the up axis of curves that play in place of the simulation.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CurvesPanel;

impl Panel for CurvesPanel {
    fn title(&self) -> &'static str {
        "Curves"
    }

    fn opens(&self, _project: &Project, _readings: &Readings<'_>) -> bool {
        true
    }

    fn is_shown(&self, project: &Project) -> bool {
        project.plays_curves()
    }

    fn edits_takes(&self, _project: &Project) -> bool {
        true
    }

    fn ui(&mut self, ui: &mut Ui, project: &mut Project, readings: &Readings<'_>) -> Option<Command> {
        let default = ImportSettings::default();
        let import = &mut project.hair.import;
        unit(ui, &mut import.unit, default.unit);
        settings(ui, &["up", "include_hidden"], import, &default);
        for text in readings.take_notes {
            note(ui, text.as_str());
        }
        None
    }
}

/// The controls of the project's hairstyle.
fn source(ui: &mut Ui, project: &mut Project, loaded: &LoadedHair) -> Option<Command> {
    let mut request = None;
    ui.horizontal_wrapped(|ui| {
        let on = project.hair.source == HairSource::File;
        let response = ui.selectable_label(on, "From file…");
        if response.hover_tooltip(file_tooltip()).clicked() {
            if project.hair.file.is_some() && !on {
                project.set_hair_source(HairSource::File);
            } else {
                request = Some(Command::PickFile(Purpose::Open));
            }
        }
    });
    match project.hair.source {
        HairSource::Grown => grown(ui, &mut project.hair),
        HairSource::File => imported(ui, &mut project.hair),
    }
    let [wisps, strands, segments] = loaded.counts;
    let [x, y, z] = loaded.size_m.map(|v| v * 100.0);
    let (wisps, strands) = (counted(wisps, "wisp", "wisps"), counted(strands, "strand", "strands"));
    note(ui, format!("{wisps}, {strands}, {}", counted(segments, "segment", "segments")));
    note(ui, format!("{x:.0} × {y:.0} × {z:.0} cm"));
    for text in &loaded.notes {
        note(ui, text.as_str());
    }
    request
}

const CUT: [&str; 7] =
    ["length", "layering", "length_variation", "face_framing", "fringe", "fringe_length", "taper"];

const SHAPE: [&str; 9] = [
    "part_position",
    "part_strength",
    "sweep",
    "volume",
    "crown_volume",
    "root_lift",
    "hold",
    "ends",
    "hairline",
];

const TEXTURE: [&str; 12] = [
    "clump",
    "locks",
    "curl_radius",
    "curl_pitch",
    "curl_onset",
    "curl_wander",
    "wave",
    "wave_length",
    "frizz",
    "frizz_scale",
    "strays",
    "stray_reach",
];

const COUNTS: [&str; 4] = ["wisps", "strands_per_wisp", "segments_per_strand", "seed"];

fn file_tooltip() -> String {
    let mut labels = HAIR_FORMATS.map(|format| format.label).to_vec();
    // Text and binary files of a format stand beside each other.
    labels.dedup();
    format!("Loads a hair file: {}.", labels.join(", "))
}

/// The titles of the sections of a grown hairstyle, and their settings.
const SECTIONS: [(&str, &[&str]); 4] =
    [("Cut", &CUT), ("Shape", &SHAPE), ("Texture", &TEXTURE), ("Counts", &COUNTS)];

/// The section with a setting of a grown hairstyle.
pub(crate) fn section_of(name: &str) -> Option<&'static str> {
    SECTIONS.iter().find(|(_, names)| names.contains(&name)).map(|(title, _)| *title)
}

fn grown(ui: &mut Ui, hair: &mut HairSection) {
    let default = hair.shipped_groom();
    let groom = &mut hair.groom;
    for (title, names) in SECTIONS {
        section(ui, title, title != "Counts", |ui| settings(ui, names, groom, &default));
    }
    restore_all(ui, "Defaults", "Restores the defaults of this hairstyle.", groom, &default);
}

fn imported(ui: &mut Ui, hair: &mut HairSection) {
    if let Some(file) = &hair.file {
        note(ui, file.path.display().to_string());
    }
    let default = ImportSettings::default();
    let import = &mut hair.import;
    unit(ui, &mut import.unit, default.unit);
    settings(
        ui,
        &["up", "facing", "include_hidden", "fit_scale", "snap_roots", "wisps", "points_per_guide"],
        import,
        &default,
    );
    section(ui, "Placement", false, |ui| {
        settings(ui, &["placement.scale", "placement.turn", "placement.offset_m"], import, &default);
    });
    setting(ui, "seed", import, &default);
}

/// The unit of the file; one that has no name is shown in metres.
fn unit(ui: &mut Ui, unit: &mut Unit, default: Unit) {
    let info = &entry::<ImportSettings>("unit").info;
    let own = if let Unit::Custom(metres) = *unit { format!("{metres} m") } else { String::new() };
    let mut options: Vec<_> = <Unit as Choices>::ALL.iter().map(|unit| (*unit, unit.names().1)).collect();
    if options.iter().all(|(known, _)| known != unit) {
        options.push((*unit, &own));
    }
    choice(ui, info.label, &info.tooltip(), unit, default, &options);
}
