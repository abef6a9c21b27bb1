//! The hairstyle: a shipped style and its controls, or a file and how it is placed.

use egui::Ui;
use lovelock_groom::{Facing, GroomSettings, HAIR_FORMATS, ImportSettings, Placement, Preset, Unit, UpAxis};
use lovelock_project::Project;
use lovelock_project::project::{HairSection, HairSource};

use crate::window::control::{Number, choice, count, note, row, section, toggle};

/// What the panel shows of the hairstyle that is loaded.
#[derive(Clone, Debug, Default)]
pub(crate) struct Loaded {
    /// Wisps, strands and segments.
    pub(crate) counts: [usize; 3],
    /// Width, height and depth at rest, metres.
    pub(crate) size_m: [f32; 3],
    /// What the loader said: what was guessed and what was dropped.
    pub(crate) notes: Vec<String>,
}

/// What a panel asks for beyond a change of the project.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Ask {
    /// A dialog that picks a file.
    PickFile,
}

/// The controls of the project's hairstyle.
pub(crate) fn ui(ui: &mut Ui, project: &mut Project, loaded: &Loaded) -> Option<Ask> {
    let mut ask = None;
    ui.horizontal_wrapped(|ui| {
        for preset in Preset::ALL {
            let on = project.hair.source == HairSource::Grown && project.hair.preset == preset;
            let response = ui.selectable_label(on, preset.label());
            if response.on_hover_text("Takes this shipped hairstyle with its colours.").clicked() && !on {
                project.set_preset(preset);
            }
        }
        let on = project.hair.source == HairSource::File;
        let response = ui.selectable_label(on, "From file…");
        if response.on_hover_text(file_tooltip()).clicked() {
            if project.hair.file.is_some() && !on {
                project.set_hair_source(HairSource::File);
            } else {
                ask = Some(Ask::PickFile);
            }
        }
    });
    match project.hair.source {
        HairSource::Grown => grown(ui, &mut project.hair),
        HairSource::File => file(ui, &mut project.hair),
    }
    let [wisps, strands, segments] = loaded.counts;
    let [x, y, z] = loaded.size_m.map(|v| v * 100.0);
    note(ui, format!("{wisps} wisps, {strands} strands, {segments} segments"));
    note(ui, format!("{x:.0} × {y:.0} × {z:.0} cm"));
    for text in &loaded.notes {
        note(ui, text.as_str());
    }
    ask
}

fn file_tooltip() -> String {
    format!("Loads a hair file: {}.", HAIR_FORMATS.map(|format| format.label).join(", "))
}

