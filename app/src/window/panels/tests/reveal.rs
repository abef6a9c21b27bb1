//! The palette jumps to the control of a setting.

use egui::{ScrollArea, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use lovelock_base::settings::Info;
use lovelock_project::Project;
use lovelock_project::project::settings_of;

use super::{Bench, titles};
use crate::window::control::{self, section};
use crate::window::testing::{Shown, screen_of};

/// All panels, folded, in a column of the height of a small window.
struct Column {
    bench: Bench,
    /// What is asked for after the panels, as the palette does.
    asked: Option<&'static Info>,
    /// The settings that were not found.
    missing: Vec<&'static str>,
}

fn panels() -> Harness<'static, Shown<Column>> {
    let state = Column { bench: Bench::new(Project::default()), asked: None, missing: Vec::new() };
    screen_of(vec2(300.0, 500.0), state, |ui, Column { bench, asked, missing }: &mut Column| {
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            for title in titles() {
                section(ui, title, false, |ui| bench.show(ui, title));
            }
        });
        if let Some(info) = asked.take() {
            control::reveal(ui.ctx(), info);
        }
        missing.extend(control::end_reveal(ui.ctx()).map(|info| info.name));
    })
}

fn show(harness: &mut Harness<'_, Shown<Column>>, path: &str) {
    let entry = settings_of("").into_iter().find(|entry| entry.path == path).expect("a setting");
    harness.state_mut().state.asked = Some(entry.info);
    harness.run_steps(40);
}

#[test]
fn a_setting_is_unfolded_scrolled_to_and_focused() {
    let mut harness = panels();
    for (path, label) in [
        ("hair.groom.curl_radius", "Curl radius"),
        ("simulation.wind.speed", "Wind speed"),
        ("picture.exposure_stops", "Exposure"),
        ("hair.groom.length", "Length"),
    ] {
        let before = harness.query_all_by_label(label).count();
        assert!(before == 0 || path.ends_with("length"), "{label} is folded before");
        show(&mut harness, path);
        assert!(harness.state().state.missing.is_empty(), "{path}: {:?}", harness.state().state.missing);
        #[expect(clippy::redundant_closure_for_method_calls, reason = "the method is not general enough")]
        let focused = harness.query_all_by(|node| node.is_focused()).find(|node| node.rect().is_positive());
        let rect = focused.unwrap_or_else(|| panic!("{path}: nothing is focused")).rect();
        assert!(rect.top() >= 0.0 && rect.bottom() <= 500.0, "{path}: {rect}");
        let named =
            harness.get_all_by_label(label).any(|node| node.rect().y_range().intersects(rect.y_range()));
        assert!(named, "{path}: the control beside the label is focused");
    }
}

#[test]
fn a_setting_without_a_control_says_so() {
    let mut harness = panels();
    show(&mut harness, "camera.distance");
    assert_eq!(harness.state().state.missing, ["distance"]);
    // Nothing was unfolded by looking for it.
    assert_eq!(harness.query_all_by_label("Wind speed").count(), 0);
}
