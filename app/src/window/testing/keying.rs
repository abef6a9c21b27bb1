//! Keys of the timeline at the controls of panels.

use egui::accesskit::Role;
use egui::{Event, Modifiers, OutputCommand, PointerButton, Pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use lovelock_project::Project;

use super::{Shown, click, control, screen};
use crate::window::command::Command;
use crate::window::control::{self, Keying};
use crate::window::panels::Bench;

/// Panels of a project at a time of its timeline, and what was asked for.
struct State {
    bench: Bench,
    secs: f64,
    asked: Vec<Command>,
}

/// The panels of light and shadow and the lengths of the hair, as the window shows them.
fn desk() -> Harness<'static, Shown<State>> {
    desk_of(None)
}

/// The same while the panels edit a pane of a comparison.
fn desk_of(pane: Option<usize>) -> Harness<'static, Shown<State>> {
    let state = State { bench: Bench::new(Project::default()), secs: 1.0, asked: Vec::new() };
    let mut harness = screen(state, move |ui, state: &mut State| {
        let keying = Keying::of(&state.bench.project, state.secs, &std::iter::empty::<&str>());
        control::begin_keying(ui.ctx(), keying);
        if let Some(pane) = pane {
            control::enter_pane(ui.ctx(), pane);
        }
        // As in a section of the window, beside whose rows the diamonds are.
        ui.indent("section", |ui| {
            for title in ["Light", "Shadow"] {
                state.bench.show(ui, title);
            }
            let hair = &mut state.bench.project.hair;
            let default = hair.shipped_groom();
            control::setting(ui, "length", &mut hair.groom, &default);
        });
        for request in control::end_keying(ui.ctx()) {
            match &request {
                Command::SetKey { target, value } => {
                    state.bench.project.set_key(target, state.secs, value.clone());
                }
                Command::RemoveKey(target) => {
                    state.bench.project.remove_key(target, state.secs);
                }
                _ => {}
            }
            state.asked.push(request);
        }
    });
    harness.run_ok();
    harness
}

fn right_click(harness: &mut Harness<'_, Shown<State>>, at: Pos2) {
    harness.hover_at(at);
    for pressed in [true, false] {
        let (button, modifiers) = (PointerButton::Secondary, Modifiers::NONE);
        harness.event(Event::PointerButton { pos: at, button, pressed, modifiers });
    }
    harness.run_ok();
}

/// Chooses an entry of the menu of a control.
fn choose(harness: &mut Harness<'_, Shown<State>>, (role, name): (Role, &str), entry: &str) {
    let at = control(harness, role, name).rect().center();
    right_click(harness, at);
    control(harness, Role::Button, entry).click();
    harness.run_ok();
}

fn keys(harness: &Harness<'_, Shown<State>>) -> Vec<(String, usize)> {
    let tracks = &harness.state().state.bench.project.timeline.tracks;
    tracks.iter().map(|track| (track.target.clone(), track.keys.len())).collect()
}

#[test]
fn every_kind_of_control_sets_a_key_by_its_menu() {
    let mut harness = desk();
    for (role, name, target, numbers) in [
        (Role::Slider, "Intensity", "lights/0/intensity", 1),
        (Role::CheckBox, "Enabled", "lights/0/enabled", 1),
        (Role::ComboBox, "Method", "shadow/method", 1),
        (Role::Slider, "Azimuth", "lights/0/direction", 3),
    ] {
        choose(&mut harness, (role, name), "Add key");
        let track = harness.state().state.bench.project.timeline.tracks.last().expect("a track");
        assert_eq!((track.target.as_str(), track.keys[0].value.len()), (target, numbers), "{name}");
    }
    choose(&mut harness, (Role::Slider, "Intensity"), "Remove key");
    assert_eq!(keys(&harness).len(), 3, "the last key takes its track along");
    choose(&mut harness, (Role::Slider, "Intensity"), "Record this");
    let target = "lights/0/intensity".to_owned();
    let record = Command::RecordControl { target, label: "Intensity" };
    assert_eq!(harness.state().state.asked.last(), Some(&record));
}