fn grown(ui: &mut Ui, hair: &mut HairSection) {
    let d = GroomSettings::preset(hair.preset);
    let g = &mut hair.groom;
    section(ui, "Cut", true, |ui| {
        Number::new("Length", 0.02..=0.7, "Length of the longest hair.").centimetres().show(
            ui,
            &mut g.length,
            d.length,
        );
        Number::new(
            "Layers",
            0.0..=1.0,
            "How much shorter the top layers are than the lowest; none cuts all tips at one height.",
        )
        .percent()
        .show(ui, &mut g.layering, d.layering);
        Number::new("Uneven lengths", 0.0..=0.5, "How much shorter than its wisp a strand may end.")
            .percent()
            .show(ui, &mut g.length_variation, d.length_variation);
        Number::new("Face framing", 0.0..=1.0, "How much shorter the hair beside the face is.")
            .percent()
            .show(ui, &mut g.face_framing, d.face_framing);
        Number::new("Fringe", 0.0..=1.0, "How much of the front hair falls over the forehead.")
            .percent()
            .show(ui, &mut g.fringe, d.fringe);
        Number::new("Fringe length", 0.02..=0.3, "Length of the fringe.").centimetres().show(
            ui,
            &mut g.fringe_length,
            d.fringe_length,
        );
        Number::new("Tapered tips", 0.0..=1.0, "Share of each strand over which it thins to its tip.")
            .percent()
            .show(ui, &mut g.taper, d.taper);
    });
    section(ui, "Shape", true, |ui| {
        Number::new(
            "Parting",
            -0.06..=0.06,
            "Where the parting meets the forehead: 0 is the middle, positive the wearer's left.",
        )
        .centimetres()
        .show(ui, &mut g.part_position, d.part_position);
        Number::new("Parted", 0.0..=1.0, "How clean the parting is; none combs the hair back.")
            .percent()
            .show(ui, &mut g.part_strength, d.part_strength);
        Number::new("Sweep", -1.0..=1.0, "How far the front hair is combed back, or toward the face.").show(
            ui,
            &mut g.sweep,
            d.sweep,
        );
        Number::new("Volume", 0.0..=0.06, "Thickness of the hair over the skull.").centimetres().show(
            ui,
            &mut g.volume,
            d.volume,
        );
        Number::new("Crown", 0.0..=0.05, "Height that the hair gains at the crown.").centimetres().show(
            ui,
            &mut g.crown_volume,
            d.crown_volume,
        );
        Number::new("Root lift", 0.1..=1.4, "Angle between the scalp and a hair that leaves it.")
            .degrees()
            .show(ui, &mut g.root_lift, d.root_lift);
        Number::new("Stand", 0.01..=0.5, "How far hair stands before it gives in to gravity.")
            .centimetres()
            .show(ui, &mut g.hold, d.hold);
        Number::new("Ends", -1.0..=1.0, "Bends the ends under (positive) or out (negative).").show(
            ui,
            &mut g.ends,
            d.ends,
        );
        Number::new("Hairline", 0.05..=0.95, "How far back on the forehead hair begins.").show(
            ui,
            &mut g.hairline,
            d.hairline,
        );
    });
    section(ui, "Texture", true, |ui| {
        Number::new(
            "Clumping",
            0.0..=0.95,
            "How much a wisp narrows toward its tip: much for wet or styled hair, little for brushed hair.",
        )
        .percent()
        .show(ui, &mut g.clump, d.clump);
        Number::new("Locks", 0.0..=1.0, "How much strands gather in smaller locks.").percent().show(
            ui,
            &mut g.locks,
            d.locks,
        );
        Number::new("Curl radius", 0.0..=0.02, "Radius of the curls; 0 is straight.").millimetres().show(
            ui,
            &mut g.curl_radius,
            d.curl_radius,
        );
        Number::new(
            "Curl pitch",
            0.006..=0.3,
            "Length of one turn of a curl: coils under 10 mm, curls 10 to 25, waves 20 to 60.",
        )
        .logarithmic()
        .millimetres()
        .show(ui, &mut g.curl_pitch, d.curl_pitch);
        Number::new("Curl onset", 0.0..=0.4, "Distance from the root over which curls reach their radius.")
            .centimetres()
            .show(ui, &mut g.curl_onset, d.curl_onset);
        Number::new("Curl wander", 0.0..=1.0, "How much curls and waves differ along and between strands.")
            .percent()
            .show(ui, &mut g.curl_wander, d.curl_wander);
        Number::new("Wave", 0.0..=0.03, "Height of the waves that swing whole wisps aside.")
            .millimetres()
            .show(ui, &mut g.wave, d.wave);
        Number::new("Wave length", 0.02..=0.4, "Length of one wave.").centimetres().show(
            ui,
            &mut g.wave_length,
            d.wave_length,
        );
        Number::new("Frizz", 0.0..=0.02, "Size of the small bends of each strand.").millimetres().show(
            ui,
            &mut g.frizz,
            d.frizz,
        );
        Number::new("Frizz length", 0.005..=0.2, "Length of those bends.").logarithmic().millimetres().show(
            ui,
            &mut g.frizz_scale,
            d.frizz_scale,
        );
        Number::new("Strays", 0.0..=0.5, "Share of strands that leave their wisp.").percent().show(
            ui,
            &mut g.strays,
            d.strays,
        );
        Number::new("Stray reach", 0.0..=0.06, "How far strays leave it at the tip.").millimetres().show(
            ui,
            &mut g.stray_reach,
            d.stray_reach,
        );
    });
    section(ui, "Numbers", false, |ui| {
        count(
            ui,
            "Wisps",
            8..=1000,
            "Locks that move together; each is three guide strands.",
            &mut g.wisps,
            d.wisps,
        );
        count(
            ui,
            "Strands a wisp",
            1..=400,
            "Strands that are drawn in each wisp: more is finer and slower.",
            &mut g.strands_per_wisp,
            d.strands_per_wisp,
        );
        count(
            ui,
            "Segments a strand",
            2..=200,
            "Pieces of each strand: curls need more than straight hair.",
            &mut g.segments_per_strand,
            d.segments_per_strand,
        );
        count(ui, "Seed", 0..=999, "Chooses among styles that differ by chance alone.", &mut g.seed, d.seed);
    });
    row(ui, "Defaults", "Restores every control of this hairstyle.", false, g, d, |ui, g| {
        let response = ui.button("Restore all");
        if response.clicked() {
            *g = d;
        }
        response
    });
}

