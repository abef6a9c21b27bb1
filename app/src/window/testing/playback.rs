//! The timeline.

use egui::accesskit::Role;
use egui::{Rect, pos2, vec2};
use egui_kittest::Harness;
use lovelock_studio::Command;

use super::{Shown, click, control, drag, screen_of, tooltip_at};
use crate::window::timeline::{self, Ask, View};

fn bar(view: View) -> Harness<'static, Shown<(View, Vec<Ask>)>> {
    screen_of(vec2(900.0, 44.0), (view, Vec::new()), |ui, (view, asked): &mut (View, Vec<Ask>)| {
        asked.extend(timeline::ui(ui, *view));
    })
}

const VIEW: View = View { time_secs: 2.0, duration_secs: 8.0, playing: true, looping: true };

#[test]
fn every_button_asks_for_its_command() {
    let mut harness = bar(VIEW);
    for command in [
        Command::JumpToStart,
        Command::StepBack,
        Command::PlayPause,
        Command::StepForward,
        Command::JumpToEnd,
    ] {
        let rect = control(&harness, Role::Button, command.info().label).rect();
        harness.state_mut().state.1.clear();
        click(&mut harness, rect.center());
        assert_eq!(harness.state().state.1, [Ask::Run(command)]);
        let said = tooltip_at(&mut harness, rect.center()).expect("a tooltip");
        assert!(said.contains(command.info().shortcuts[0]), "{command:?}: {said}");
    }
    harness.state_mut().state.1.clear();
    let rect = control(&harness, Role::CheckBox, "Loop").rect();
    click(&mut harness, rect.center());
    assert_eq!(harness.state().state.1, [Ask::Run(Command::ToggleLoop)]);
}

#[test]
fn a_click_goes_to_its_time_and_a_drag_stays_inside() {
    let mut harness = bar(VIEW);
    let rect: Rect = control(&harness, Role::Slider, "Time").rect();
    click(&mut harness, rect.center());
    let Some(Ask::Seek(secs)) = harness.state().state.1.last().copied() else {
        panic!("no time was asked for")
    };
    // A point of the bar is a hundredth of a second here.
    assert!((secs - 4.0).abs() < 0.02, "{secs}");
    drag(&mut harness, rect.center(), pos2(1e6, rect.center().y));
    assert_eq!(harness.state().state.1.last(), Some(&Ask::Seek(8.0)));
    drag(&mut harness, rect.center(), pos2(-1e6, rect.center().y));
    assert_eq!(harness.state().state.1.last(), Some(&Ask::Seek(0.0)));
    let said = tooltip_at(&mut harness, rect.center() + vec2(40.0, 0.0));
    assert!(said.is_some(), "the bar says what it does");
}

#[test]
fn a_dance_of_no_length_and_one_of_days_are_shown() {
    for (time_secs, duration_secs) in
        [(0.0, 0.0), (5.0, 0.0), (1e6, 3e5), (f64::NAN, f64::NAN), (0.5, 1.0 / 60.0)]
    {
        let mut harness = bar(View { time_secs, duration_secs, ..VIEW });
        let rect = control(&harness, Role::Slider, "Time").rect();
        click(&mut harness, rect.center());
        for ask in &harness.state().state.1 {
            assert!(matches!(ask, Ask::Seek(secs) if secs.is_finite()), "{duration_secs}: {ask:?}");
        }
        assert!(harness.state().taken.right() <= 900.0);
    }
}
