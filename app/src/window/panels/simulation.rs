//! How hair moves.

use egui::Ui;
use glam::Vec3;
use lovelock_project::project::TimelineSection;
use lovelock_simulation::{Integrator, MAX_SWEEPS, RepulsionMode, SimulationSettings, Wind};

use crate::window::control::{Number, choice, count, row, section, unless};
use crate::window::light_sphere::{Sphere, sphere};
use crate::window::ramp::{Ramp, RampValue};

/// The controls of `settings`, which return to `d`, and of how long hair lives before an instant that one goes to. `axes` are the
/// camera's right, up and back.
pub(crate) fn ui(
    ui: &mut Ui,
    settings: &mut SimulationSettings,
    d: SimulationSettings,
    preroll_secs: &mut f32,
    axes: [Vec3; 3],
) {
    shape(ui, settings, &d);
    section(ui, "Weight and air", false, |ui| weight_and_air(ui, settings, &d));
    section(ui, "Wind", false, |ui| wind(ui, &mut settings.wind, &d.wind, axes));
    section(ui, "On the body", false, |ui| on_the_body(ui, settings, &d));
    section(ui, "Hair against hair", false, |ui| hair_against_hair(ui, settings, &d));
    section(ui, "Accuracy", false, |ui| accuracy(ui, settings, &d, preroll_secs));
    row(ui, "Defaults", "Restores every control of this panel.", false, settings, d, |ui, s| {
        let response = ui.button("Restore all");
        if response.clicked() {
            *s = d;
        }
        response
    });
}

/// How stiff locks are, and how they keep their style.
fn shape(ui: &mut Ui, s: &mut SimulationSettings, d: &SimulationSettings) {
    stiffness_ramp(ui, s, d);
    Number::new(
        "Stiffness, roots",
        0.0..=60.0,
        "How stiff locks are near the scalp: high values keep the shape of the style, low ones let it swing. Symbol: √B, of a beam.",
    )
    .unit(" /s", 1.0)
    .decimals(1)
    .show(ui, &mut s.stiffness_root, d.stiffness_root);
    Number::new(
        "Stiffness, tips",
        0.0..=60.0,
        "How stiff locks are at their ends: low values make tips lag and flick. Symbol: √B, of a beam.",
    )
    .unit(" /s", 1.0)
    .decimals(1)
    .show(ui, &mut s.stiffness_tip, d.stiffness_tip);
    Number::new(
        "Bias",
        0.05..=0.95,
        "How much of the way from the roots' stiffness to the tips' is gone at the middle of a lock: 50 % is a straight line.",
    )
    .percent()
    .show(ui, &mut s.stiffness_bias, d.stiffness_bias);
    Number::new("Bend damping", 0.0..=0.2, "How soon a bent lock stops swaying. Symbol: γ h.")
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
    choice(
        ui,
        "Roots",
        "How locks leave the scalp: free to turn, or stiffly as they were drawn for a link or two.",
        &mut s.clamped_links,
        d.clamped_links,
        &[(0, "Hinged"), (1, "As drawn"), (2, "As drawn, firmly")],
    );
}

/// The stiffness from root to tip as a curve.
fn stiffness_ramp(ui: &mut Ui, s: &mut SimulationSettings, d: &SimulationSettings) {
    let of = |s: &SimulationSettings| RampValue {
        root: s.stiffness_root,
        tip: s.stiffness_tip,
        bias: s.stiffness_bias,
    };
    let at = |value: &RampValue, along: f32| {
        let RampValue { root, tip, bias } = *value;
        let ramp = SimulationSettings {
            stiffness_root: root,
            stiffness_tip: tip,
            stiffness_bias: bias,
            ..SimulationSettings::default()
        };
        ramp.stiffness_at(along)
    };
    let ramp = Ramp {
        label: "Stiffness curve",
        hint: "How stiff locks are from their roots to their tips.",
        unit: "/s",
        range: 0.0..=60.0,
        bias: 0.05..=0.95,
        at: &at,
    };
    let before = of(s);
    let mut value = before;
    ramp.show(ui, &mut value, of(d));
    if value != before {
        (s.stiffness_root, s.stiffness_tip, s.stiffness_bias) = (value.root, value.tip, value.bias);
    }
}

fn weight_and_air(ui: &mut Ui, s: &mut SimulationSettings, d: &SimulationSettings) {
    Number::new("Gravity", 0.0..=30.0, "Weight of the hair. Symbol: g.").unit(" m/s²", 1.0).show(
        ui,
        &mut s.gravity,
        d.gravity,
    );
    Number::new(
        "Style support",
        0.0..=1.0,
        "How much of its own weight the style carries at rest: 100 % keeps it as drawn, less lets it sag.",
    )
    .percent()
    .show(ui, &mut s.style_support, d.style_support);
    Number::new("Air drag", 0.0..=20.0, "How much the air slows hair, and how much wind takes it along.")
        .unit(" /s", 1.0)
        .decimals(1)
        .show(ui, &mut s.drag, d.drag);
}

