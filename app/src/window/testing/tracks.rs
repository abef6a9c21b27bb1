//! Writing tracks by moving controls during playback, in the whole window.

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, TouchPhase, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use lovelock_testkit::wait::wait_until;

use super::whole::{CTRL, key, of, playing_window, project, wait};
use super::{Shown, control, press};
use crate::window::Window;

fn position(window: &Window) -> f64 {
    window.session.frame.as_ref().map_or(0.0, |frame| frame.position_secs)
}

/// Holds the extinction slider and moves it to the right during playback.
fn ride(harness: &mut Harness<'_, Shown<Option<Window>>>) {
    let rail = control(harness, Role::Slider, "Extinction").rect();
    harness.hover_at(rail.center());
    press(harness, rail.center(), true);
    harness.run_steps(2);
    for i in 1..=6 {
        let before = position(of(harness));
        let at = rail.center().lerp(rail.right_center(), i as f32 / 8.0);
        harness.hover_at(at);
        wait(harness, "time to pass", |window| (position(window) - before).abs() > 0.05);
    }
    let at = rail.center().lerp(rail.right_center(), 0.75);
    press(harness, at, false);
    harness.run_steps(2);
}

#[test]
fn a_slider_moved_during_playback_becomes_a_track() {
    let mut harness = playing_window();
    wait(&mut harness, "a frame", |window| window.session.frame.is_some());
    let before = project(&harness);
    key(&mut harness, Modifiers::NONE, Key::W);
    assert!(of(&harness).document.overdub().is_armed());
    ride(&mut harness);
    let written = project(&harness);
    let [track] = written.timeline.tracks.as_slice() else { panic!("{:?}", written.timeline.tracks) };
    assert_eq!(track.target, "look/extinction_scale");
    let [low, high] = track.range()[0];
    assert!(high > low && track.keys.len() >= 3, "{track:?}");
    assert_eq!(written.look, before.look, "the project's own value stays");
    assert_eq!(of(&harness).document.history().undo_len(), 1, "not one undo step");

    // The image and the panel follow the track.
    key(&mut harness, Modifiers::NONE, Key::W);
    wait(&mut harness, "a picture at another value", |window| {
        window.session.drawn.as_ref().is_some_and(|drawn| {
            let track = &window.document.project().timeline.tracks[0];
            let at = track.value_at(drawn.snapshot.position_secs).map_or(0.0, |value| value[0]);
            (f64::from(drawn.project.look.extinction_scale) - at).abs() < 1e-5
                && at > low + 0.5 * (high - low)
        })
    });
    let window = harness.state_mut().state.as_mut().expect("a window");
    assert_ne!(window.seen().look.extinction_scale, before.look.extinction_scale);

    // A control whose track plays cannot be moved, and the window says so.
    ride(&mut harness);
    assert_eq!(project(&harness).timeline, written.timeline);
    assert!(harness.query_by_label_contains("follows its track").is_some());
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(project(&harness), before);
}

/// Turns the wheel over the viewport by this many points.
fn turn_wheel(harness: &mut Harness<'_, Shown<Option<Window>>>, points: f32) {
    let at = control(harness, Role::Image, "Viewport").rect().center();
    harness.hover_at(at);
    harness.event(Event::MouseWheel {
        unit: MouseWheelUnit::Point,
        delta: vec2(0.0, points),
        phase: TouchPhase::Move,
        modifiers: Modifiers::NONE,
        source: MouseWheelSource::Wheel,
    });
    harness.run_steps(2);
}

