//! One gesture is one undo step.

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, MouseWheelUnit, TouchPhase, vec2};
use egui_kittest::Harness;
use lovelock_project::Project;
use lovelock_project::document::Document;

use super::Bench;
use crate::window::camera_control;
use crate::window::gesture::Gestures;
use crate::window::testing::{Shown, control, double_click, drag, press, screen};

/// A document and its gestures, as the window holds them.
struct Edited {
    document: Document,
    gestures: Gestures,
    bench: Bench,
}

/// The simulation panel above a viewport, with the window's handling of edits.
fn editor() -> Harness<'static, Shown<Edited>> {
    let state = Edited {
        document: Document::new(Project::default(), None),
        gestures: Gestures::default(),
        bench: Bench::new(Project::default()),
    };
    screen(state, |ui, edited: &mut Edited| {
        if !edited.gestures.continues(ui.ctx(), false) {
            edited.document.end_gesture();
        }
        let project = (**edited.document.project()).clone();
        edited.bench.project = project;
        edited.bench.show(ui, "Simulation");
        let mut project = edited.bench.project.clone();
        let (_, viewport) = ui.allocate_exact_size(vec2(200.0, 200.0), egui::Sense::click_and_drag());
        viewport.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "Viewport"));
        camera_control::apply(&mut project.camera, 0.0, &viewport);
        edited.document.edit("change", project);
    })
}

fn steps(harness: &Harness<'_, Shown<Edited>>) -> usize {
    harness.state().state.document.history().undo_len()
}

#[test]
fn one_drag_is_one_undo_step() {
    let mut harness = editor();
    let before = harness.state().state.document.project().clone();
    let rail = control(&harness, Role::Slider, "Root stiffness").rect();
    drag(&mut harness, rail.left_center(), rail.right_center());
    assert_eq!(steps(&harness), 1);
    let rail = control(&harness, Role::Slider, "Settling").rect();
    drag(&mut harness, rail.right_center(), rail.left_center());
    assert_eq!(steps(&harness), 2, "another drag is another step");
    let document = &mut harness.state_mut().state.document;
    document.undo();
    document.undo();
    assert_eq!(*document.project(), before);
}

#[test]
fn a_pause_during_a_drag_does_not_end_it() {
    let mut harness = editor();
    let rail = control(&harness, Role::Slider, "Root stiffness").rect();
    harness.hover_at(rail.left_center());
    press(&harness, rail.left_center(), true);
    harness.run_steps(40);
    harness.hover_at(rail.center());
    harness.run_steps(40);
    harness.hover_at(rail.right_center());
    press(&harness, rail.right_center(), false);
    harness.run();
    assert_eq!(steps(&harness), 1);
}

#[test]
fn a_typed_number_is_one_undo_step() {
    let mut harness = editor();
    control(&harness, Role::SpinButton, "Settling").click();
    harness.run();
    for letter in ["1", "2", ".", "5"] {
        harness.event(Event::Text(letter.to_owned()));
        harness.run();
    }
    harness.key_press(Key::Enter);
    harness.run();
    assert_eq!(harness.state().state.document.project().simulation.settle, 12.5);
    assert_eq!(steps(&harness), 1);
    control(&harness, Role::SpinButton, "Hold").click();
    harness.run();
    harness.event(Event::Text("7".to_owned()));
    harness.key_press(Key::Enter);
    harness.run();
    assert_eq!(steps(&harness), 2, "another number is another step");
}

#[test]
fn one_turn_of_the_wheel_is_one_undo_step() {
    let mut harness = editor();
    let before = harness.state().state.document.project().camera.distance;
    let at = control(&harness, Role::Image, "Viewport").rect().center();
    harness.hover_at(at);
    harness.run();
    for turn in 1..=2 {
        harness.event(Event::MouseWheel {
            unit: MouseWheelUnit::Line,
            delta: vec2(0.0, 3.0),
            phase: TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers: Modifiers::NONE,
        });
        harness.step();
        harness.run();
        harness.run_steps(20);
        assert_eq!(steps(&harness), turn);
    }
    let after = harness.state().state.document.project().camera.distance;
    assert!(after < before, "{after} is nearer than {before}");
}

#[test]
fn an_orbit_of_the_camera_is_one_undo_step() {
    let mut harness = editor();
    let before = harness.state().state.document.project().camera.azimuth;
    let rect = control(&harness, Role::Image, "Viewport").rect();
    drag(&mut harness, rect.center(), rect.right_center());
    assert_eq!(steps(&harness), 1);
    assert_ne!(harness.state().state.document.project().camera.azimuth, before);
}

#[test]
fn a_double_click_undoes_its_first_click() {
    let mut harness = editor();
    let rail = control(&harness, Role::Slider, "Settling").rect();
    double_click(&mut harness, rail.right_center() - vec2(4.0, 0.0));
    assert_eq!(**harness.state().state.document.project(), Project::default());
    assert_eq!(steps(&harness), 0, "nothing has changed");
    drag(&mut harness, rail.left_center(), rail.right_center());
    harness.run_steps(20);
    double_click(&mut harness, rail.center());
    assert_eq!(**harness.state().state.document.project(), Project::default());
    assert_eq!(steps(&harness), 2, "the drag, and the double-click");
    harness.state_mut().state.document.undo();
    let dragged = harness.state().state.document.project().simulation.settle;
    assert_eq!(dragged, 20.0, "undo goes back to the end of the drag");
}