fn wind(ui: &mut Ui, wind: &mut Wind, d: &Wind, axes: [Vec3; 3]) {
    Number::new("Wind", 0.0..=30.0, "Mean speed of the wind. Symbol: w.").unit(" m/s", 1.0).decimals(1).show(
        ui,
        &mut wind.speed,
        d.speed,
    );
    let mut direction = Vec3::from_array(wind.direction);
    let before = direction;
    sphere(ui, Sphere { name: "Wind direction", what: "the wind" }, &mut direction, axes);
    if direction != before {
        wind.direction = direction.to_array();
    }
    let mut angle = wind.direction[0].atan2(wind.direction[2]);
    let (before, default) = (angle, d.direction[0].atan2(d.direction[2]));
    Number::new(
        "Wind toward",
        -std::f32::consts::PI..=std::f32::consts::PI,
        "Where the wind blows to, about the vertical: 0 is toward the front, 90 to the dancer's left.",
    )
    .degrees()
    .show(ui, &mut angle, default);
    if angle != before {
        let [x, y, z] = wind.direction;
        // As steeply as before.
        let level = x.hypot(z).max(1e-3);
        wind.direction =
            if angle == default { d.direction } else { [level * angle.sin(), y, level * angle.cos()] };
    }
    Number::new("Gusts", 0.0..=1.0, "How far gusts raise and lower the wind.").percent().show(
        ui,
        &mut wind.gusts,
        d.gusts,
    );
    Number::new("Turbulence", 0.0..=1.0, "Eddies that move neighbouring locks apart.").percent().show(
        ui,
        &mut wind.turbulence,
        d.turbulence,
    );
    Number::new("Sheltering", 0.0..=1.0, "How much of the wind the body keeps from the hair behind it.")
        .percent()
        .show(ui, &mut wind.sheltering, d.sheltering);
    count(
        ui,
        "Which wind",
        0..=999,
        "Another number is another wind of the same kind.",
        &mut wind.seed,
        d.seed,
    );
}

fn on_the_body(ui: &mut Ui, s: &mut SimulationSettings, d: &SimulationSettings) {
    Number::new("Friction", 0.0..=2.0, "How much hair sticks to skin and cloth. Symbol: μ, Coulomb's.").show(
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
}

fn hair_against_hair(ui: &mut Ui, s: &mut SimulationSettings, d: &SimulationSettings) {
    choice(
        ui,
        "Repulsion",
        "How hair keeps its volume: down the slope of its density, or away from the middle of a cell that is too dense, as published.",
        &mut s.repulsion.mode,
        d.repulsion.mode,
        &[(RepulsionMode::Pressure, "Pressure"), (RepulsionMode::Centre, "Cell centre")],
    );
    Number::new(
        "Strength",
        0.0..=1.0,
        "How hard crowded hair pushes apart: more keeps more volume. Symbol: k.",
    )
    .unit(" m²/s²", 1.0)
    .show(ui, &mut s.repulsion.strength, d.repulsion.strength);
    Number::new(
        "Threshold",
        1.0..=10.0,
        "How many times denser than at rest hair may be before it pushes. Symbol: τ.",
    )
    .unit(" ×", 1.0)
    .decimals(1)
    .show(ui, &mut s.repulsion.threshold, d.repulsion.threshold);
    let why_not = (s.repulsion.mode == RepulsionMode::Centre)
        .then_some("Only Pressure knows directions: away from the middle of a cell there are none.");
    unless(ui, why_not, |ui| {
        Number::new(
            "Across",
            0.0..=1.0,
            "How much hair heeds the direction of the hair around it: at 100 % it pushes across strands alone, crossing wisps more \
             than parallel ones, and lets them slide along each other. Symbol: a.",
        )
        .percent()
        .show(ui, &mut s.repulsion.anisotropy, d.repulsion.anisotropy)
    });
    Number::new("Cohesion", 0.0..=20.0, "How much locks take on the movement of their neighbours.")
        .unit(" /s", 1.0)
        .decimals(1)
        .show(ui, &mut s.repulsion.cohesion, d.repulsion.cohesion);
}

fn accuracy(ui: &mut Ui, s: &mut SimulationSettings, d: &SimulationSettings, preroll_secs: &mut f32) {
    choice(
        ui,
        "Method",
        "What keeps locks at their length. Direct: all links at once; locks do not stretch, and more substeps swing more truly. \
         Relaxation, as first published: one link after the other; locks stretch. Follow the leader: each point is laid behind the \
         one before; the quickest, but hair swings differently with every number of substeps, so set that first.",
        &mut s.integrator,
        d.integrator,
        &[
            (Integrator::Direct, "Direct"),
            (Integrator::Relaxation, "Relaxation, as published"),
            (Integrator::FollowTheLeader, "Follow the leader"),
        ],
    );
    match s.integrator {
        Integrator::Direct => {}
        Integrator::Relaxation => {
            count(
                ui,
                "Sweeps",
                1..=MAX_SWEEPS,
                "How often the links are gone through in a substep: more stretch less, and take longer.",
                &mut s.relaxation_sweeps,
                d.relaxation_sweeps,
            );
        }
        Integrator::FollowTheLeader => {
            Number::new(
                "Damping",
                0.0..=1.0,
                "How much of what a point is pulled by its follower its speed takes on: with little, locks gain energy. Symbol: s, s_damping in \
                 Müller, Kim and Chentanez 2012.",
            )
            .percent()
            .show(ui, &mut s.follow_damping, d.follow_damping);
        }
    }
    count(
        ui,
        "Substeps",
        1..=16,
        "Steps of the solver in a sixtieth of a second; fast heads raise it by themselves. Each lasts h.",
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
}
