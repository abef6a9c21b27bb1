//! The start page and the tour.

use egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;

use super::super::command::Command;
use super::whole::{CTRL, Whole, go, key, of, wait, window};
use crate::window::page::Page;

fn run(harness: &mut Whole, command: Command) {
    let ctx = harness.ctx.clone();
    harness.state_mut().state.as_mut().expect("a window").run(command, &ctx);
    go(harness);
}

#[test]
fn keys_leave_the_start_page() {
    let mut harness = window();
    assert!(!of(&harness).start.is_open(), "a window with a project goes straight to work");
    run(&mut harness, Command::StartPage);
    // The page takes a few frames to find its size.
    harness.run_steps(6);
    assert!(of(&harness).start.is_open());
    assert!(harness.query_by_label_contains("Example: Red curls").is_some());
    harness.check_accessibility();
    key(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(!of(&harness).start.is_open());
    run(&mut harness, Command::StartPage);
    // The page takes a few frames to find its size.
    harness.run_steps(6);
    // The first button has the focus, so that Enter begins.
    key(&mut harness, Modifiers::NONE, Key::Enter);
    assert!(!of(&harness).start.is_open());
    run(&mut harness, Command::StartPage);
    // The page takes a few frames to find its size.
    harness.run_steps(6);
    key(&mut harness, CTRL, Key::K);
    assert!(!of(&harness).start.is_open() && of(&harness).keyboard.palette.is_open(), "commands act");
}

#[test]
fn an_example_replaces_the_project_and_shows_its_page() {
    let mut harness = window();
    run(&mut harness, Command::StartPage);
    // The page takes a few frames to find its size.
    harness.run_steps(6);
    harness.get_by_label_contains("Example: Shadow methods").click();
    wait(&mut harness, "the example", |window| !window.start.is_open());
    assert_eq!(of(&harness).layout.page, Page::Compare);
    assert!(of(&harness).document.path().is_none() && !of(&harness).document.is_modified());
}

#[test]
fn recent_projects_are_listed_with_their_time() {
    let mut harness = window();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("hair.lovelock");
    harness.state_mut().state.as_mut().expect("a window").save_to(&path).expect("saves");
    harness.state_mut().state.as_mut().expect("a window").layout.recent.push("/gone/away.lovelock".into());
    run(&mut harness, Command::StartPage);
    // The page takes a few frames to find its size.
    harness.run_steps(6);
    assert!(harness.query_by_label_contains("Open hair. Saved less than a minute ago").is_some());
    assert!(harness.query_by_label_contains("Open away. The file is no longer there").is_some());
    let changed = |window: &crate::window::Window| window.layout.starts_with_page;
    assert!(changed(of(&harness)));
    harness.get_by_label("Show at start").click_accesskit();
    wait(&mut harness, "the check mark to go", |window| !changed(window));
}

#[test]
fn the_tour_points_at_controls_and_can_be_left_at_any_step() {
    let mut harness = window();
    run(&mut harness, Command::StartPage);
    // The page takes a few frames to find its size.
    harness.run_steps(6);
    harness.get_by_label("Take the tour").click_accesskit();
    wait(&mut harness, "the tour", |window| window.tour.is_open() && !window.start.is_open());
    harness.run_steps(20);
    assert!(harness.query_by_label("1 of 10").is_some());
    for step in 2..=10 {
        harness.get_by_label("Next").click_accesskit();
        harness.run_steps(20);
        assert!(harness.query_by_label(&format!("{step} of 10")).is_some());
        assert!(of(&harness).tour.points(), "step {step} points at nothing");
    }
    key(&mut harness, Modifiers::NONE, Key::PageUp);
    assert!(harness.query_by_label("9 of 10").is_some());
    key(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(!of(&harness).tour.is_open());
    run(&mut harness, Command::Tour);
    harness.get_by_label("Leave the tour").click_accesskit();
    go(&mut harness);
    assert!(!of(&harness).tour.is_open());
}