#[test]
fn turning_the_wheel_during_playback_is_one_recording_pass() {
    let mut harness = playing_window();
    wait(&mut harness, "a frame", |window| window.session.frame.is_some());
    let before = project(&harness);
    key(&mut harness, Modifiers::NONE, Key::W);
    for _ in 0..3 {
        let now = position(of(&harness));
        // The end of the gesture is timed in passes and playback in real time, so the wheel turns until playback has advanced.
        wait_until("playback", || {
            for points in [40.0, -40.0] {
                turn_wheel(&mut harness, points);
                assert_eq!(of(&harness).document.overdub().writes().collect::<Vec<_>>(), ["camera/distance"]);
            }
            (position(of(&harness)) - now).abs() >= 0.04
        });
    }
    wait(&mut harness, "the recording pass to end", |window| {
        window.document.overdub().writes().next().is_none()
    });
    let written = project(&harness);
    let [track] = written.timeline.tracks.as_slice() else { panic!("{:?}", written.timeline.tracks) };
    let [low, high] = track.range()[0];
    assert!(high > 1.01 * low && track.keys.len() >= 3, "{track:?}");
    assert_eq!(written.camera, before.camera, "the project's own value stays");
    assert_eq!(of(&harness).document.history().undo_len(), 1, "not one undo step");
    // Undo during a recording pass discards it.
    turn_wheel(&mut harness, 60.0);
    // egui spreads a wheel notch over several passes, and the recording pass ends twelve passes after them.
    harness.run_steps(8);
    assert!(of(&harness).document.overdub().writes().next().is_some());
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(project(&harness), written);
    assert!(of(&harness).document.overdub().writes().next().is_none());
}

#[test]
fn commands_that_move_the_camera_are_edits_like_any_other() {
    let mut harness = playing_window();
    wait(&mut harness, "a frame", |window| window.session.frame.is_some());
    let mut tracked = (*project(&harness)).clone();
    tracked.camera.distance = 9.0;
    let keys = [0.0, 60.0].map(|secs| lovelock_project::tracks::Key { secs, value: vec![8.0] });
    tracked.timeline.tracks = vec![lovelock_project::tracks::Track {
        keys: keys.to_vec(),
        ..lovelock_project::tracks::Track::new("camera/distance")
    }];
    let window = harness.state_mut().state.as_mut().expect("a window");
    window.document.edit("camera", tracked.clone());
    window.document.end_gesture();

    // During playback the distance follows its track, and the window says so; values without a track change.
    key(&mut harness, Modifiers::NONE, Key::F);
    let framed = project(&harness);
    assert!(harness.query_by_label_contains("Camera distance follows its track").is_some());
    assert_eq!(framed.timeline, tracked.timeline);
    assert_eq!(framed.camera.distance, 9.0);
    assert_ne!(framed.camera, tracked.camera);
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(*project(&harness), tracked);

    // While paused, the command sets a key at the current time.
    key(&mut harness, Modifiers::NONE, Key::Space);
    wait(&mut harness, "the pause", |window| !window.session.playing);
    let at = position(of(&harness));
    key(&mut harness, Modifiers::NONE, Key::F);
    let keyed = project(&harness);
    let [track] = keyed.timeline.tracks.as_slice() else { panic!("{:?}", keyed.timeline.tracks) };
    let [there] = track.keys.iter().filter(|key| (key.secs - at).abs() < 0.02).collect::<Vec<_>>()[..] else {
        panic!("{track:?} at {at}")
    };
    assert!(there.value[0] < 7.0, "near enough to fill the picture: {there:?}");
    assert_eq!(keyed.camera.distance, 9.0);
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(*project(&harness), tracked);

    // During playback with writing on, the command writes the track.
    key(&mut harness, Modifiers::NONE, Key::Space);
    key(&mut harness, Modifiers::NONE, Key::W);
    key(&mut harness, Modifiers::NONE, Key::F);
    wait(&mut harness, "the recording pass to end", |window| {
        window.document.overdub().writes().next().is_none()
    });
    let written = project(&harness);
    let track = written.timeline.tracks.iter().find(|track| track.target == "camera/distance");
    assert!(track.is_some_and(|track| track.keys.len() > 2 && track.range()[0][0] < 7.0), "{track:?}");
    assert_eq!(written.camera, tracked.camera, "the project's own camera stays");
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(*project(&harness), tracked, "one step");
}
