//! Files that are opened in the whole window: what they are is found out on a thread.

use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;

use egui::accesskit::Role;
use egui::{Key, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use lovelock_base::clock::Stopwatch;
use lovelock_base::watch::Watch;
use lovelock_groom::UpAxis;
use lovelock_project::Project;
use lovelock_project::error::{Place, ProjectError};
use lovelock_project::project::{BodySource, CameraSection, HairSource};
use lovelock_render::Backend;
use lovelock_testkit::wait::wait_until;

use super::screen_of;
use super::whole::{CTRL, go, key, of, press_button, project, wait, window};
use crate::window::begin::Opened;
use crate::window::opening::{Aim, Played};
use crate::window::purpose::Purpose;
use crate::window::session::LoadEnd;
use crate::window::{Layout, Window};

/// Strands beside the head of the dancer at two times; `grows` gives the last one a point more at the second.
fn write_curves(path: &Path, grows: bool) {
    const STRANDS: usize = 40;
    let points = |more: usize, lift: f32| {
        let mut text = String::new();
        for strand in 0..STRANDS {
            let angle = 0.15 * strand as f32;
            let count = if strand + 1 == STRANDS { 3 + more } else { 3 };
            for point in 0..count {
                let (x, z) = (0.1 * angle.cos(), 0.1 * angle.sin());
                let _ = write!(text, "({x}, {}, {z}), ", 1.65 + lift - 0.05 * point as f32);
            }
        }
        text
    };
    let counts = |more: usize| format!("{}{}", "3, ".repeat(STRANDS - 1), 3 + more);
    let more = usize::from(grows);
    let text = format!(
        "#usda 1.0\n(\n metersPerUnit = 1\n upAxis = \"Y\"\n)\ndef BasisCurves \"a\"\n{{\n uniform token type = \"linear\"\n\
         int[] curveVertexCounts.timeSamples = {{ 0: [{}], 24: [{}] }}\n\
         point3f[] points.timeSamples = {{ 0: [{}], 24: [{}] }}\n}}\n",
        counts(0),
        counts(more),
        points(0, 0.0),
        points(more, 0.1)
    );
    std::fs::write(path, text).expect("a file");
}

fn is_idle(window: &Window) -> bool {
    window.files.openings.running().is_none()
}

#[test]
fn curves_play_with_their_unit_in_the_panel_and_refused_ones_are_still_with_the_reason() {
    let folder = tempfile::tempdir().expect("a folder");
    let (moves, grows) = (folder.path().join("moves ü.usda"), folder.path().join("grows.usda"));
    write_curves(&moves, false);
    write_curves(&grows, true);
    let mut harness = window();
    let before = project(&harness);
    harness.state_mut().state.as_mut().expect("a window").open_any(&moves);
    // The file is opened in a later pass: nothing waits for it.
    assert_eq!(project(&harness), before);
    assert!(!is_idle(of(&harness)));
    wait(&mut harness, "the curves", |window| !window.session.take_notes.is_empty());
    assert_eq!(project(&harness).take.file.as_ref().map(|file| file.path.clone()), Some(moves));
    assert_eq!(of(&harness).document.history().undo_len(), 1);
    assert!(harness.query_by_label_contains("Unit: read from the file").is_some());
    // The controls are those of the hair's import, here for the curves.
    let ups: Vec<_> = harness.query_all_by_role_and_label(Role::ComboBox, "Up axis").collect();
    assert!(ups.first().is_some_and(|up| !up.accesskit_node().is_disabled()), "{} controls", ups.len());
    let window = harness.state_mut().state.as_mut().expect("a window");
    window.change("up", |project| project.hair.import.up = UpAxis::Z);
    wait(&mut harness, "the curves in another axis", |window| {
        window.session.take_notes.iter().any(|note| note == "Up axis: Z, as set.")
    });
    key(&mut harness, CTRL, Key::Z);
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(project(&harness), before);

    harness.state_mut().state.as_mut().expect("a window").open_any(&grows);
    wait(&mut harness, "the hair", |window| window.document.project().hair.source == HairSource::File);
    assert_eq!(project(&harness).take.file, None, "it does not play");
    assert!(harness.query_by_label_contains("cannot be played").is_some(), "and says why");
    assert!(harness.query_all_by_label_contains("grows.usda").next().is_some());
}

/// Makes a pipe: a file whose reading takes for ever.
#[cfg(unix)]
fn make_pipe(path: &Path) {
    let made = std::process::Command::new("mkfifo").arg(path).status().expect("mkfifo");
    assert!(made.success());
}

/// Lets the thread end that reads a pipe.
#[cfg(unix)]
fn end_pipe(path: &Path) {
    drop(std::fs::OpenOptions::new().read(true).write(true).open(path).expect("the pipe"));
}

#[cfg(unix)]
#[test]
fn a_new_project_gets_no_file_of_the_one_before_and_cancel_leaves_the_next_file() {
    use crate::window::command::Command::NewProject;
    let folder = tempfile::tempdir().expect("a folder");
    let (slow, moves) = (folder.path().join("slow.usda"), folder.path().join("moves.usda"));
    make_pipe(&slow);
    write_curves(&moves, false);
    let mut harness = window();
    let before = project(&harness);
    let ctx = harness.ctx.clone();
    let open_both = |window: &mut Window| {
        window.open_any(&slow);
        window.open_any(&moves);
    };
    open_both(harness.state_mut().state.as_mut().expect("a window"));
    go(&mut harness);
    assert!(!is_idle(of(&harness)) && project(&harness) == before, "the second waits for the first");
    harness.state_mut().state.as_mut().expect("a window").run(NewProject, &ctx);
    assert!(is_idle(of(&harness)));
    go(&mut harness);
    let new = project(&harness);
    assert!(new != before && new.take.file.is_none());

    // The control: without a new project, the second file is opened when the first is cancelled.
    open_both(harness.state_mut().state.as_mut().expect("a window"));
    wait(&mut harness, "the progress", |window| {
        let is_shown =
            window.files.openings.running().is_some_and(|(name, secs)| name == "slow.usda" && secs > 0.6);
        // The scene of the new project has a progress with a button of its own.
        is_shown && window.session.worker().load_progress().is_none()
    });
    harness.get_by_role_and_label(Role::Button, "Cancel: Opening slow.usda").click();
    wait(&mut harness, "the curves", |window| window.document.project().take.file.is_some());
    assert_eq!(project(&harness).take.file.as_ref().map(|file| file.path.clone()), Some(moves));
    assert!(is_idle(of(&harness)));
    end_pipe(&slow);
}

#[cfg(unix)]
#[test]
fn the_window_lives_while_a_file_is_read_and_can_leave_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("slow.usda");
    make_pipe(&path);
    let mut harness = window();
    let before = project(&harness);
    let watch = Stopwatch::start();
    harness.state_mut().state.as_mut().expect("a window").open_any(&path);
    // The file is read for ever: a window that waits for it makes no pass.
    wait_until("the progress", || {
        harness.step();
        harness.query_all_by_label_contains("Opening slow.usda").next().is_some()
    });
    assert!(watch.secs() >= 0.1 && !is_idle(of(&harness)));
    harness.get_by_role_and_label(Role::Button, "Cancel: Opening slow.usda").click();
    go(&mut harness);
    assert!(is_idle(of(&harness)) && harness.query_by_label_contains("Opening").is_none());
    assert_eq!(project(&harness), before);
    end_pipe(&path);
    go(&mut harness);
    assert_eq!(project(&harness), before);
}

