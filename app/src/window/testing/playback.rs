//! Tests of the timeline.

use egui::accesskit::Role;
use egui::{Event, Modifiers, MouseWheelUnit, PointerButton, Rect, TouchPhase, pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use lovelock_project::project::{Marker, MotionSection, MotionSource, RecordingSection, SoundSection};
use lovelock_project::tracks::Track;
use lovelock_style::StyleStack;

use super::super::command::Command;
use super::{Shown, click, control, drag, screen_of, tooltip_at};
use crate::window::purpose::Purpose;
use crate::window::timeline::{self, Edited, Recorded, Take, View, Writing, Zoom};

pub(super) struct State {
    pub(super) view: View,
    zoom: Zoom,
    pub(super) tracks_height: Option<f32>,
    /// The area above the timeline.
    pub(super) above: Rect,
    recording: RecordingSection,
    markers: Vec<Marker>,
    pub(super) tracks: Vec<Track>,
    motion: MotionSection,
    sound: SoundSection,
    asked: Vec<Command>,
}

pub(super) fn state(view: View) -> State {
    State {
        view,
        zoom: Zoom::default(),
        tracks_height: None,
        above: Rect::NOTHING,
        recording: RecordingSection::default(),
        markers: vec![Marker { secs: 6.0, name: "turn".to_owned() }],
        tracks: Vec::new(),
        motion: MotionSection::default(),
        sound: SoundSection::default(),
        asked: Vec::new(),
    }
}

fn bar(view: View) -> Harness<'static, Shown<State>> {
    with_tracks(state(view))
}

fn with_tracks(state: State) -> Harness<'static, Shown<State>> {
    screen_with(SCREEN, state)
}

/// The size of the screen, points.
const SCREEN: egui::Vec2 = vec2(900.0, 700.0);

/// The timeline at the bottom of a screen of that size.
pub(super) fn screen_with(size: egui::Vec2, state: State) -> Harness<'static, Shown<State>> {
    screen_of(size, state, |ui, state: &mut State| {
        let State { recording, markers, tracks, motion, sound, .. } = state;
        let mut edited = Edited { recording, markers, tracks, motion, sound, stack: &StyleStack::default() };
        let kept = (&mut state.zoom, &mut state.tracks_height);
        state.asked.extend(timeline::panel(ui, &state.view, kept, &mut edited));
        state.above = ui.available_rect_before_wrap();
    })
}

pub(super) fn view() -> View {
    View {
        time_secs: 2.0,
        duration_secs: 8.0,
        playing: true,
        looping: true,
        rate: 1.0,
        clip: "dance".to_owned(),
        clips: vec!["dance".to_owned(), "idle".to_owned()],
        take: None,
        can_play_take: true,
        recording: None,
        thumbs: Vec::new(),
        writing: Writing::default(),
        sound: None,
    }
}

pub(super) fn take() -> View {
    View { take: Some(Take { name: "first".to_owned(), backwards: false }), ..view() }
}

#[test]
fn every_button_requests_its_command() {
    for (view, commands) in [
        (
            view(),
            vec![
                Command::JumpToStart,
                Command::StepBack,
                Command::PlayPause,
                Command::StepForward,
                Command::JumpToEnd,
                Command::RecordTake,
                Command::PlayTake,
            ],
        ),
        (take(), vec![Command::StepBack, Command::LeaveTake]),
    ] {
        let mut harness = bar(view);
        for command in commands {
            let rect = control(&harness, Role::Button, command.info().expect("in the table").label).rect();
            harness.state_mut().state.asked.clear();
            click(&mut harness, rect.center());
            assert_eq!(harness.state().state.asked, std::slice::from_ref(&command));
            let said = tooltip_at(&mut harness, rect.center()).expect("a tooltip");
            assert!(said.contains(command.info().expect("in the table").shortcuts[0]), "{command:?}: {said}");
        }
    }
    let mut harness = bar(take());
    for command in [Command::ToggleLoop, Command::PlayBackwards, Command::WriteTracks] {
        let rect = control(&harness, Role::CheckBox, command.info().expect("in the table").label).rect();
        harness.state_mut().state.asked.clear();
        click(&mut harness, rect.center());
        assert_eq!(harness.state().state.asked, [command]);
    }
}

