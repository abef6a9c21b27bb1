//! How hair moves.

use std::f64::consts::PI;

use egui::Ui;
use glam::Vec3;
use lovelock_base::settings::{Kind, Unit, Value};
use lovelock_project::Project;
use lovelock_project::project::TimelineSection;
use lovelock_simulation::{Integrator, RepulsionMode, SimulationSettings, Wind};

use crate::window::camera_control;
use crate::window::command::Command;
use crate::window::control::{Number, entry, of_setting, restore_all, section, setting, settings, unless};
use crate::window::light_sphere::{Sphere, sphere};
use crate::window::panel::Panel;
use crate::window::ramp::{Ramp, RampValue};
use crate::window::readings::Readings;

/// How hair moves.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SimulationPanel;

impl Panel for SimulationPanel {
    fn title(&self) -> &'static str {
        "Simulation"
    }

    fn opens(&self, _project: &Project, _readings: &Readings<'_>) -> bool {
        true
    }

    fn ui(&mut self, ui: &mut Ui, project: &mut Project, _readings: &Readings<'_>) -> Option<Command> {
        let axes = camera_control::axes(&project.camera);
        let Project { simulation, timeline, hair, .. } = project;
        controls(ui, simulation, &hair.simulation(), timeline, axes);
        None
    }
}

/// The controls of `simulation`, whose defaults are `default`, and of the pre-roll in `timeline`. `axes` are the camera's right, up
/// and back.
fn controls(
    ui: &mut Ui,
    simulation: &mut SimulationSettings,
    default: &SimulationSettings,
    timeline: &mut TimelineSection,
    axes: [Vec3; 3],
) {
    stiffness_ramp(ui, simulation, default);
    settings(
        ui,
        &[
            "stiffness_root",
            "stiffness_tip",
            "stiffness_bias",
            "bend_damping",
            "hold",
            "hold_reach",
            "settle",
            "clamped_links",
        ],
        simulation,
        default,
    );
    section(ui, "Locks", false, |ui| {
        let names = ["cohesion", "cohesion_tip", "friction", "opening"];
        settings(ui, &names, &mut simulation.locks, &default.locks);
    });
    section(ui, "Weight and air", false, |ui| {
        let names = ["weight", "weight_tip", "gravity", "style_support", "drag", "drag_tip", "air_shelter"];
        settings(ui, &names, simulation, default);
    });
    section(ui, "Wind", false, |ui| wind(ui, &mut simulation.wind, &default.wind, axes));
    section(ui, "Body contact", false, |ui| {
        settings(ui, &["friction", "cloth_friction", "skin_margin", "layering"], simulation, default);
    });
    section(ui, "Hair contact", false, |ui| repulsion(ui, simulation, default));
    section(ui, "Accuracy", false, |ui| {
        accuracy(ui, simulation, default);
        setting(ui, "preroll_secs", timeline, &TimelineSection::default());
    });
    restore_all(ui, "Defaults", "Restores the defaults of this panel.", simulation, default);
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
        hint: "How stiff wisps are from their roots to their tips.",
        unit: "/s",
        range: slider_range("stiffness_root"),
        bias: slider_range("stiffness_bias"),
        at: &at,
    };
    let before = of(s);
    let mut value = before;
    ramp.show(ui, &mut value, of(d));
    if value != before {
        (s.stiffness_root, s.stiffness_tip, s.stiffness_bias) = (value.root, value.tip, value.bias);
    }
}

/// The range that the slider of a setting offers.
fn slider_range(name: &str) -> std::ops::RangeInclusive<f32> {
    let [low, high] = match entry::<SimulationSettings>(name).info.kind {
        Kind::Number(range) => range.soft,
        _ => [0.0, 1.0],
    };
    low as f32..=high as f32
}

fn wind(ui: &mut Ui, wind: &mut Wind, default: &Wind, axes: [Vec3; 3]) {
    setting(ui, "speed", wind, default);
    let mut direction = Vec3::from_array(wind.direction);
    let before = direction;
    sphere(ui, Sphere { name: "Wind direction", what: "the wind" }, &mut direction, axes);
    if direction != before {
        wind.direction = direction.to_array();
    }
    let mut angle = wind.direction[0].atan2(wind.direction[2]);
    let (before, default_angle) = (angle, default.direction[0].atan2(default.direction[2]));
    let tip = "Angle about the vertical toward which the wind blows: 0 is toward the front, 90 toward the dancer's left.";
    let info = &entry::<Wind>("direction").info;
    of_setting(ui, &*wind, info, Value::Vector(wind.direction), |ui| {
        Number::new("Wind heading", -PI..=PI, Unit::RADIANS, tip).show(ui, &mut angle, default_angle);
    });
    if angle != before {
        let [x, y, z] = wind.direction;
        // The wind keeps its slope.
        let level = x.hypot(z).max(1e-3);
        wind.direction = if angle == default_angle {
            default.direction
        } else {
            [level * angle.sin(), y, level * angle.cos()]
        };
    }
    settings(ui, &["gusts", "turbulence", "sheltering", "seed"], wind, default);
}

fn repulsion(ui: &mut Ui, simulation: &mut SimulationSettings, default: &SimulationSettings) {
    settings(ui, &["hair_friction", "hair_friction_tip"], simulation, default);
    let (repulsion, default) = (&mut simulation.repulsion, &default.repulsion);
    settings(ui, &["mode", "strength", "threshold"], repulsion, default);
    let why_not = (repulsion.mode == RepulsionMode::Centre).then_some(
        "Only Pressure depends on the direction of hair. The push from the centre of a cell does not.",
    );
    unless(ui, why_not, |ui| setting(ui, "anisotropy", repulsion, default));
    setting(ui, "cohesion", repulsion, default);
}

fn accuracy(ui: &mut Ui, simulation: &mut SimulationSettings, default: &SimulationSettings) {
    setting(ui, "integrator", simulation, default);
    match simulation.integrator {
        Integrator::Direct => {}
        Integrator::Relaxation => {
            setting(ui, "relaxation_sweeps", simulation, default);
        }
        Integrator::FollowTheLeader => {
            setting(ui, "follow_damping", simulation, default);
        }
    }
    setting(ui, "substeps", simulation, default);
}
