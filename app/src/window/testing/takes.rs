//! Takes in the whole window: recording, playing and leaving them by keys.

use egui::{Key, Modifiers};

use lovelock_project::project::CompareSection;

use super::whole::{CTRL, Whole, key, of, playing_window, project, wait, window};
use crate::window::Window;
use crate::window::command::Command;
use crate::window::opening::Aim;

#[test]
fn a_take_is_recorded_played_backwards_and_left() {
    let mut harness = playing_window();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("p.lovelock");
    harness.state_mut().state.as_mut().expect("a window").document.mark_saved(&path);
    wait(&mut harness, "a frame", |window| window.session.frame.is_some());
    key(&mut harness, Modifiers::NONE, Key::R);
    wait(&mut harness, "some frames", |window| {
        window.session.worker().take_progress().is_some_and(|take| take.frames > 20)
    });
    let clip_secs = of(&harness).session.frame.as_ref().map_or(0.0, |frame| frame.duration_secs);
    key(&mut harness, Modifiers::NONE, Key::R);
    wait(&mut harness, "the take", |window| window.session.saved_take.is_some());
    let take = folder.path().join("takes/p-1.take");
    assert!(take.is_file() && of(&harness).session.worker().take_progress().is_none());

    // The dance does not go on while the take is looked into.
    let ctx = harness.ctx.clone();
    let window = harness.state_mut().state.as_mut().expect("a window");
    window.session.set_playing(false);
    window.run(Command::PlayTake, &ctx);
    assert!(!window.session.playing && window.files.openings.running().is_some());
    wait(&mut harness, "the take", |window| window.session.playing);
    let duration = |window: &Window| window.session.frame.as_ref().map_or(0.0, |frame| frame.duration_secs);
    wait(&mut harness, "the take to play", |window| duration(window) < clip_secs);
    assert_eq!(project(&harness).take.file.as_ref().map(|file| file.path.clone()), Some(take.clone()));
    let position = |window: &Window| window.session.frame.as_ref().map_or(0.0, |frame| frame.position_secs);
    key(&mut harness, Modifiers::SHIFT, Key::Space);
    assert!(of(&harness).session.backwards && of(&harness).session.playing);
    let before = position(of(&harness));
    wait(&mut harness, "time to pass", |window| position(window) != before);

    key(&mut harness, Modifiers::SHIFT, Key::R);
    // Until the dance is loaded the take is still seen, but it leaves no pictures on the timeline of the dance.
    wait(&mut harness, "the simulation", |window| {
        let is_left = duration(window) == clip_secs;
        assert!(is_left || window.media.thumbnails.shown().is_empty(), "no picture of the take");
        is_left
    });
    assert_eq!(project(&harness).take.file, None);
    wait(&mut harness, "a picture of the dance", |window| !window.media.thumbnails.shown().is_empty());
    key(&mut harness, CTRL, Key::Z);
    assert!(project(&harness).take.file.is_some(), "leaving a take is undone like any change");
    key(&mut harness, CTRL | Modifiers::SHIFT, Key::Z);
    assert_eq!(project(&harness).take.file, None);

    // A take that is opened has no file to save to; undo returns to the project in its file, and redo to the take.
    let window = harness.state_mut().state.as_mut().expect("a window");
    let saved = window.document.path().map(std::path::Path::to_owned);
    assert!(saved.is_some());
    let steps = window.document.history().undo_len();
    window.open_any(&take);
    wait(&mut harness, "the take", |window| {
        window.document.history().undo_len() > steps && window.document.path().is_none()
    });
    for (command, path) in [(Command::Undo, saved), (Command::Redo, None)] {
        harness.state_mut().state.as_mut().expect("a window").run(command, &ctx);
        assert_eq!(of(&harness).document.path().map(std::path::Path::to_owned), path);
    }

    // Beside the panes of the user there is one more; the panes of a new project make place for it.
    let beside = |window: &mut Window, panes: usize| {
        window.change("compare", |project| {
            project.compare = CompareSection::default();
            if panes > 0 {
                project.compare.panes[0].scale = 0.5;
                let last = project.compare.panes[3].clone();
                project.compare.panes.resize(panes, last);
            }
        });
        window.look_into(&take, Aim::Beside).expect("a thread");
    };
    for (before, after) in [(0, 2), (4, 5), (CompareSection::MAX_PANES, CompareSection::MAX_PANES)] {
        beside(harness.state_mut().state.as_mut().expect("a window"), before);
        wait(&mut harness, "the pane", |window| window.files.openings.running().is_none());
        let panes = &project(&harness).compare.panes;
        let of_takes = panes.iter().filter(|pane| pane.take.is_some()).count();
        assert_eq!((panes.len(), of_takes), (after, usize::from(before < CompareSection::MAX_PANES)));
    }
}

#[test]
fn the_frames_that_are_marked_are_the_first_and_the_last_of_recordings() {
    let mut harness = window();
    let marks = |harness: &Whole| {
        let recording = &project(harness).recording;
        (recording.first_frame, recording.end_frame)
    };
    let frame = |window: &Window| {
        let secs = window.session.frame.as_ref().map_or(0.0, |frame| frame.position_secs);
        (secs * window.document.project().recording.fps).round() as u64
    };
    wait(&mut harness, "a frame", |window| window.session.frame.is_some());
    key(&mut harness, Modifiers::NONE, Key::O);
    assert_eq!(marks(&harness), (0, Some(1)), "one frame, the first");
    for _ in 0..4 {
        key(&mut harness, Modifiers::NONE, Key::ArrowRight);
    }
    wait(&mut harness, "four steps", |window| frame(window) == 2);
    key(&mut harness, Modifiers::NONE, Key::O);
    assert_eq!(marks(&harness), (0, Some(3)));
    key(&mut harness, Modifiers::NONE, Key::I);
    assert_eq!(marks(&harness), (2, Some(3)), "the frame that is shown is recorded");
}
