//! Controls that are moved while the dance plays, in the whole window.

use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

use super::whole::{CTRL, key, of, project, wait, window};
use super::{Shown, control, press};
use crate::window::Window;

fn position(window: &Window) -> f64 {
    window.session.frame.as_ref().map_or(0.0, |frame| frame.position_secs)
}

/// Holds the slider of the extinction scale and moves it to the right while time passes.
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
fn a_slider_that_is_moved_while_the_dance_plays_becomes_a_track() {
    let mut harness = window();
    wait(&mut harness, "a frame", |window| window.session.frame.is_some());
    let before = project(&harness);
    key(&mut harness, Modifiers::NONE, Key::W);
    assert!(of(&harness).overdub.is_armed());
    ride(&mut harness);
    let written = project(&harness);
    let [track] = written.timeline.tracks.as_slice() else { panic!("{:?}", written.timeline.tracks) };
    assert_eq!(track.target, "shadow/extinction_scale");
    let [low, high] = track.range()[0];
    assert!(high > low && track.keys.len() >= 3, "{track:?}");
    assert_eq!(written.shadow, before.shadow, "the project's own value stays");
    assert_eq!(of(&harness).history.undo_len(), 1, "one ride is one step");

    // What is drawn follows it, and so does the panel.
    key(&mut harness, Modifiers::NONE, Key::W);
    wait(&mut harness, "a picture at another value", |window| {
        window.session.drawn.as_ref().is_some_and(|(drawn, frame, _)| {
            let track = &window.history.project().timeline.tracks[0];
            let at = track.value_at(frame.position_secs).map_or(0.0, |value| value[0]);
            (f64::from(drawn.shadow.extinction_scale) - at).abs() < 1e-5 && at > low + 0.5 * (high - low)
        })
    });
    let shown = of(&harness).seen.as_ref().map(|seen| seen.project.shadow.extinction_scale);
    assert!(shown.is_some_and(|shown| shown != before.shadow.extinction_scale));

    // A track that plays is not moved by hand, and the window says so.
    ride(&mut harness);
    assert_eq!(project(&harness).timeline, written.timeline);
    assert!(harness.query_by_label_contains("follows its track").is_some());
    key(&mut harness, CTRL, Key::Z);
    assert_eq!(project(&harness), before);
}