#[test]
fn a_click_seeks_and_a_drag_stays_in_range() {
    let mut harness = bar(view());
    let rect: Rect = control(&harness, Role::Slider, "Time").rect();
    // The names of the lanes are left of the ruler.
    let (left, right) = (rect.left() + 52.0, rect.right());
    let at = pos2(0.5 * (left + right), rect.bottom() - 4.0);
    click(&mut harness, at);
    let Some(&Command::Seek(secs)) = harness.state().state.asked.last() else {
        panic!("no time was asked for")
    };
    // One point on the ruler is a hundredth of a second here.
    assert!((secs - 4.0).abs() < 0.02, "{secs}");
    drag(&mut harness, at, pos2(1e6, at.y));
    assert_eq!(harness.state().state.asked.last(), Some(&Command::Seek(8.0)));
    drag(&mut harness, at, pos2(-1e6, at.y));
    assert_eq!(harness.state().state.asked.last(), Some(&Command::Seek(0.0)));
    let said = tooltip_at(&mut harness, at + vec2(40.0, 0.0));
    assert!(said.is_some(), "the bar says what it does");
}

#[test]
fn the_wheel_magnifies_and_a_click_seeks_in_the_shown_range() {
    let mut harness = bar(view());
    let rect: Rect = control(&harness, Role::Slider, "Time").rect();
    let right = pos2(rect.right() - 1.0, rect.bottom() - 4.0);
    harness.hover_at(right);
    for _ in 0..12 {
        harness.event(Event::MouseWheel {
            unit: MouseWheelUnit::Point,
            delta: vec2(0.0, 100.0),
            phase: TouchPhase::Move,
            source: egui::MouseWheelSource::Wheel,
            modifiers: Modifiers::NONE,
        });
        harness.run_steps(4);
    }
    assert_ne!(harness.state().state.zoom, Zoom::default());
    harness.state_mut().state.asked.clear();
    click(&mut harness, pos2(rect.left() + 54.0, right.y));
    let Some(&Command::Seek(secs)) = harness.state().state.asked.last() else {
        panic!("no time was asked for")
    };
    assert!((6.0..8.0).contains(&secs), "magnified about the end, the left edge is near it: {secs}");
}

#[test]
fn dragged_in_and_out_points_never_cross() {
    let mut harness = bar(view());
    let out = control(&harness, Role::Slider, "Out point").rect().center();
    let middle = pos2(out.x - 400.0, out.y);
    drag(&mut harness, out, middle);
    let end = harness.state().state.recording.end_frame.expect("an out point");
    assert!((110..150).contains(&end), "{end} of 240 frames");
    let point = control(&harness, Role::Slider, "In point").rect().center();
    drag(&mut harness, point, pos2(1e6, point.y));
    let recording = harness.state().state.recording.clone();
    assert_eq!((recording.first_frame, recording.end_frame), (end - 1, Some(end)));
}

#[test]
fn markers_seek_and_can_be_removed() {
    let mut harness = bar(view());
    let flag = control(&harness, Role::Button, "Marker turn").rect().center();
    click(&mut harness, flag);
    assert_eq!(harness.state().state.asked.last(), Some(&Command::Seek(6.0)));
    for pressed in [true, false] {
        let button = PointerButton::Secondary;
        harness.event(Event::PointerButton { pos: flag, button, pressed, modifiers: Modifiers::NONE });
    }
    harness.run_steps(3);
    assert_eq!(harness.state().state.markers, []);
}

#[test]
fn clips_of_zero_length_and_of_days_are_shown() {
    for (time_secs, duration_secs) in
        [(0.0, 0.0), (5.0, 0.0), (1e6, 3e5), (f64::NAN, f64::NAN), (0.5, 1.0 / 60.0), (0.0, f64::INFINITY)]
    {
        for view in [
            view(),
            take(),
            View { recording: Some(Recorded { from_secs: 1.0, secs: 2.5, kept_secs: 2.0 }), ..view() },
        ] {
            let mut harness = bar(View { time_secs, duration_secs, ..view });
            let rect = control(&harness, Role::Slider, "Time").rect();
            click(&mut harness, pos2(rect.center().x, rect.bottom() - 4.0));
            for request in &harness.state().state.asked {
                assert!(
                    matches!(request, Command::Seek(secs) if secs.is_finite()),
                    "{duration_secs}: {request:?}"
                );
            }
            assert!(harness.state().taken.right() <= 900.0);
        }
    }
}

