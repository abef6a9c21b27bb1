//! Properties of every control of every panel.

use egui::accesskit::Role;
use egui::pos2;

use lovelock_testkit::suite::{is_long, sample};

use super::{panel, projects, titles};
use crate::window::testing::{
    WIDTH, control, controls, double_click, drag, is_marked, texts, tooltip_at, type_at,
};

/// The roles of controls that change a value.
const ROLES: [Role; 7] = [
    Role::Slider,
    Role::SpinButton,
    Role::ComboBox,
    Role::CheckBox,
    Role::ColorWell,
    Role::Button,
    Role::TextInput,
];

#[test]
fn every_control_has_a_name_and_a_tooltip() {
    // Statistics has no controls.
    for title in titles().filter(|title| *title != "Statistics") {
        for (name, project) in sample([&projects()[3], &projects()[0]], 2) {
            let mut harness = panel(title, project.clone());
            for role in ROLES {
                for (label, rect) in controls(&harness, role) {
                    assert!(
                        !label.trim().is_empty(),
                        "{title}, {name}: a {role:?} without a name at {rect:?}"
                    );
                    let said = tooltip_at(&mut harness, rect.center());
                    let said =
                        said.unwrap_or_else(|| panic!("{title}, {name}: no tooltip on {role:?} {label}"));
                    assert!(said.trim().len() > 2, "{title}: {label}: {said:?}");
                }
            }
        }
    }
}

