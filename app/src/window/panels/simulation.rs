//! How hair moves.

use egui::Ui;
use lovelock_studio::TimelineSection;
use lovelock_studio::wisp::{RepulsionMode, SimulationSettings};

use crate::window::control::{Number, choice, count, row, section};

/// The controls of `settings`, and of how long hair lives before an instant that one goes to.
pub(crate) fn ui(ui: &mut Ui, settings: &mut SimulationSettings, preroll_secs: &mut f32) {
    let d = SimulationSettings::default();
    let s = settings;
    Number::new(
        "Stiffness, roots",
        0.0..=60.0,
        "How stiff locks are near the scalp: high values keep the shape of the style, low ones let it swing.",
    )
    .unit(" /s", 1.0)
    .decimals(1)
    .show(ui, &mut s.stiffness_root, d.stiffness_root);
    Number::new(
        "Stiffness, tips",
        0.0..=60.0,
        "How stiff locks are at their ends: low values make tips lag and flick.",
    )
    .unit(" /s", 1.0)
    .decimals(1)
    .show(ui, &mut s.stiffness_tip, d.stiffness_tip);
    Number::new("Bend damping", 0.0..=0.2, "How soon a bent lock stops swaying.")
        .unit(" ms", 1e3)
        .decimals(0)
        .show(ui, &mut s.bend_damping, d.bend_damping);
    Number::new(
        "Hold",
        0.0..=60.0,
        "Pull toward the style as it was drawn, strongest at the roots: like hair spray.",
    )
    .unit(" /s", 1.0)
    .decimals(1)
    .show(ui, &mut s.hold, d.hold);
    Number::new("Settle", 0.0..=20.0, "How soon hair comes to rest on the head after a movement.")
        .unit(" /s", 1.0)
        .decimals(1)
        .show(ui, &mut s.settle, d.settle);
    Number::new(
        "Style support",
        0.0..=1.0,
        "How much of its own weight the style carries at rest: 100 % keeps it as drawn, less lets it sag.",
    )
    .percent()
    .show(ui, &mut s.style_support, d.style_support);
    section(ui, "World", false, |ui| {
        Number::new("Gravity", 0.0..=30.0, "Weight of the hair.").unit(" m/s²", 1.0).show(
            ui,
            &mut s.gravity,
            d.gravity,
        );
        Number::new("Air drag", 0.0..=20.0, "How much the air slows hair, and how much wind takes it along.")
            .unit(" /s", 1.0)
            .decimals(1)
            .show(ui, &mut s.drag, d.drag);
        Number::new("Wind", 0.0..=30.0, "Mean speed of the wind.").unit(" m/s", 1.0).decimals(1).show(
            ui,
            &mut s.wind.speed,
            d.wind.speed,
        );
        let mut angle = s.wind.direction[0].atan2(s.wind.direction[2]);
        let (before, default) = (angle, d.wind.direction[0].atan2(d.wind.direction[2]));
        Number::new(
            "Wind toward",
            -std::f32::consts::PI..=std::f32::consts::PI,
            "Where the wind blows to, about the vertical: 0 is toward the front, 90 to the dancer's left.",
        )
        .degrees()
        .show(ui, &mut angle, default);
        if angle != before {
            s.wind.direction =
                if angle == default { d.wind.direction } else { [angle.sin(), 0.0, angle.cos()] };
        }
        Number::new("Gusts", 0.0..=1.0, "How far gusts raise and lower the wind.").percent().show(
            ui,
            &mut s.wind.gusts,
            d.wind.gusts,
        );
        Number::new("Turbulence", 0.0..=1.0, "Eddies that move neighbouring locks apart.").percent().show(
            ui,
            &mut s.wind.turbulence,
            d.wind.turbulence,
        );
    });
    section(ui, "Body", false, |ui| {
        Number::new("Friction", 0.0..=2.0, "How much hair sticks to skin and cloth.").show(
            ui,
            &mut s.friction,
            d.friction,
        );
        Number::new("Skin margin", 0.0..=0.03, "Distance that hair keeps from the body.").millimetres().show(
            ui,
            &mut s.skin_margin,
            d.skin_margin,
        );
        Number::new(
            "Layering",
            0.0..=1.0,
            "How much of their height over the skull locks keep when they are pressed down.",
        )
        .percent()
        .show(ui, &mut s.layering, d.layering);
    });
    section(ui, "Hair against hair", false, |ui| {
        choice(
            ui,
            "Repulsion",
            "How hair keeps its volume: down the slope of its density, or away from the middle of a cell that is too dense, as published.",
            &mut s.repulsion.mode,
            d.repulsion.mode,
            &[(RepulsionMode::Pressure, "Pressure"), (RepulsionMode::Centre, "Cell centre")],
        );
        Number::new("Strength", 0.0..=1.0, "How hard crowded hair pushes apart: more keeps more volume.")
            .unit(" m²/s²", 1.0)
            .show(ui, &mut s.repulsion.strength, d.repulsion.strength);
        Number::new(
            "Threshold",
            1.0..=10.0,
            "How many times denser than at rest hair may be before it pushes.",
        )
        .unit(" ×", 1.0)
        .decimals(1)
        .show(ui, &mut s.repulsion.threshold, d.repulsion.threshold);
        Number::new("Cohesion", 0.0..=20.0, "How much locks take on the movement of their neighbours.")
            .unit(" /s", 1.0)
            .decimals(1)
            .show(ui, &mut s.repulsion.cohesion, d.repulsion.cohesion);
    });
    count(
        ui,
        "Substeps",
        1..=16,
        "Steps of the solver in a sixtieth of a second; fast heads raise it by themselves.",
        &mut s.substeps,
        d.substeps,
    );
    let default = TimelineSection::default().preroll_secs;
    Number::new(
        "Pre-roll",
        0.0..=TimelineSection::MOST_PREROLL_SECS,
        "How long, at least, hair has lived where you go on the timeline and where a recording starts: long enough to be settled. \
         0 shows the style at rest.",
    )
    .unit(" s", 1.0)
    .decimals(1)
    .show(ui, preroll_secs, default);
    row(ui, "Defaults", "Restores every control of this panel.", false, s, d, |ui, s| {
        let response = ui.button("Restore all");
        if response.clicked() {
            *s = d;
        }
        response
    });
}
