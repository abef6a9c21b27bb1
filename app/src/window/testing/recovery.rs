//! What earlier runs did not save, and recordings that were interrupted.

use std::fs;
use std::path::Path;
use std::time::Duration;

use egui::accesskit::Role;
use egui::vec2;
use egui_kittest::kittest::{NodeT, Queryable};
use lovelock_base::clock::Stopwatch;
use lovelock_project::Project;
use lovelock_project::grants::Grants;
use lovelock_project::journal::Journals;
use lovelock_project::unfinished::{Job, Recordings};
use lovelock_render::Backend;
use lovelock_testkit::wait::wait_until;

use super::whole::{Whole, go, of, press_button, project, wait, window};
use super::{control, screen_of};
use crate::window::begin::Opened;
use crate::window::command::Command;
use crate::window::{Layout, Window};

fn with<T>(harness: &mut Whole, change: impl FnOnce(&mut Window, &egui::Context) -> T) -> T {
    let ctx = harness.ctx.clone();
    change(harness.state_mut().state.as_mut().expect("a window"), &ctx)
}

/// A window that keeps its work safe in a folder.
fn safe_window(folder: &Path) -> Whole {
    let mut harness = window();
    let kept = (
        Journals::new(folder.join("journals")),
        Grants::new(folder.join("grants.json")),
        Recordings::new(folder.join("recordings")),
    );
    with(&mut harness, |window, ctx| window.begin_safety_in(kept, ctx)).expect("the threads start");
    go(&mut harness);
    harness
}

/// Changes the project, and leaves the window as a crash does.
fn crash_after(harness: Whole, values: &[f32]) {
    let mut harness = harness;
    for value in values {
        with(&mut harness, |window, _| window.change("camera", |project| project.camera.distance = *value));
        go(&mut harness);
    }
    assert!(with(&mut harness, |window, _| window.flush_for_test()), "the changes are on the disk");
}

#[test]
fn unsaved_changes_are_offered_recovered_and_undone() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut first = safe_window(folder.path());
    assert!(first.query_by_label("Lovelock did not close properly").is_none(), "control: nothing was lost");
    assert!(with(&mut first, |window, ctx| {
        window.run(Command::ShowUnsaved, ctx);
        !window.safety.is_asking()
    }));
    crash_after(first, &[2.5, 3.0]);

    let mut second = safe_window(folder.path());
    assert!(second.query_by_label("Lovelock did not close properly").is_some());
    assert!(of(&second).holds_keys(&second.ctx), "keys wait for the answer");
    press_button(&mut second, "Decide later");
    assert!(second.query_by_label("Lovelock did not close properly").is_none());
    with(&mut second, |window, ctx| window.run(Command::ShowUnsaved, ctx));
    go(&mut second);
    press_button(&mut second, "Recover");
    assert_eq!(project(&second).camera.distance, 3.0);
    assert!(of(&second).document.is_modified());
    for value in [2.5, Project::default().camera.distance] {
        with(&mut second, |window, ctx| window.run(Command::Undo, ctx));
        assert_eq!(project(&second).camera.distance, value);
    }
    with(&mut second, |window, ctx| window.run(Command::Redo, ctx));
    // What was recovered is kept by the new window, once.
    crash_after(second, &[]);
    let mut third = safe_window(folder.path());
    assert_eq!(third.query_all_by_role_and_label(Role::Button, "Recover").count(), 1);
    press_button(&mut third, "Discard…");
    press_button(&mut third, "Keep");
    press_button(&mut third, "Discard…");
    press_button(&mut third, "Discard for good");
    assert!(!of(&third).safety.is_asking());
    with(&mut third, |window, _| window.end_safety());
    assert_eq!(fs::read_dir(folder.path().join("journals")).expect("a folder").count(), 0);
}