#[test]
fn a_window_whose_file_was_refused_says_why_and_works() {
    let mut project = Project::default();
    project.picture.backend = Backend::Cpu;
    (project.hair.groom.wisps, project.hair.groom.strands_per_wisp) = (16, 8);
    let why = "/gone/hair.lovelock: cannot be read: No such file";
    let mut opened = Some(Opened { project, refused: Some(why.to_owned()), ..Opened::default() });
    let mut harness = screen_of(vec2(1200.0, 900.0), None, move |ui, window: &mut Option<Window>| {
        let window = window.get_or_insert_with(|| {
            let opened = opened.take().unwrap_or_default();
            Window::start(ui.ctx(), Layout::default(), opened).expect("the threads start")
        });
        window.pass(ui);
    });
    wait(&mut harness, "the scene", |window| window.session.scene.is_some());
    assert_eq!(of(&harness).notices.errors(), [why], "nothing else failed");
    assert!(harness.query_by_label(why).is_some());
    assert!(of(&harness).document.path().is_none() && !of(&harness).document.is_modified());
}

/// A stroke of a wide brush through the head.
const STROKES: &str = "(version: 1, strokes: [(tool: comb, settings: (radius: 0.5, front_only: false), samples: [\
    (position: (0.0, 1.55, 0.0), view: (0.0, 0.0, -1.0), drag: (0.0, 0.0, 0.0), pressure: 1.0, time_secs: 0.0), \
    (position: (0.2, 1.55, 0.0), view: (0.0, 0.0, -1.0), drag: (0.2, 0.0, 0.0), pressure: 1.0, time_secs: 0.0)])])";