fn file(ui: &mut Ui, hair: &mut HairSection) {
    if let Some(file) = &hair.file {
        note(ui, file.path.display().to_string());
    }
    let d = ImportSettings::default();
    let s = &mut hair.import;
    let own = if let Unit::Custom(metres) = s.unit { format!("{metres} m") } else { String::new() };
    let mut units = vec![
        (Unit::Auto, "Guess"),
        (Unit::Metre, "Metres"),
        (Unit::Centimetre, "Centimetres"),
        (Unit::Millimetre, "Millimetres"),
        (Unit::Inch, "Inches"),
        (Unit::Custom(0.00254), "Tenths of an inch"),
    ];
    if units.iter().all(|(known, _)| *known != s.unit) {
        units.push((s.unit, &own));
    }
    choice(ui, "Unit", "What one unit of the file is; hair files do not say.", &mut s.unit, d.unit, &units);
    choice(
        ui,
        "Up",
        "The axis of the file that points up.",
        &mut s.up,
        d.up,
        &[(UpAxis::Auto, "Guess"), (UpAxis::Y, "Y"), (UpAxis::Z, "Z")],
    );
    let facings = [
        (Facing::Auto, "Guess"),
        (Facing::PlusX, "+X"),
        (Facing::MinusX, "-X"),
        (Facing::PlusY, "+Y"),
        (Facing::MinusY, "-Y"),
        (Facing::PlusZ, "+Z"),
        (Facing::MinusZ, "-Z"),
    ];
    choice(
        ui,
        "Face toward",
        "The axis of the file that the face looks along.",
        &mut s.facing,
        d.facing,
        &facings,
    );
    toggle(
        ui,
        "Fit size",
        "Scales the hair so that its roots fit this scalp.",
        &mut s.fit_scale,
        d.fit_scale,
    );
    toggle(
        ui,
        "Roots on skin",
        "Moves each strand as a whole so that its root lies on the skin.",
        &mut s.snap_roots,
        d.snap_roots,
    );
    count(
        ui,
        "Wisps",
        0..=4096,
        "Groups of strands that move together; 0 takes one for every 25 strands.",
        &mut s.wisps,
        d.wisps,
    );
    section(ui, "Placement", false, |ui| {
        let p = &mut s.placement;
        let d = Placement::default();
        Number::new("Scale", Placement::SCALE, "Size after the fit.").logarithmic().show(
            ui,
            &mut p.scale,
            d.scale,
        );
        for (axis, label) in ["Nod", "Shake", "Tilt"].into_iter().enumerate() {
            Number::new(label, Placement::TURN, "Turns the hair about the middle of the scalp.")
                .degrees()
                .show(ui, &mut p.turn[axis], d.turn[axis]);
        }
        for (axis, label) in ["Left", "Up", "Forward"].into_iter().enumerate() {
            Number::new(label, Placement::OFFSET_M, "Moves the hair.").centimetres().show(
                ui,
                &mut p.offset_m[axis],
                d.offset_m[axis],
            );
        }
    });
}
