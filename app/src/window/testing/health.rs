//! The gauges of the simulation, and the buttons that go to their places.

use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;
use lovelock_project::Project;
use lovelock_project::files::Access;
use lovelock_session::health::{Gauge, GaugeKind, HealthLevel, health};
use lovelock_session::scene::SceneLoader;
use lovelock_session::totals::Totals;
use lovelock_simulation::{BodyPart, InsidePoint, SimulationSettings};

use super::tools::into_view;
use super::whole::{Whole, go, of, playing_window, project, wait};
use super::{control, screen, texts, tooltip_at};
use crate::window::{Window, panels};

/// Gauges of hair that penetrates the body by 3 mm and starts deep inside the neck.
fn bad_gauges() -> Vec<Gauge> {
    let (scene, _) = SceneLoader::new().load_now(&small(), &Access::new()).expect("a scene");
    let inside = |depth_m, guide| InsidePoint { depth_m, guide, point: 5, within: BodyPart::Field };
    let deepest = Some(inside(3e-3, 4));
    let totals = Totals { max_penetration_m: 3e-3, deepest, ..Totals::default() };
    health(&totals, Some(inside(0.03, 2)), &scene, &SimulationSettings::default())
}

fn small() -> Project {
    let mut project = Project::default();
    project.hair.groom.wisps = 4;
    project.hair.groom.strands_per_wisp = 3;
    project
}

#[test]
fn gauges_show_advice_and_places() {
    let state = (bad_gauges(), None, Vec::new());
    let mut harness = screen(state, |ui, (gauges, shown, asked): &mut (Vec<Gauge>, _, Vec<_>)| {
        asked.extend(panels::health::list(ui, gauges, false, *shown));
    });
    assert!(harness.query_by_label("Problems:").is_some());
    let said = texts(&harness);
    for words in ["3.0 mm", "30.0 mm", "0.0 J/kg"] {
        assert!(said.iter().any(|(text, ..)| text == words), "{words}");
    }
    let advice: Vec<_> =
        harness.state().state.0.clone().into_iter().filter(|gauge| !gauge.advice.is_empty()).collect();
    assert_eq!(advice.len(), 2);
    for gauge in &advice {
        let color = panels::health::color(gauge.level);
        let told = said.iter().find(|(text, ..)| text.replace('\n', " ") == gauge.advice);
        assert_eq!(told.map(|(.., found)| *found), Some(color), "{}", gauge.advice);
    }
    for kind in GaugeKind::ALL {
        let name = format!("Show: {}", kind.label());
        let at = control(&harness, Role::Button, &name).rect().center();
        assert!(tooltip_at(&mut harness, at).is_some_and(|tip| tip.ends_with('.')), "{name}");
        control(&harness, Role::Button, &name).click();
        harness.run();
    }
    assert_eq!(
        harness.state().state.2,
        [GaugeKind::Penetration, GaugeKind::RestInside],
        "a gauge without a place was chosen"
    );
    harness.state_mut().state.0.retain(|gauge| gauge.level == HealthLevel::Good);
    harness.run();
    assert!(harness.query_by_label("No problems found.").is_some());
    harness.state_mut().state.0.clear();
    harness.run();
    assert!(harness.query_by_label_contains("before the first step").is_some());
}

/// Presses a button that may be below the end of the panel.
fn press_in_view(harness: &mut Whole, name: &str) {
    into_view(harness, Role::Button, name);
    // As a screen reader presses it: advice about other gauges comes and goes meanwhile and moves it.
    control(harness, Role::Button, name).click_accesskit();
    go(harness);
}

#[test]
fn the_button_of_a_gauge_marks_its_place_and_can_be_undone() {
    let mut harness = playing_window();
    wait(&mut harness, "hair that has moved", |window| {
        window.session.frame.as_ref().is_some_and(|frame| frame.totals.worst_stretch_at.is_some())
    });
    let before = project(&harness);
    press_in_view(&mut harness, "Show: Largest stretch");
    let pointed = |window: &Window| window.tools.marked_gauge.as_ref().map(|gauge| gauge.kind);
    assert_eq!(pointed(of(&harness)), Some(GaugeKind::Stretch));
    // The button goes to the time at which the value was found, and the measured value is kept.
    let asked = of(&harness).tools.marked_gauge.clone().expect("a gauge");
    let found = asked.found.expect("found");
    let secs = asked.found_secs().expect("a time");
    wait(&mut harness, "hair settled where it was found", |window| {
        let there = window.session.frame.as_ref().map(|frame| (frame.position_secs - secs).abs());
        window.session.worker().settling().is_none() && there.is_some_and(|off| off < 1e-6)
    });
    assert!(!of(&harness).session.playing);
    let frame = of(&harness).session.frame.clone().expect("a frame");
    assert_eq!(frame.place_of(&asked), Some(found.place));
    let kept = frame.health(&before.simulation).into_iter().find(|gauge| gauge.kind == asked.kind);
    assert!(kept.expect("a gauge").value >= asked.value && asked.value > 0.0);
    assert_ne!(project(&harness).camera, before.camera);
    assert!(project(&harness).camera.distance < before.camera.distance, "it goes nearer");
    assert_eq!(of(&harness).document.history().undo_label(), Some("camera"));
    press_in_view(&mut harness, "Show: Largest stretch");
    assert_eq!((pointed(of(&harness)), of(&harness).document.history().undo_len()), (None, 1));
    go(&mut harness);
}
