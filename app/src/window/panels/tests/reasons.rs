//! Tooltips: why a control is disabled, and the symbol of a paper where there is one.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::NodeT;
use lovelock_project::Project;
use lovelock_simulation::{Integrator, RepulsionMode};

use super::one_by_one::choose;
use super::{Bench, panel};
use crate::window::testing::{Shown, click, control, is_on, tooltip_at, type_at};

/// Whether a control is enabled, and its tooltip.
fn state(harness: &mut Harness<'_, Shown<Bench>>, role: Role, name: &str) -> (bool, String) {
    let node = control(harness, role, name);
    let (off, at) = (node.accesskit_node().is_disabled(), node.rect().center());
    (!off, tooltip_at(harness, at).unwrap_or_default())
}

#[test]
fn anisotropy_is_enabled_only_for_pressure() {
    let mut harness = panel("Simulation", Project::default());
    let (live, said) = state(&mut harness, Role::SpinButton, "Anisotropy");
    assert!(live && !said.contains("Only Pressure"), "{said}");
    choose(&mut harness, "Repulsion", "Cell centre");
    assert_eq!(harness.state().state.project.simulation.repulsion.mode, RepulsionMode::Centre);
    let (live, said) = state(&mut harness, Role::SpinButton, "Anisotropy");
    assert!(!live && said.contains("across strands") && said.contains("Only Pressure"), "{said}");
    let before = harness.state().state.project.clone();
    let at = control(&harness, Role::SpinButton, "Anisotropy").rect().center();
    type_at(&mut harness, at, "10");
    assert!(harness.state().state.project == before, "it takes no number");
    let (live, said) = state(&mut harness, Role::SpinButton, "Cohesion");
    assert!(live && !said.contains("Only Pressure"), "the reason is for one control: {said}");
}

#[test]
fn a_shape_replaced_by_the_skin_is_disabled_until_it_is_edited() {
    let mut harness = panel("Colliders", Project::default());
    assert!(state(&mut harness, Role::CheckBox, "Enabled").0);
    choose(&mut harness, "Collider", "skull");
    let (live, said) = state(&mut harness, Role::CheckBox, "Enabled");
    assert!(!live && said.contains("collides with the skin"), "{said}");
    assert!(!is_on(&control(&harness, Role::CheckBox, "Enabled")), "hair does not collide with it");
    let at = control(&harness, Role::CheckBox, "Enabled").rect().center();
    click(&mut harness, at);
    assert!(harness.state().state.project == Project::default());
    let size = control(&harness, Role::SpinButton, "Size").rect().center();
    type_at(&mut harness, size, "120");
    assert!(
        state(&mut harness, Role::CheckBox, "Enabled").0
            && is_on(&control(&harness, Role::CheckBox, "Enabled"))
    );
}

#[test]
fn controls_named_by_the_gauges_exist() {
    let harness = panel("Colliders", Project::default());
    for name in ["Lift", "Size"] {
        control(&harness, Role::SpinButton, name);
    }
}

#[test]
fn controls_name_their_symbols() {
    let mut project = Project::default();
    project.simulation.integrator = Integrator::FollowTheLeader;
    let mut harness = panel("Simulation", project);
    for (name, symbol) in [
        ("Gravity", "g"),
        ("Root stiffness", "√B"),
        ("Tip stiffness", "√B"),
        ("Bend damping", "γ h"),
        ("Wind speed", "w"),
        ("Hair friction", "μ"),
        ("Repulsion strength", "k"),
        ("Density threshold", "τ"),
        ("Anisotropy", "a"),
        ("Velocity damping", "s"),
    ] {
        let (_, said) = state(&mut harness, Role::SpinButton, name);
        assert!(said.contains(&format!("Symbol: {symbol}")), "{name}: {said}");
    }
}
