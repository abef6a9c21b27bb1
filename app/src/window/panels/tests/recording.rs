//! The recording panel.

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;
use lovelock_project::Project;
use lovelock_record::SequenceFormat;

use super::one_by_one::choose;
use super::panel;
use crate::window::command::Command;
use crate::window::purpose::Purpose;
use crate::window::recorder::State;
use crate::window::testing::{control, type_at};

#[test]
fn the_frame_range_is_never_empty() {
    let mut harness = panel("Recording", Project::default());
    let (first, end) = ("First frame", "End frame");
    let place = |harness: &egui_kittest::Harness<'_, _>, name| {
        control(harness, Role::SpinButton, name).rect().center()
    };
    let at = place(&harness, end);
    type_at(&mut harness, at, "20");
    assert_eq!(harness.state().state.project.recording.end_frame, Some(20));
    let at = place(&harness, first);
    type_at(&mut harness, at, "50");
    let recording = &harness.state().state.project.recording;
    assert_eq!((recording.first_frame, recording.end_frame), (50, Some(51)));
    let at = place(&harness, end);
    type_at(&mut harness, at, "3");
    let recording = &harness.state().state.project.recording;
    assert_eq!((recording.first_frame, recording.end_frame), (50, Some(51)));
    choose(&mut harness, "Size", "640 × 360");
    choose(&mut harness, "Frame rate", "60");
    let recording = &harness.state().state.project.recording;
    assert_eq!((recording.width, recording.height, recording.fps), (640, 360, 60.0));
}

#[test]
fn the_panel_offers_the_options_of_the_command_line() {
    let mut harness = panel("Recording", Project::default());
    choose(&mut harness, "File format", "EXR, linear");
    for name in ["Transparent", "Label"] {
        control(&harness, Role::CheckBox, name).click();
        harness.run();
    }
    for (name, typed) in [("Samples per frame", "12"), ("Shutter angle", "270")] {
        let at = control(&harness, Role::SpinButton, name).rect().center();
        type_at(&mut harness, at, typed);
    }
    let recording = &harness.state().state.project.recording;
    assert_eq!(recording.format, SequenceFormat::Exr);
    assert!(recording.transparent && recording.label);
    assert_eq!((recording.subframes, recording.shutter_degrees), (12, 270.0));
}

#[test]
fn a_size_outside_the_list_is_shown() {
    let mut project = Project::default();
    (project.recording.width, project.recording.height, project.recording.fps) = (96, 64, 29.97);
    let harness = panel("Recording", project);
    assert_eq!(control(&harness, Role::ComboBox, "Size").value().as_deref(), Some("96 × 64"));
    assert_eq!(control(&harness, Role::ComboBox, "Frame rate").value().as_deref(), Some("29.97"));
}

#[test]
fn the_buttons_start_and_cancel_and_the_bar_shows_progress() {
    let mut harness = panel("Recording", Project::default());
    for (button, ask) in [
        ("Record film…", Purpose::Film),
        ("Images…", Purpose::Sequence),
        ("Preview…", Purpose::Preview),
        ("Resume…", Purpose::Resume),
    ] {
        harness.get_by_label(button).click();
        harness.run();
        assert_eq!(harness.state().state.asked.last(), Some(&Command::PickFile(ask)));
    }
    let running = State::Running { what: "Frame".to_owned(), done: 12, total: 48, left_secs: Some(30.0) };
    harness.state_mut().state.recording = running;
    // The progress bar animates, so the harness never comes to rest.
    harness.run_steps(3);
    assert!(harness.query_by_label("Record film…").is_none(), "one at a time");
    let bar = harness.get_by_role(Role::ProgressIndicator);
    assert!(format!("{bar:?}").contains("25"), "a quarter is done: {bar:?}");
    harness.get_by_label("Cancel").click();
    harness.run_steps(5);
    assert_eq!(harness.state().state.asked.last(), Some(&Command::Record));
    for (state, text) in [
        (State::Done { what: "48 frames in a b.mp4".to_owned(), out: "a b.mp4".into() }, "48 frames"),
        (State::Failed("out.mp4: the disk is full".to_owned()), "disk is full"),
        (State::Cancelled("Recording cancelled.".to_owned()), "cancelled"),
    ] {
        harness.state_mut().state.recording = state;
        harness.run();
        assert!(harness.query_by_label_contains(text).is_some(), "{text}");
    }
}

#[test]
fn progress_is_described_in_words() {
    let said = |what: &str, done, total, left_secs| {
        let state = State::Running { what: what.to_owned(), done, total, left_secs };
        state.progress().expect("it runs").1
    };
    assert_eq!(said("Loading", 0, 1, None), "Loading", "nothing to count");
    assert_eq!(said("Frame", 12, 48, Some(30.4)), "Frame 12 of 48, 30 s left");
    assert_eq!(said("Frame", 1, 288, Some(340.0)), "Frame 1 of 288, 6 min left");
    assert_eq!(said("Frame", 1, 9000, Some(9000.0)), "Frame 1 of 9000, 2 h 30 min left");
    assert!(said("Frame", 1, 2, Some(f64::INFINITY)).ends_with("left"));
    assert_eq!(State::Cancelled(String::new()).progress(), None);
}