#[test]
fn panels_fit_the_width() {
    for (place, title) in titles().enumerate() {
        // In the short suite each panel with every third project, not all with the same.
        let first = if is_long() { 0 } else { place % 3 };
        for (name, project) in sample(projects().into_iter().skip(first), 3) {
            let harness = panel(title, project);
            let right = harness.state().taken.right();
            assert!(right <= WIDTH, "{title}, {name}: reaches {right}");
            for role in ROLES {
                for (label, rect) in controls(&harness, role) {
                    assert!(
                        rect.right() <= WIDTH && rect.left() >= 0.0,
                        "{title}, {name}: {label} at {rect:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn typed_numbers_stay_in_range() {
    for title in titles() {
        for (name, project) in sample([&projects()[3], &projects()[0]], 2) {
            let mut harness = panel(title, project.clone());
            let count = controls(&harness, Role::SpinButton).len();
            for i in sample(0..count, 4) {
                let first = if is_long() { 0 } else { i / 4 % 3 };
                for text in
                    sample(["1e300", "nan", "0", "-1e300", "-inf", "words"].into_iter().skip(first), 3)
                {
                    harness.state_mut().state.project = project.clone();
                    harness.run();
                    let (label, rect) = controls(&harness, Role::SpinButton)[i].clone();
                    type_at(&mut harness, rect.center(), text);
                    let after = &harness.state().state.project;
                    let (sanitised, problems) = after.sanitised();
                    assert!(problems.is_empty(), "{title}, {name}: {label} from `{text}`: {problems:?}");
                    assert!(*after == sanitised, "{title}, {name}: {label} from `{text}` is not finite");
                    if matches!(text, "nan" | "-inf" | "words") {
                        assert!(after == project, "{title}, {name}: {label} took `{text}`");
                    }
                }
            }
        }
    }
}

#[test]
fn dragged_sliders_stay_in_range() {
    for title in titles() {
        for (name, project) in sample([&projects()[3], &projects()[0]], 2) {
            let mut harness = panel(title, project.clone());
            let count = controls(&harness, Role::Slider).len();
            for i in sample(0..count, 5) {
                for x in [-1e5, 1e5] {
                    harness.state_mut().state.project = project.clone();
                    harness.run();
                    let (label, rect) = controls(&harness, Role::Slider)[i].clone();
                    drag(&mut harness, rect.center(), pos2(x, rect.center().y));
                    let after = &harness.state().state.project;
                    let (sanitised, problems) = after.sanitised();
                    assert!(problems.is_empty(), "{title}, {name}: {label} dragged to {x}: {problems:?}");
                    assert!(*after == sanitised, "{title}, {name}: {label} dragged to {x}");
                    let right = harness.state().taken.right();
                    assert!(
                        right <= WIDTH,
                        "{title}, {name}: {label} dragged to {x} makes the panel reach {right}"
                    );
                }
            }
        }
    }
}

#[test]
fn changed_values_are_marked_and_a_double_click_restores_them() {
    // The settings of brushes are no part of the project.
    for title in titles().filter(|title| *title != "Brushes") {
        for (name, project) in sample([&projects()[3], &projects()[0], &projects()[1]], 3) {
            let mut harness = panel(title, project.clone());
            let sliders = controls(&harness, Role::Slider);
            for i in sample(0..sliders.len(), 4) {
                // There are three places to double-click: the rail, the number and the name.
                let first = if is_long() { 0 } else { i / 4 % 3 };
                for place in sample(first..3, 3) {
                    harness.state_mut().state.project = project.clone();
                    harness.run();
                    let (label, rail) = controls(&harness, Role::Slider)[i].clone();
                    let number = controls(&harness, Role::SpinButton).into_iter().find(|(_, number)| {
                        number.intersects(rail.translate(egui::vec2(rail.width() + 10.0, 0.0)))
                    });
                    // The sphere of a light has no number.
                    let Some((_, number)) = number else { continue };
                    let marked_before = is_marked(&harness, &label);
                    // If the value is at one end of its range already, the other end differs.
                    for end in [rail.right_center(), rail.left_center()] {
                        if harness.state().state.project == *project {
                            drag(&mut harness, rail.center(), end);
                        }
                    }
                    let changed = harness.state().state.project.clone();
                    assert!(changed != *project, "{title}, {name}: {label} changes nothing");
                    assert!(
                        is_marked(&harness, &label),
                        "{title}, {name}: {label} differs and is not marked"
                    );
                    let name_at = texts(&harness)
                        .into_iter()
                        .find(|(text, rect, _)| *text == label && rect.y_range().contains(rail.center().y))
                        .expect("the name")
                        .1;
                    let at = [rail.center(), number.center(), name_at.center()][place];
                    if place == 2 {
                        let said = tooltip_at(&mut harness, at).unwrap_or_default();
                        assert!(said.contains("double-click"), "{title}: {label}: {said:?}");
                    }
                    double_click(&mut harness, at);
                    let after = &harness.state().state.project;
                    assert!(
                        !is_marked(&harness, &label),
                        "{title}, {name}: {label} stays marked, place {place}"
                    );
                    if !marked_before {
                        assert!(after == project, "{title}, {name}: {label} is not restored, place {place}");
                    }
                    // The number field may still have the keyboard focus.
                    harness.key_press(egui::Key::Escape);
                    harness.run();
                }
            }
        }
    }
}

#[test]
fn the_default_project_has_no_marked_controls() {
    let project = projects()[0].1.clone();
    assert!(project == lovelock_project::Project::default());
    for title in titles() {
        let harness = panel(title, project.clone());
        let sliders = controls(&harness, Role::Slider);
        let boxes = controls(&harness, Role::CheckBox);
        let combos = controls(&harness, Role::ComboBox);
        for (label, _) in sliders.iter().chain(&boxes).chain(&combos) {
            assert!(!is_marked(&harness, label), "{title}: {label} is marked");
        }
    }
}

#[test]
fn controls_show_their_units() {
    let harness = panel("Hairstyle", projects()[0].1.clone());
    let length = control(&harness, Role::SpinButton, "Length").value().expect("a number");
    assert!(length.ends_with(" cm"), "{length}");
    let harness = panel("Light", projects()[0].1.clone());
    let azimuth = control(&harness, Role::SpinButton, "Azimuth").value().expect("a number");
    assert!(azimuth.ends_with('°'), "{azimuth}");
}
