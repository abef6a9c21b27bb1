//! The panel of ties: direction, parting, patch and mirror.

use egui::accesskit::Role;
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use glam::Vec3;
use lovelock_groom::{HairTie, PlainHead, TieReach};
use lovelock_project::Project;
use lovelock_project::project::HairSection;

use super::one_by_one::choose;
use super::{Bench, panel};
use crate::window::panels;
use crate::window::testing::{Shown, control, double_click, is_marked, screen, tooltip_at, type_at};

fn with_ties(ties: &[HairTie]) -> Harness<'static, Shown<Bench>> {
    let mut project = Project::default();
    project.hair.ties = ties.to_vec();
    panel("Ties and scissors", project)
}

fn tie(harness: &Harness<'_, Shown<Bench>>, i: usize) -> HairTie {
    harness.state().state.project.hair.ties[i]
}

fn set(harness: &mut Harness<'_, Shown<Bench>>, name: &str, text: &str) {
    let at = control(harness, Role::SpinButton, name).rect().center();
    type_at(harness, at, text);
}

#[test]
fn heading_and_rise_set_the_direction_of_a_tie() {
    let shipped = HairTie::default();
    let mut harness = with_ties(&[shipped]);
    assert_eq!(control(&harness, Role::SpinButton, "Heading").value().as_deref(), Some("0°"));
    set(&mut harness, "Heading", "90");
    let axis = tie(&harness, 0).axis.normalize_or(Vec3::ZERO);
    let rise = shipped.axis.normalize_or(Vec3::ZERO).y;
    assert!(axis.x > 0.9 && axis.z.abs() < 1e-3, "to the dancer's left: {axis}");
    assert!((axis.y - rise).abs() < 1e-3, "as steep as before: {axis}");
    set(&mut harness, "Rise", "90");
    assert!(tie(&harness, 0).axis.y > 0.999);
    set(&mut harness, "Rise", "-30");
    let axis = tie(&harness, 0).axis;
    assert!((axis.x - 0.866).abs() < 1e-2 && (axis.y + 0.5).abs() < 1e-2, "it keeps its side: {axis}");
    for name in ["Heading", "Rise"] {
        assert!(is_marked(&harness, name), "{name}");
        let at = control(&harness, Role::SpinButton, name).rect().center();
        double_click(&mut harness, at);
        harness.key_press(egui::Key::Escape);
        harness.run();
    }
    assert_eq!(tie(&harness, 0), shipped, "restored, it is the very same");
}

#[test]
fn a_tie_that_was_added_has_its_place_as_its_default() {
    let scalp = PlainHead.scalp(12);
    let state = (HairSection::default(), 0);
    let mut harness = screen(state, move |ui, (hair, selected): &mut (HairSection, usize)| {
        panels::ties::list(ui, hair, selected, Some(&scalp));
    });
    control(&harness, Role::Button, "+ Ponytail").click();
    harness.run();
    let at = |harness: &Harness<'_, Shown<(HairSection, usize)>>| harness.state().state.0.ties[0].at;
    let placed = at(&harness);
    assert_ne!(placed, HairTie::default().at, "not placed on this head");
    assert!(!is_marked(&harness, "Upward"));
    let number = control(&harness, Role::SpinButton, "Upward").rect().center();
    type_at(&mut harness, number, "20");
    assert!(is_marked(&harness, "Upward") && at(&harness) != placed);
    double_click(&mut harness, number);
    harness.key_press(egui::Key::Escape);
    harness.run();
    assert_eq!(at(&harness), placed);
}

#[test]
fn a_parting_selects_one_side() {
    let mut harness = with_ties(&[HairTie::default()]);
    for (entry, normal) in [("Hair on the left", Vec3::X), ("Hair on the right", Vec3::NEG_X)] {
        choose(&mut harness, "Gathered hair", entry);
        assert_eq!((tie(&harness, 0).reach, tie(&harness, 0).plane_normal), (TieReach::AbovePlane, normal));
        assert_eq!(tie(&harness, 0).plane_point.x, 0.0, "in the middle");
    }
    set(&mut harness, "Parting", "3.5");
    assert!((tie(&harness, 0).plane_point.x - 0.035).abs() < 1e-6);
    choose(&mut harness, "Gathered hair", "Hair above a height");
    assert_eq!(tie(&harness, 0).plane_normal, Vec3::Y);
    assert!(harness.query_by_role_and_label(Role::SpinButton, "Height").is_some());
    // A project file may contain any plane: the panel names it and keeps it.
    harness.state_mut().state.project.hair.ties[0].plane_normal = Vec3::new(1.0, 1.0, 0.0);
    harness.run();
    let said = control(&harness, Role::ComboBox, "Gathered hair").value();
    assert_eq!(said.as_deref(), Some("Hair beyond a plane"));
}

#[test]
fn a_patch_follows_its_ring_until_it_has_its_own_centre() {
    let mut harness = with_ties(&[HairTie::default()]);
    choose(&mut harness, "Gathered hair", "Hair in a patch");
    assert!(harness.query_by_role_and_label(Role::SpinButton, "Patch upward").is_none());
    set(&mut harness, "Upward", "10");
    let moved = tie(&harness, 0);
    assert_eq!(moved.sphere_middle(), moved.at, "it goes with the ring");
    control(&harness, Role::CheckBox, "Follow ring").click();
    harness.run();
    assert_eq!(tie(&harness, 0).sphere_middle(), moved.at, "nothing jumps");
    set(&mut harness, "Patch upward", "18");
    set(&mut harness, "Patch sideways", "-4");
    set(&mut harness, "Upward", "14");
    let parted = tie(&harness, 0);
    let middle = parted.sphere_middle();
    assert!((middle - Vec3::new(-0.04, 0.18, moved.at.z)).length() < 1e-6, "{middle}");
}

#[test]
fn mirroring_a_tie_divides_the_hair_between_both() {
    let mut harness = with_ties(&[HairTie::default()]);
    let at = control(&harness, Role::Button, "Mirror").rect().center();
    let said = tooltip_at(&mut harness, at).expect("a reason");
    assert!(said.contains("one side"), "{said}");
    control(&harness, Role::Button, "Mirror").click();
    harness.run();
    assert_eq!(harness.state().state.project.hair.ties.len(), 1, "it is in the middle");
    set(&mut harness, "Sideways", "8");
    set(&mut harness, "Heading", "80");
    control(&harness, Role::Button, "Mirror").click();
    harness.run();
    let (left, right) = (tie(&harness, 0), tie(&harness, 1));
    assert_eq!(right, left.mirrored());
    assert_eq!((left.plane_normal, right.plane_normal), (Vec3::X, Vec3::NEG_X));
    assert!([left, right].iter().all(|tie| tie.reach == TieReach::AbovePlane && tie.plane_point.x == 0.0));
    assert_eq!(harness.state().state.panels.ties.selected, 1, "the new one is chosen");
    let (sanitised, problems) = harness.state().state.project.sanitised();
    assert!(problems.is_empty() && sanitised == harness.state().state.project, "{problems:?}");
    // Mirroring the tie of the other side gives the opposite order.
    let mut harness = with_ties(&[HairTie { at: Vec3::new(-0.08, 0.1, 0.0), ..HairTie::default() }]);
    control(&harness, Role::Button, "Mirror").click();
    harness.run();
    assert_eq!((tie(&harness, 0).plane_normal, tie(&harness, 1).plane_normal), (Vec3::NEG_X, Vec3::X));
}
