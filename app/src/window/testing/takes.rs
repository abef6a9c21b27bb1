//! Takes in the whole window: recording, playing and leaving them by keys.

use egui::{Key, Modifiers};

use super::whole::{CTRL, key, of, playing_window, project, wait};
use crate::window::Window;

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

    key(&mut harness, Modifiers::NONE, Key::P);
    let duration = |window: &Window| window.session.frame.as_ref().map_or(0.0, |frame| frame.duration_secs);
    wait(&mut harness, "the take to play", |window| duration(window) < clip_secs);
    assert_eq!(project(&harness).take.file.as_ref().map(|file| file.path.clone()), Some(take));
    let position = |window: &Window| window.session.frame.as_ref().map_or(0.0, |frame| frame.position_secs);
    key(&mut harness, Modifiers::SHIFT, Key::Space);
    assert!(of(&harness).session.backwards && of(&harness).session.playing);
    let before = position(of(&harness));
    wait(&mut harness, "time to pass", |window| position(window) != before);

    key(&mut harness, Modifiers::SHIFT, Key::R);
    wait(&mut harness, "the simulation", |window| duration(window) == clip_secs);
    assert_eq!(project(&harness).take.file, None);
    key(&mut harness, CTRL, Key::Z);
    assert!(project(&harness).take.file.is_some(), "leaving a take is undone like any change");
}
