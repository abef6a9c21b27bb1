//! The wall of variants in the whole window.

use std::sync::Arc;

use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use lovelock_session::wall::Wall;

use super::control;
use super::whole::{CTRL, Whole, go, key, of, press_button, project, wait, window};

/// The window with the variants, of which not all are drawn yet.
fn wall() -> Whole {
    let mut harness = window();
    key(&mut harness, Modifiers::NONE, Key::N);
    wait(&mut harness, "the variants", |window| window.pages.wall.variants().len() == Wall::CELLS);
    harness
}

fn click_with(harness: &mut Whole, name: &str, modifiers: Modifiers) {
    let at = control(harness, Role::Button, name).rect().center();
    harness.hover_at(at);
    harness.event_modifiers(egui::Event::PointerMoved(at), modifiers);
    for pressed in [true, false] {
        harness.event_modifiers(
            egui::Event::PointerButton { pos: at, button: egui::PointerButton::Primary, pressed, modifiers },
            modifiers,
        );
    }
    go(harness);
}

#[test]
fn a_click_adopts_a_variant_in_one_undo_step() {
    let mut harness = wall();
    let (before, variant) = (project(&harness), Arc::clone(&of(&harness).pages.wall.variants()[2]));
    assert_eq!(of(&harness).pages.wall.variants().len(), Wall::CELLS);
    assert_ne!(variant.hair, before.hair);
    click_with(&mut harness, "Variant 3", Modifiers::NONE);
    let adopted = project(&harness);
    assert_eq!((&adopted.hair, adopted.look), (&variant.hair, variant.look));
    assert_eq!((adopted.camera, &adopted.lights), (before.camera, &before.lights));
    assert_eq!(of(&harness).document.history().undo_len(), 1);
    assert_eq!(
        of(&harness).pages.wall.variants()[4].hair,
        adopted.hair,
        "the present style is in the middle"
    );
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(project(&harness).hair, before.hair);
    // The present style itself changes nothing.
    click_with(&mut harness, "Present style", Modifiers::NONE);
    assert_eq!(of(&harness).document.history().undo_len(), 0);
}

#[test]
fn shift_and_two_clicks_breed_in_one_undo_step() {
    let mut harness = wall();
    let before = project(&harness);
    let parents = [0, 8].map(|index| Arc::clone(&of(&harness).pages.wall.variants()[index]));
    click_with(&mut harness, "Variant 1", Modifiers::SHIFT);
    assert_eq!(of(&harness).document.history().undo_len(), 0);
    assert_eq!(project(&harness).hair, before.hair);
    click_with(&mut harness, "Variant 9", Modifiers::SHIFT);
    let child = project(&harness);
    assert_eq!(of(&harness).document.history().undo_len(), 1);
    let between = |f: &dyn Fn(&lovelock_project::Project) -> f32| {
        let [a, b] = [f(&parents[0]), f(&parents[1])];
        let child = f(&child);
        assert!(child >= a.min(b) - 1e-6 && child <= a.max(b) + 1e-6, "{a} {b} {child}");
    };
    between(&|project| project.hair.groom.length);
    between(&|project| project.hair.groom.volume);
    between(&|project| project.look.eumelanin);
    assert!(parents.iter().all(|parent| parent.hair != child.hair), "a child is neither");
}

#[test]
fn locks_hold_and_other_variants_come() {
    let mut harness = wall();
    let look = project(&harness).look;
    let first = of(&harness).pages.wall.variants().to_vec();
    assert!(first.iter().any(|variant| variant.look != look));
    control(&harness, Role::CheckBox, "Lock Colour").click();
    go(&mut harness);
    assert!(of(&harness).pages.wall.variants().iter().all(|variant| variant.look == look));
    press_button(&mut harness, "Variants before");
    control(&harness, Role::CheckBox, "Lock Colour").click();
    go(&mut harness);
    assert_eq!(of(&harness).document.history().undo_len(), 0, "looking changes nothing");
    key(&mut harness, Modifiers::NONE, Key::N);
    assert!(harness.query_by_role_and_label(Role::Image, "Viewport").is_some());
}
