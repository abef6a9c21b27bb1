//! Showing a panel does not change the project.

use lovelock_base::random::SplitMix64;
use lovelock_project::Project;
use lovelock_project::project::{BodySource, HairSource, MotionSource};
use serde_json::Value;

use super::{Bench, projects, titles};
use crate::window::control::HoverTooltip;
use crate::window::control::section;
use crate::window::testing::{screen, unfold};

/// Any number: near `near`, far from it, tiny or huge, of either sign.
fn number(random: &mut SplitMix64, near: f64) -> f64 {
    match random.bits() % 6 {
        0 => near,
        1 => near * (0.5 + random.unit_f64()),
        2 => random.unit_f64(),
        3 => 20.0 * random.unit_f64() - 10.0,
        4 => 10_f64.powf(12.0 * random.unit_f64() - 6.0),
        _ => -(10_f64.powf(6.0 * random.unit_f64() - 3.0)),
    }
}

/// Replaces all numbers and switches in a tree; names, choices and files stay.
fn shake(value: &mut Value, random: &mut SplitMix64) {
    match value {
        Value::Bool(on) => *on = random.bits().is_multiple_of(2),
        Value::Number(number) if number.is_u64() => {
            *value = Value::from(self::number(random, number.as_f64().unwrap_or(1.0)).abs().min(4e9) as u64);
        }
        Value::Number(number) => {
            *value = Value::from(self::number(random, number.as_f64().unwrap_or(1.0)) as f32);
        }
        Value::Array(items) => items.iter_mut().for_each(|item| shake(item, random)),
        Value::Object(fields) => fields.values_mut().for_each(|field| shake(field, random)),
        Value::Null | Value::String(_) => {}
    }
}

/// A project that a file may contain: any numbers, clamped to their ranges as loading does.
fn random_project(base: &Project, random: &mut SplitMix64) -> Project {
    let mut tree = serde_json::to_value(base).expect("a project is plain data");
    shake(&mut tree, random);
    let mut project: Project = serde_json::from_value(tree).expect("the same shape");
    project.recording.end_frame = random.bits().is_multiple_of(2).then(|| random.bits() % 100_000);
    project.hair.source = if random.bits().is_multiple_of(2) { HairSource::Grown } else { HairSource::File };
    project.body.source = if random.bits().is_multiple_of(2) { BodySource::Dancer } else { BodySource::File };
    project.motion.source =
        [MotionSource::Clip, MotionSource::File, MotionSource::Rest][(random.bits() % 3) as usize];
    project.sanitised().0
}

#[test]
fn showing_a_panel_changes_nothing() {
    let mut random = SplitMix64::new(7);
    let mut shown = projects();
    let plain = shown.len();
    for i in lovelock_testkit::suite::sample(0..48, 6) {
        let base = shown[i % plain].1.clone();
        shown.push(("random", random_project(&base, &mut random)));
    }
    let all = |ui: &mut egui::Ui, bench: &mut Bench| {
        for title in titles() {
            section(ui, title, true, |ui| bench.show(ui, title));
        }
    };
    let mut harness = screen(Bench::new(Project::default()), all);
    harness.set_size(egui::vec2(300.0, 14000.0));
    for (i, (name, project)) in shown.iter().enumerate() {
        assert!(project.sanitised().1.is_empty(), "{name} {i} is no valid project");
        harness.state_mut().state = Bench::new(project.clone());
        harness.run();
        unfold(&mut harness);
        for light in 0..project.lights.len() {
            harness.state_mut().state.panels.light.selected = light;
            harness.run();
        }
        // The clip is as long as the recording.
        harness.state_mut().state.clip_frames = project.recording.end_frame.unwrap_or(1);
        harness.run();
        let (before, after) = (describe(project), describe(&harness.state().state.project));
        assert_eq!(before, after, "{name} {i}");
        assert!(*project == harness.state().state.project, "{name} {i}: a change that text does not show");
    }
}

/// The project as lines of text, so that a failure names the field.
fn describe(project: &Project) -> String {
    serde_json::to_string_pretty(project).expect("a project is plain data")
}

#[test]
fn a_control_that_rounds_is_detected() {
    // A plain slider rounds its value to the digits that it shows.
    let mut harness = screen(0.123_456_f64, |ui, value| {
        let response = ui.add(egui::Slider::new(value, 0.0..=0.1).fixed_decimals(2));
        response.hover_tooltip("plain");
    });
    harness.run();
    assert_ne!(harness.state().state, 0.123_456);
}