#[test]
fn strokes_become_a_new_project_after_a_question_about_unsaved_changes() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("combed ü.lovelockstrokes");
    std::fs::write(&path, STROKES).expect("a file");
    let mut harness = window();
    let window = harness.state_mut().state.as_mut().expect("a window");
    window.document.mark_saved(&folder.path().join("hair.lovelock"));
    window.change("camera", |project| project.camera.distance *= 0.5);
    let changed = project(&harness);
    assert!(changed.hair.stack.layers.is_empty());
    for answer in ["Cancel", "Discard changes"] {
        // As the command line opens it: on the hair of the window, of which there is little here.
        let window = harness.state_mut().state.as_mut().expect("a window");
        window.look_into(&path, Aim::Start).expect("a thread");
        assert!(!is_idle(of(&harness)), "the window goes on");
        wait(&mut harness, "the question", |window| window.files.pending.is_some());
        assert_eq!(project(&harness), changed);
        press_button(&mut harness, answer);
        assert!(of(&harness).files.pending.is_none() && is_idle(of(&harness)));
        assert_eq!(project(&harness) == changed, answer == "Cancel");
    }
    let window = of(&harness);
    assert_eq!(window.document.project().hair.stack.layers.len(), 1);
    assert!(window.document.path().is_none() && !window.document.is_modified());
    assert_eq!(window.document.history().undo_len(), 0);
    let said = "Played 1 stroke of combed ü.lovelockstrokes as a new project";
    assert!(harness.query_by_label_contains(said).is_some());
    assert_eq!(std::fs::read_to_string(&path).expect("the file"), STROKES);
    // Control: without changes there is no question.
    let before = project(&harness);
    harness.state_mut().state.as_mut().expect("a window").look_into(&path, Aim::Start).expect("a thread");
    wait(&mut harness, "the strokes", |window| {
        assert!(window.files.pending.is_none());
        !Arc::ptr_eq(window.document.project(), &before)
    });
}

#[test]
fn strokes_are_listed_and_broken_or_cancelled_ones_leave_the_project() {
    let folder = tempfile::tempdir().expect("a folder");
    let [path, broken] = ["a.lovelockstrokes", "b.lovelockstrokes"].map(|name| folder.path().join(name));
    std::fs::write(&path, STROKES).expect("a file");
    std::fs::write(&broken, STROKES.replace("version: 1", "version: 7")).expect("a file");
    assert!(Purpose::Open.lists(&path) && !Purpose::Beside.lists(&path));
    let watch = Watch::default();
    watch.cancel();
    let cancelled = Played::of(&path, &Project::default(), &watch);
    assert!(matches!(cancelled, Err(ProjectError::Cancelled)));
    let mut harness = window();
    let before = project(&harness);
    harness.state_mut().state.as_mut().expect("a window").open_any(&broken);
    wait(&mut harness, "the error", |window| !window.notices.errors().is_empty());
    let errors = of(&harness).notices.errors().join("\n");
    assert!(errors.contains("b.lovelockstrokes: strokes: found version 7; must be 1"), "{errors}");
    // A pane cannot show them, and nothing is played to find that out.
    harness.state_mut().state.as_mut().expect("a window").look_into(&path, Aim::Beside).expect("a thread");
    wait(&mut harness, "the error", |window| window.notices.errors().len() == 2);
    assert!(of(&harness).notices.errors()[1].contains("found a strokes file; must be a take"));
    assert!(Arc::ptr_eq(&project(&harness), &before));
}

