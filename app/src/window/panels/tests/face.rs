//! The weights of the face.

use egui::accesskit::Role;
use egui_kittest::Harness;
use lovelock_project::Project;

use super::{Bench, panel};
use crate::window::testing::{Shown, control, controls, texts, type_at};

#[test]
fn a_weight_is_kept_by_its_name_and_zero_is_none() {
    let mut harness = panel("Face", Project::default());
    let blink = control(&harness, Role::SpinButton, "Blink").rect().center();
    type_at(&mut harness, blink, "50");
    assert_eq!(harness.state().state.project.body.face.of("Blink"), 0.5);
    assert_eq!(harness.state().state.project.body.face.0.len(), 1);
    type_at(&mut harness, blink, "0");
    assert!(harness.state().state.project.body.face.0.is_empty());
}

#[test]
fn many_names_can_be_searched() {
    let mut harness = panel("Face", Project::default());
    harness.state_mut().state.body.face = (0..200).map(|k| format!("shape {k}")).collect();
    harness.run();
    assert!(shows(&harness, "shape 59") && !shows(&harness, "shape 60"));
    assert!(shows(&harness, "140 more: search for them by name."));
    let field = controls(&harness, Role::TextInput)[0].1.center();
    type_at(&mut harness, field, "shape 150");
    assert!(shows(&harness, "shape 150") && !shows(&harness, "shape 151"));
}

fn shows(harness: &Harness<'_, Shown<Bench>>, wanted: &str) -> bool {
    texts(harness).iter().any(|(text, ..)| text == wanted)
}