/// A timeline with a track of the camera and one of the light.
fn tracked() -> Harness<'static, Shown<State>> {
    let key = |secs, value: &[f64]| lovelock_project::tracks::Key { secs, value: value.to_vec() };
    let mut state = state(view());
    state.tracks = vec![
        Track {
            keys: vec![key(0.0, &[1.0]), key(4.0, &[3.0]), key(8.0, &[1.0])],
            ..Track::new("camera/distance")
        },
        Track {
            keys: vec![key(2.0, &[0.0, -1.0, 0.0]), key(6.0, &[1.0, 0.0, 0.5])],
            ..Track::new("lights/0/direction")
        },
    ];
    with_tracks(state)
}

/// Screen position of the key at a time on the camera's track.
fn key_at(harness: &Harness<'_, Shown<State>>, secs: f32, height: f32) -> egui::Pos2 {
    let lane = control(harness, Role::Slider, "Track Camera distance").rect();
    pos2(lane.left() + lane.width() * secs / 8.0, lane.bottom() - 4.0 - (lane.height() - 8.0) * height)
}

#[test]
fn tracks_are_muted_smoothed_and_deleted() {
    let mut harness = tracked();
    harness.check_accessibility();
    assert!(harness.state().taken.right() <= SCREEN.x && harness.state().taken.bottom() <= SCREEN.y);
    for (button, says) in [("Mute", "own value"), ("Smooth", "jitter"), ("Delete", "Removes")] {
        let name = format!("{button} track Camera distance");
        let at = control(&harness, Role::Button, &name).rect().center();
        assert!(tooltip_at(&mut harness, at).is_some_and(|tip| tip.contains(says)));
    }
    let press = |harness: &mut Harness<'_, Shown<State>>, name: &str| {
        let at = control(harness, Role::Button, name).rect().center();
        click(harness, at);
    };
    press(&mut harness, "Mute track Camera distance");
    assert!(harness.state().state.tracks[0].muted);
    press(&mut harness, "Mute track Camera distance");
    assert!(!harness.state().state.tracks[0].muted);
    let before = harness.state().state.tracks[0].clone();
    press(&mut harness, "Smooth track Camera distance");
    let smoothed = harness.state().state.tracks[0].clone();
    assert!(smoothed != before && smoothed.keys[0] == before.keys[0]);
    press(&mut harness, "Delete track Camera distance");
    let left: Vec<_> = harness.state().state.tracks.iter().map(|track| track.target.clone()).collect();
    assert_eq!(left, ["lights/0/direction"]);
}

#[test]
fn keys_are_moved_added_and_removed() {
    let mut harness = tracked();
    let key = |harness: &Harness<'_, Shown<State>>, i: usize| harness.state().state.tracks[0].keys[i].clone();
    // Drags the key from the top of its lane to the middle, one second later.
    let (from, to) = (key_at(&harness, 4.0, 1.0), key_at(&harness, 5.0, 0.5));
    drag(&mut harness, from, to);
    let moved = key(&harness, 1);
    // One point is a hundredth of a second horizontally and a tenth of the value vertically.
    assert!((moved.secs - 5.0).abs() < 0.02 && (moved.value[0] - 2.0).abs() < 0.1, "{moved:?}");
    // A key cannot pass the next one.
    let from = key_at(&harness, moved.secs as f32, 1.0);
    drag(&mut harness, from, pos2(1e6, from.y));
    let moved = key(&harness, 1);
    assert!(moved.secs < key(&harness, 2).secs && moved.secs > 7.9, "{moved:?}");
    // A click beside the keys seeks, and a double-click adds a key on the curve.
    let beside = key_at(&harness, 3.0, 0.1);
    click(&mut harness, beside);
    assert!(
        matches!(harness.state().state.asked.last(), Some(Command::Seek(secs)) if (secs - 3.0).abs() < 0.02)
    );
    let curve = harness.state().state.tracks[0].value_at(3.0).expect("keys");
    super::double_click(&mut harness, beside);
    let set = key(&harness, 1);
    assert!((set.secs - 3.0).abs() < 0.02 && (set.value[0] - curve[0]).abs() < 0.02, "{set:?} on {curve:?}");
    for pressed in [true, false] {
        let modifiers = Modifiers::NONE;
        let pos = key_at(&harness, 0.0, 0.0);
        harness.hover_at(pos);
        harness.event(Event::PointerButton { pos, button: PointerButton::Secondary, pressed, modifiers });
    }
    harness.run_steps(3);
    assert_eq!(key(&harness, 0), set, "the first one is gone");
}