#[test]
fn a_diamond_shows_whether_there_is_a_key_and_sets_or_removes_it() {
    let mut harness = desk();
    let diamond = |harness: &Harness<'_, Shown<State>>, what: &str| {
        harness
            .query_by_role_and_label(Role::Button, &format!("{what} key of Intensity"))
            .map(|node| node.rect())
    };
    assert_eq!(diamond(&harness, "Add"), None, "nothing beside controls without a track");
    let row = control(&harness, Role::Slider, "Intensity").rect();
    harness.hover_at(row.center());
    harness.run_ok();
    let at = diamond(&harness, "Add").expect("a diamond under the pointer").center();
    click(&mut harness, at);
    assert_eq!(keys(&harness), [("lights/0/intensity".to_owned(), 1)]);
    // At another time it is outlined and adds a key.
    harness.state_mut().state.secs = 3.0;
    harness.remove_cursor();
    harness.run_ok();
    let at = diamond(&harness, "Add").expect("it stays").center();
    click(&mut harness, at);
    assert_eq!(keys(&harness)[0].1, 2);
    let at = diamond(&harness, "Remove").expect("a key is here").center();
    click(&mut harness, at);
    assert_eq!(keys(&harness)[0].1, 1);
    harness.check_accessibility();
}

#[test]
fn the_menu_restores_and_copies() {
    let mut harness = desk();
    let copied = |harness: &Harness<'_, Shown<State>>| {
        harness.output().platform_output.commands.iter().find_map(|command| match command {
            OutputCommand::CopyText(text) => Some(text.clone()),
            _ => None,
        })
    };
    let default = harness.state().state.bench.project.lights[0].intensity;
    harness.state_mut().state.bench.project.lights[0].intensity = 3.25;
    harness.run_ok();
    for (entry, text) in [("Copy value", "3.25"), ("Copy setting's name", "lights.0.intensity")] {
        let at = control(&harness, Role::Slider, "Intensity").rect().center();
        right_click(&mut harness, at);
        control(&harness, Role::Button, entry).click();
        harness.step();
        let now = copied(&harness).or_else(|| {
            harness.step();
            copied(&harness)
        });
        assert_eq!(now.as_deref(), Some(text));
        harness.run_ok();
    }
    choose(&mut harness, (Role::Slider, "Intensity"), "Reset");
    assert_eq!(harness.state().state.bench.project.lights[0].intensity.to_bits(), default.to_bits());
}

#[test]
fn settings_that_grow_the_hair_have_no_keys_and_say_why() {
    let mut harness = desk();
    let at = control(&harness, Role::Slider, "Length").rect().center();
    right_click(&mut harness, at);
    let entry = control(&harness, Role::Button, "Add key");
    assert!(entry.accesskit_node().is_disabled());
    let at = entry.rect().center();
    assert!(super::tooltip_at(&mut harness, at).is_some_and(|tip| tip.contains("timeline")));
    let diamond = harness.query_by_role_and_label(Role::Button, "Add key of Length");
    assert!(diamond.is_none());
    control(&harness, Role::Button, "Copy setting's name").click();
    harness.run_ok();
    assert_eq!(keys(&harness), []);
}

#[test]
fn settings_of_a_pane_have_no_keys_and_those_that_all_share_do() {
    let mut harness = desk_of(Some(1));
    let at = control(&harness, Role::ComboBox, "Method").rect().center();
    harness.hover_at(at);
    harness.run_ok();
    assert!(harness.query_by_role_and_label(Role::Button, "Add key of Method").is_none());
    right_click(&mut harness, at);
    assert!(control(&harness, Role::Button, "Add key").accesskit_node().is_disabled());
    control(&harness, Role::Button, "Copy setting's name").click();
    harness.run_ok();
    choose(&mut harness, (Role::Slider, "Intensity"), "Add key");
    assert_eq!(keys(&harness), [("lights/0/intensity".to_owned(), 1)]);
}
