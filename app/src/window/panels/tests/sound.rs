//! The sound's panel.

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;
use lovelock_project::Project;
use lovelock_project::project::TimelineSection;

use super::{Bench, panel};
use crate::window::command::Command;
use crate::window::purpose::Purpose;
use crate::window::testing::{Shown, control};

fn heard() -> Project {
    let mut project = Project::default();
    project.set_sound_file("/songs/dance.ogg");
    project
}

#[test]
fn a_sound_is_requested_named_muted_and_removed() {
    let mut harness = panel("Sound", heard());
    for shown in ["dance.ogg", "0:08.0, 120.0 beats per minute"] {
        assert!(harness.query_by_label(shown).is_some(), "{shown}");
    }
    control(&harness, Role::Button, "Sound file…").click();
    harness.run();
    assert_eq!(harness.state().state.asked, [Command::PickFile(Purpose::Sound)]);
    control(&harness, Role::CheckBox, "Mute").click();
    harness.run();
    assert!(harness.state().state.project.sound.muted);
    control(&harness, Role::Button, "Remove sound").click();
    harness.run();
    assert_eq!(harness.state().state.project.sound.file, None);
    assert!(harness.query_by_label("Silence").is_some());
    for gone in ["Remove sound", "Markers at the beats"] {
        assert!(harness.query_by_label(gone).is_none(), "{gone} is about the sound");
    }
}

#[test]
fn beats_become_markers_once() {
    let mut project = heard();
    project.sound.offset_secs = 1.0;
    let mut harness: egui_kittest::Harness<'_, Shown<Bench>> = panel("Sound", project);
    for _ in 0..2 {
        control(&harness, Role::Button, "Markers at the beats").click();
        harness.run();
        let markers = &harness.state().state.project.timeline.markers;
        assert!((13..=15).contains(&markers.len()), "{} beats from 1 s to 8 s", markers.len());
        assert!(
            markers.iter().all(|marker| (marker.secs * 2.0 - (marker.secs * 2.0).round()).abs() < 0.04),
            "{markers:?}"
        );
    }
    assert!(harness.state().state.project.timeline.markers.len() < TimelineSection::MAX_MARKERS);
}
