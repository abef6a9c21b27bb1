//! The picture of the surroundings in the panel of the lights.

use std::f32::consts::{FRAC_PI_2, PI};

use egui::accesskit::Role;
use egui::vec2;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use glam::Vec3;
use lovelock_project::Project;

use super::{Bench, panel};
use crate::window::command::Command;
use crate::window::purpose::Purpose;
use crate::window::testing::{Shown, control, double_click, drag, tooltip_at};

const KEY: &str = "Key light from the surroundings";
const THUMBNAIL: &str = "Picture of the surroundings";

fn lit() -> Project {
    let mut project = Project::default();
    project.set_surroundings_file("/skies/dusk.hdr");
    project
}

#[test]
fn a_picture_is_requested_named_and_removed() {
    let mut harness = panel("Light", lit());
    assert!(
        harness.query_by_label("dusk.hdr").is_some() && harness.query_by_label_contains("3 pixels").is_some()
    );
    control(&harness, Role::Button, "Picture file…").click();
    harness.run();
    assert_eq!(harness.state().state.asked, [Command::PickFile(Purpose::Surroundings)]);
    control(&harness, Role::Button, "Remove picture").click();
    harness.run();
    assert_eq!(harness.state().state.project, Project::default());
    for gone in ["Remove picture", KEY, THUMBNAIL, "3 pixels"] {
        assert!(harness.query_by_label_contains(gone).is_none(), "{gone} is about the picture");
    }
    assert!(harness.query_by_label("Sky and ground").is_some());
}

#[test]
fn a_drag_across_the_thumbnail_is_a_full_turn() {
    let turn = |harness: &Harness<'_, Shown<Bench>>| harness.state().state.project.picture.surroundings_turn;
    let mut harness = panel("Light", lit());
    let rect = control(&harness, Role::Slider, THUMBNAIL).rect();
    drag(&mut harness, rect.center(), rect.center() + vec2(0.25 * rect.width(), 0.0));
    assert!((turn(&harness) + FRAC_PI_2).abs() < 0.05, "{}", turn(&harness));
    drag(&mut harness, rect.center(), rect.center() - vec2(0.75 * rect.width(), 0.0));
    assert!((turn(&harness).abs() - PI).abs() < 0.05, "it goes on at the other end: {}", turn(&harness));
    double_click(&mut harness, rect.center());
    assert_eq!(turn(&harness), 0.0);
}

#[test]
fn the_first_light_becomes_the_strongest_of_the_picture() {
    let mut project = lit();
    project.picture.surroundings_turn = FRAC_PI_2;
    let mut harness = panel("Light", project.clone());
    control(&harness, Role::Button, KEY).click();
    harness.run();
    let key = &harness.state().state.project.lights[0];
    // The lamp at +X is turned to -Z and shines toward +Z.
    assert!(key.direction.distance(Vec3::Z) < 0.3, "{}", key.direction);
    assert!(key.color.x > key.color.y && key.color.y > key.color.z, "warm: {}", key.color);
    assert_eq!(key.intensity, project.lights[0].intensity, "its strength stays");

    project.lights.clear();
    let mut harness = panel("Light", project);
    let node = control(&harness, Role::Button, KEY);
    let (off, at) = (node.accesskit_node().is_disabled(), node.rect().center());
    assert!(off && tooltip_at(&mut harness, at).is_some_and(|said| said.contains("no light")));
}
