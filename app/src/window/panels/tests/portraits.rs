//! What portraits need: light rigs, backgrounds, the lens, the turntable, and the reference picture.

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;
use lovelock_project::Project;
use lovelock_project::project::FocusOn;
use lovelock_render::{BackgroundForm, LightRig};

use super::one_by_one::choose;
use super::panel;
use crate::window::command::Command;
use crate::window::purpose::Purpose;
use crate::window::testing::control;

#[test]
fn a_click_on_a_rig_sets_the_light_and_leaves_the_rest() {
    let mut harness = panel("Light", Project::default());
    for rig in LightRig::ALL {
        harness.get_by_label(rig.label()).click();
        harness.run();
        let project = &harness.state().state.project;
        assert_eq!(LightRig::of(&project.lights, &project.picture), Some(rig));
        let usual = Project::default();
        let mut rest = Project { lights: usual.lights.clone(), ..project.clone() };
        rest.picture = usual.picture;
        assert_eq!(rest, usual, "{rig}");
    }
}

#[test]
fn a_background_picture_is_requested_named_and_removed() {
    let mut harness = panel("Picture", Project::default());
    assert!(harness.query_by_label("Background file…").is_none(), "the control");
    harness.state_mut().state.project.picture.background = BackgroundForm::Picture;
    harness.run();
    control(&harness, Role::Button, "Background file…").click();
    harness.run();
    assert_eq!(harness.state().state.asked, [Command::PickFile(Purpose::Backdrop)]);
    harness.state_mut().state.project.set_backdrop_file("/rooms/loft.jpg");
    harness.run();
    assert!(harness.query_by_label("loft.jpg").is_some());
    control(&harness, Role::Button, "Remove background").click();
    harness.run();
    assert!(harness.state().state.project.surroundings.backdrop.is_none());
}

#[test]
fn the_lens_shows_what_it_uses() {
    let mut project = Project::default();
    project.camera.lens.enabled = true;
    let mut harness = panel("Camera", project);
    assert!(harness.query_by_label("Focus distance").is_none(), "the eyes have a distance of their own");
    choose(&mut harness, "Focus", "Distance");
    assert_eq!(harness.state().state.project.camera.lens.focus, FocusOn::Distance);
    assert!(harness.query_all_by_label("Focus distance").next().is_some());
}

#[test]
fn one_turn_of_the_turntable_is_recorded() {
    let mut project = Project::default();
    (project.camera.turntable, project.camera.turn_secs, project.recording.fps) = (true, 6.0, 25.0);
    project.recording.first_frame = 10;
    let mut harness = panel("Recording", project);
    control(&harness, Role::Button, "Record one turn").click();
    harness.run();
    assert_eq!(harness.state().state.project.recording.end_frame, Some(160));
}