#[test]
fn interrupted_recordings_are_offered() {
    let folder = tempfile::tempdir().expect("a folder");
    let recordings = Recordings::new(folder.path().join("recordings"));
    for name in ["dance.mp4", "turn.mp4"] {
        fs::write(folder.path().join(format!("{name}.partial")), b"x").expect("a file");
        let running = recordings.begin(&Job::new(&folder.path().join(name), &Project::default(), false));
        // As a crash does: the note stays and is no longer locked.
        let notes =
            || fs::read_dir(folder.path().join("recordings")).expect("a folder").filter_map(Result::ok);
        let kept: Vec<_> =
            notes().map(|note| (note.path(), fs::read(note.path()).expect("a note"))).collect();
        drop(running);
        for (path, text) in &kept {
            fs::write(path, text).expect("a file");
        }
    }
    let mut harness = safe_window(folder.path());
    assert!(harness.query_by_label("Recordings were interrupted").is_some());
    assert_eq!(harness.query_all_by_role_and_label(Role::Button, "Record again").count(), 2);
    harness.query_all_by_role_and_label(Role::Button, "Discard…").next().expect("a button").click();
    go(&mut harness);
    press_button(&mut harness, "Discard for good");
    assert_eq!(harness.query_all_by_role_and_label(Role::Button, "Record again").count(), 1);
    // Too little is there to keep.
    assert!(control(&harness, Role::Button, "Keep what is there").accesskit_node().is_disabled());
    let _ = control(&harness, Role::Button, "Record again");
    press_button(&mut harness, "Decide later");
    assert!(!of(&harness).safety.is_asking());
    let left = ["dance.mp4.partial", "turn.mp4.partial"].map(|name| folder.path().join(name).exists());
    assert_eq!(left.iter().filter(|left| **left).count(), 1);
}

#[test]
fn a_take_that_a_crash_left_is_offered_by_its_name_of_now_and_not_recorded_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let recordings = Recordings::new(folder.path().join("recordings"));
    let [part, cut] = ["dance.take.part", "dance-cut1.take.part"].map(|name| folder.path().join(name));
    fs::write(&part, b"x").expect("a file");
    drop(recordings.begin(&Job::new(&folder.path().join("dance.take"), &Project::default(), false)));
    // The name was recorded again since.
    fs::rename(&part, &cut).expect("renamed");
    let mut harness = safe_window(folder.path());
    assert!(harness.query_by_label("dance-cut1.take, a take").is_some());
    for missing in ["Record again", "Continue"] {
        assert!(harness.query_by_role_and_label(Role::Button, missing).is_none(), "{missing}");
    }
    let _ = control(&harness, Role::Button, "Keep what is there");
    press_button(&mut harness, "Discard…");
    press_button(&mut harness, "Discard for good");
    assert!(!of(&harness).safety.is_asking() && !cut.exists());
    assert!(recordings.interrupted().is_empty());
}

#[test]
fn a_project_whose_folder_cannot_be_written_says_so_when_it_is_opened() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("hair.lovelock");
    let mut harness = safe_window(folder.path());
    lovelock_project::project::save_project(&path, &project(&harness)).expect("saved");
    // What a user meets who may write everything: no journal can lie here.
    fs::create_dir(folder.path().join(".hair.lovelock.journal-partial")).expect("a folder");
    with(&mut harness, |window, _| window.open_any(&path));
    wait_until("the message", || {
        harness.step();
        harness.query_by_label_contains("and Save asks for another place").is_some()
    });
    let told = format!("{} cannot be written", folder.path().display());
    assert!(harness.query_by_label_contains(&told).is_some());
    assert!(harness.query_by_label_contains(&folder.path().join("journals").display().to_string()).is_some());
    assert!(of(&harness).notices.errors().is_empty(), "nothing is lost yet");
}

#[test]
fn a_pass_that_fails_leaves_the_window_open_and_the_changes_on_the_disk() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path().to_owned();
    let mut small = Project::default();
    small.picture.backend = Backend::Cpu;
    (small.hair.groom.wisps, small.hair.groom.strands_per_wisp) = (16, 8);
    let mut opened = Some(Opened { project: small, ..Opened::default() });
    let mut harness = screen_of(vec2(1200.0, 900.0), None, move |ui, window: &mut Option<Window>| {
        let window = window.get_or_insert_with(|| {
            let mut window = Window::start(ui.ctx(), Layout::default(), opened.take().unwrap_or_default())
                .expect("the threads start");
            let kept = (Journals::new(at.join("journals")), Grants::default(), Recordings::default());
            window.begin_safety_in(kept, ui.ctx()).expect("the threads start");
            window
        });
        window.pass_safely(ui);
    });
    with(&mut harness, |window, _| {
        window.change("camera", |project| project.camera.distance = 2.5);
        window.fail_for_test();
    });
    harness.run_steps(3);
    let since = Stopwatch::start();
    let journals = || fs::read_dir(folder.path().join("journals")).map_or(0, Iterator::count);
    while journals() == 0 && since.elapsed() < Duration::from_secs(20) {
        harness.run_steps(1);
    }
    assert!(journals() > 0, "the changes are on the disk");
    wait(&mut harness, "the scene", |window| window.session.scene.is_some());
    assert_eq!(project(&harness).camera.distance, 2.5);
}