#[test]
fn the_camera_follows_the_size_of_an_opened_body_in_the_same_undo_step() {
    let Some(data) = lovelock_testkit::data_dir() else { return };
    let path = data.join("characters/MorphStressTest.gltf");
    let mut harness = window();
    let before = project(&harness);
    harness.state_mut().state.as_mut().expect("a window").open_any(&path);
    wait(&mut harness, "the body", |window| {
        window.session.scene.as_ref().is_some_and(|scene| scene.hair_scale > 2.0)
    });
    go(&mut harness);
    let scale = of(&harness).session.scene.as_ref().map_or(0.0, |scene| scene.hair_scale);
    let (new, framed) = (CameraSection::default(), project(&harness).camera);
    println!("hair_scale {scale}, distance {}", framed.distance);
    assert!((framed.distance - (new.distance * scale).min(30.0)).abs() < 1e-4, "{framed:?}");
    assert_eq!(project(&harness).body.source, BodySource::File);
    assert_eq!(of(&harness).document.history().undo_len(), 1);
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(project(&harness), before);

    // A camera that was moved before the body was loaded stays.
    let is_large =
        |window: &Window| window.session.scene.as_ref().is_some_and(|scene| scene.hair_scale > 2.0);
    wait(&mut harness, "the dancer", |window| !is_large(window));
    let window = harness.state_mut().state.as_mut().expect("a window");
    window.open_body(&path);
    window.change("camera", |project| project.camera.distance *= 0.5);
    let moved = project(&harness).camera;
    wait(&mut harness, "the body", is_large);
    go(&mut harness);
    assert_eq!(project(&harness).camera, moved);
}

#[test]
fn a_broken_file_leaves_the_project_and_its_error_stays() {
    let folder = tempfile::tempdir().expect("a folder");
    let bad = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("a file");
        path
    };
    // Right at the start, so that the kind is known, and wrong behind it.
    let hair = bad("broken.hair", b"HAIR\x01\0\0\0");
    let body = bad("broken.glb", b"glTF\x02\0\0\0\x0c\0\0\0");
    let mut harness = window();
    let before = project(&harness);
    for path in [&hair, &body] {
        harness.state_mut().state.as_mut().expect("a window").open_any(path);
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        wait(&mut harness, "the error", |window| {
            window.notices.errors().iter().any(|error| error.contains(&name)) && !window.document.has_trials()
        });
        assert_eq!(project(&harness), before, "{name}");
        assert_eq!(of(&harness).document.history().undo_len(), 0, "{name}");
        assert_eq!(of(&harness).document.history().redo_len(), 0, "it cannot be redone");
    }
    assert_eq!(of(&harness).notices.errors().len(), 2);
    wait(&mut harness, "the project of before without problems", |window| {
        window.session.problems.iter().all(|problem| !problem.is_failure())
    });
}

#[test]
fn a_broken_file_that_was_changed_after_it_was_opened_leaves_the_change() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("broken.hair");
    std::fs::write(&path, b"HAIR\x01\0\0\0").expect("a file");
    let mut harness = window();
    let before = project(&harness);
    let window = harness.state_mut().state.as_mut().expect("a window");
    window.open_part(Place::Hair, &path, |project| project.set_hair_file(&path));
    window.change("camera", |project| project.camera.distance *= 0.5);
    let distance = project(&harness).camera.distance;
    wait(&mut harness, "the error", |window| !window.document.has_trials());
    let after = project(&harness);
    assert_eq!((after.hair.source, &after.hair.file), (HairSource::Grown, &before.hair.file));
    assert!((after.camera.distance - distance).abs() < 1e-6);
}

#[test]
fn a_take_that_is_not_loaded_gives_the_project_its_file_back() {
    let mut harness = window();
    wait(&mut harness, "the scene", |window| !window.session.worker().is_loading());
    let window = harness.state_mut().state.as_mut().expect("a window");
    let (before, path) = (Arc::clone(window.document.project()), Path::new("/missing/dance.take"));
    let saved = Path::new("/missing/hair.lovelock");
    window.document.mark_saved(saved);
    window.document.try_file("take", Place::Take, path, |project| project.set_take(path));
    window.document.detach();
    window.session.load_ends.push(LoadEnd::Nothing);
    window.take_load_ends();
    assert!(!window.document.has_trials() && Arc::ptr_eq(window.document.project(), &before));
    assert_eq!(window.document.path(), Some(saved));
}