#[test]
fn the_clip_menu_changes_clip_tempo_and_trim() {
    let mut harness = bar(view());
    let open = |harness: &mut Harness<'_, Shown<State>>| {
        let at = control(harness, Role::Button, "Clip").rect().center();
        click(harness, at);
        harness.run_ok();
    };
    let press = |harness: &mut Harness<'_, Shown<State>>, role: Role, name: &str| {
        let at = control(harness, role, name).rect().center();
        click(harness, at);
    };
    open(&mut harness);
    press(&mut harness, Role::Button, "idle");
    assert_eq!(harness.state().state.motion.clip, "idle");
    harness.state_mut().state.motion.source = MotionSource::Rest;
    for (name, request) in [
        ("Trim to in and out points", Command::TrimToPoints),
        ("Motion file…", Command::PickFile(Purpose::Motion)),
    ] {
        harness.state_mut().state.recording.first_frame = 30;
        let mut fresh = bar(view());
        fresh.state_mut().state.recording.first_frame = 30;
        fresh.run_ok();
        open(&mut fresh);
        press(&mut fresh, Role::Button, name);
        assert_eq!(fresh.state().state.asked.last(), Some(&request), "{name}");
    }
    // Trimming needs in or out points, and *Whole clip* needs a trim.
    let mut fresh = bar(view());
    open(&mut fresh);
    for name in ["Trim to in and out points", "Whole clip"] {
        press(&mut fresh, Role::Button, name);
    }
    assert_eq!(fresh.state().state.asked, []);
}

/// A view with a sound that has a beat every half second.
pub(super) fn with_sound() -> State {
    let lane = timeline::SoundLane {
        name: "song.ogg".to_owned(),
        loaded: std::sync::Arc::new(crate::window::panels::clicks()),
    };
    let mut state = state(View { sound: Some(lane), ..view() });
    state.sound.file = Some(lovelock_project::files::FileRef::new("/songs/song.ogg"));
    state
}

#[test]
fn the_sound_is_drawn_under_the_ruler_and_a_drag_shifts_it() {
    let mut harness = with_tracks(with_sound());
    let lane = control(&harness, Role::Slider, "Sound on the timeline").rect();
    let ruler = control(&harness, Role::Slider, "Time").rect();
    assert!(
        lane.top() > ruler.top() + 15.0 && lane.bottom() < ruler.bottom() - 30.0,
        "{lane:?} in {ruler:?}"
    );
    drag(&mut harness, lane.center(), lane.center() + vec2(lane.width() / 8.0, 0.0));
    let offset = harness.state().state.sound.offset_secs;
    assert!((offset - 1.0).abs() < 0.05, "an eighth of 8 s: {offset}");
    assert!(harness.state().state.asked.is_empty(), "the drag does not scrub");
    let said = tooltip_at(&mut harness, lane.center()).expect("a tooltip");
    assert!(said.contains("song.ogg") && said.contains("Alt"), "{said}");
    // Control: without a sound there is no lane, and the timeline is lower.
    let silent = bar(view());
    assert!(silent.query_by_role_and_label(Role::Slider, "Sound on the timeline").is_none());
    assert!(silent.state().state.above.bottom() > harness.state().state.above.bottom());
}

#[test]
fn a_dragged_marker_snaps_to_a_beat_unless_alt_is_held() {
    let beat = |secs: f64| (secs * 2.0 - (secs * 2.0).round()).abs() / 2.0;
    let mut harness = with_tracks(with_sound());
    let flag = control(&harness, Role::Button, "Marker turn").rect().center();
    let width = control(&harness, Role::Slider, "Sound on the timeline").rect().width();
    // Two seconds back, and three points beside the beat.
    let to = flag + vec2(3.0 - width / 4.0, 0.0);
    drag(&mut harness, flag, to);
    let snapped = harness.state().state.markers[0].secs;
    assert!((snapped - 4.0).abs() < 0.3 && beat(snapped) < 0.015, "{snapped}");
    // Far from every beat it stays where it was dropped.
    let flag = control(&harness, Role::Button, "Marker turn").rect().center();
    drag(&mut harness, flag, flag + vec2(width / 32.0, 0.0));
    let free = harness.state().state.markers[0].secs;
    assert!(beat(free) > 0.1, "{free}");
}
