//! The height of the timeline.

use egui::accesskit::Role;
use egui::{Rect, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use lovelock_project::tracks::{Key, Track};

use super::super::command::Command;
use super::playback::{State, screen_with, state, take, view, with_sound};
use super::{Shown, control, controls, double_click, drag};
use crate::window::timeline::{Recorded, View};

/// A small screen, and one that is lower than a timeline with its tracks.
const SMALL: Vec2 = vec2(1024.0, 700.0);
const LOW: Vec2 = vec2(640.0, 300.0);

fn with_rows(mut state: State, rows: usize, size: Vec2) -> Harness<'static, Shown<State>> {
    let track = |i: usize| Track {
        keys: vec![Key { secs: 0.0, value: vec![0.0] }, Key { secs: 8.0, value: vec![1.0] }],
        ..Track::new(format!("lights/{i}/intensity"))
    };
    state.tracks = (0..rows).map(track).collect();
    screen_with(size, state)
}

/// The lanes of the tracks that are visible, at least in part.
fn shown_tracks(harness: &Harness<'_, Shown<State>>) -> Vec<Rect> {
    let lanes = controls(harness, Role::Slider).into_iter().filter(|(name, _)| name.starts_with("Track "));
    let screen = harness.state().taken;
    lanes.map(|(_, lane)| lane).filter(|lane| screen.intersects(*lane) && lane.is_positive()).collect()
}

/// The button of a command, the ruler and the first track lie below the rest of the window, whole, one below the other.
fn check(harness: &Harness<'_, Shown<State>>, size: Vec2, what: &str) {
    let above = harness.state().state.above;
    let screen = Rect::from_min_size(egui::Pos2::ZERO, size);
    let ruler = control(harness, Role::Slider, "Time").rect();
    for command in [Command::JumpToStart, Command::PlayPause, Command::JumpToEnd] {
        let button = control(harness, Role::Button, command.info().expect("in the table").label).rect();
        assert!(
            screen.contains_rect(button) && button.top() >= above.bottom(),
            "{what}: {button:?} {above:?}"
        );
        assert!(button.bottom() <= ruler.top(), "{what}: {button:?} above {ruler:?}");
    }
    assert!(screen.contains_rect(ruler), "{what}: {ruler:?}");
    assert!(above.height() >= 0.25 * size.y, "{what}: {above:?}");
}

#[test]
fn the_transport_row_is_whole_with_any_number_of_tracks() {
    for size in [SMALL, LOW] {
        for rows in [0, 1, 2, 12] {
            let recording = || {
                state(View {
                    recording: Some(Recorded { from_secs: 1.0, secs: 2.5, kept_secs: 2.0 }),
                    ..view()
                })
            };
            for (what, state) in [
                ("dance", state(view())),
                ("take", state(take())),
                ("recording", recording()),
                ("sound", with_sound()),
            ] {
                let mut harness = with_rows(state, rows, size);
                harness.run_ok();
                let what = format!("{what}, {rows} tracks at {size:?}");
                check(&harness, size, &what);
                let tracks = shown_tracks(&harness);
                assert!(tracks.len() >= rows.min(1), "{what}: no track is visible");
                let ruler = control(&harness, Role::Slider, "Time").rect();
                assert!(
                    tracks.iter().all(|lane| lane.top() >= ruler.bottom()),
                    "{what}: {tracks:?} {ruler:?}"
                );
                if size == SMALL && rows <= 2 {
                    let screen = Rect::from_min_size(egui::Pos2::ZERO, size);
                    assert!(
                        tracks.len() == rows && tracks.iter().all(|lane| screen.contains_rect(*lane)),
                        "{what}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_edge_of_the_timeline_is_dragged_within_its_tracks() {
    let mut harness = with_rows(state(view()), 12, SMALL);
    let (edge, top) = ("Height of the timeline", |harness: &Harness<'_, Shown<State>>| {
        harness.state().state.above.bottom()
    });
    let start = top(&harness);
    let at = control(&harness, Role::Splitter, edge).rect().center();
    drag(&mut harness, at, at - vec2(0.0, 90.0));
    let raised = top(&harness);
    assert!((start - raised - 90.0).abs() < 2.0, "{start} to {raised}");
    // Neither the whole window nor less than one track.
    for (by, what) in [(-2000.0, "up"), (2000.0, "down")] {
        let at = control(&harness, Role::Splitter, edge).rect().center();
        drag(&mut harness, at, at + vec2(0.0, by));
        check(&harness, SMALL, what);
        assert!(!shown_tracks(&harness).is_empty());
    }
    assert!(top(&harness) > start);
    let at = control(&harness, Role::Splitter, edge).rect().center();
    double_click(&mut harness, at);
    assert_eq!(top(&harness), start, "it follows the tracks again");
    // Control: without tracks there is nothing to show more of.
    let bare = with_rows(state(view()), 0, SMALL);
    assert!(bare.query_by_role_and_label(Role::Splitter, edge).is_none());
}
