//! Rows of panels.

use egui::accesskit::Role;
use egui::{Event, Key, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use lovelock_base::settings::Unit;
use lovelock_project::Project;

use super::{Shown, click, controls, screen, tooltip_at, type_at};
use crate::window::control::{self, Number};

/// A row, and whether a dialog covers it.
fn row() -> Harness<'static, Shown<(f32, bool)>> {
    screen((0.27, false), |ui, (value, dialog): &mut (f32, bool)| {
        let number = Number::new("Length", 0.02..=0.7, Unit::METRES_AS_CM, "Length of the longest hair.");
        number.show(ui, value, 0.27);
        if *dialog {
            egui::Modal::new(egui::Id::unique("over")).show(ui.ctx(), |ui| {
                ui.set_width(20.0);
                ui.label("!");
            });
        }
    })
}

#[test]
fn a_number_tells_screen_readers_its_range_and_its_unit() {
    let harness = row();
    let field = harness.get_by_role_and_label(Role::SpinButton, "Length");
    let field = field.accesskit_node();
    assert_eq!((field.min_numeric_value(), field.max_numeric_value()), (Some(2.0), Some(70.0)));
    let rail = harness.get_by_role_and_label(Role::Slider, "Length");
    let rail = rail.accesskit_node();
    let said = rail.value().unwrap_or_default();
    assert!(said.starts_with("27") && said.ends_with(" cm"), "{said}");
    if cfg!(target_os = "linux") {
        assert_eq!(rail.description(), Some(format!("{said}. Length of the longest hair.")));
    }
}

#[test]
fn a_typed_number_applies_on_enter() {
    let mut harness = row();
    let field = controls(&harness, Role::SpinButton)[0].1.center();
    click(&mut harness, field);
    harness.event(Event::Text("3".to_owned()));
    harness.run_ok();
    assert_eq!(harness.state().state.0.to_bits(), 0.27_f32.to_bits(), "3 may be the start of 30");
    harness.key_press(Key::Escape);
    harness.run_ok();
    assert_eq!(harness.state().state.0.to_bits(), 0.27_f32.to_bits(), "Escape leaves what was there");
    type_at(&mut harness, field, "30 cm");
    assert!((harness.state().state.0 - 0.3).abs() < 1e-6, "{}", harness.state().state.0);
}

#[test]
fn a_number_beyond_its_range_is_brought_into_it_and_says_so() {
    let mut harness = row();
    let field = controls(&harness, Role::SpinButton)[0].1.center();
    type_at(&mut harness, field, "90");
    assert!((harness.state().state.0 - 0.7).abs() < 1e-6, "{}", harness.state().state.0);
    let said = control::said(&harness.ctx);
    assert_eq!(said, ["Length: found 90 cm; must be 2 to 70 cm. It is set to 70 cm."]);
    // A number within the range says nothing.
    type_at(&mut harness, field, "69.5");
    assert!((harness.state().state.0 - 0.695).abs() < 1e-6, "{}", harness.state().state.0);
    assert!(control::said(&harness.ctx).is_empty());
    // Settings can be typed beyond their sliders.
    let mut harness = screen(Project::default(), |ui, project| {
        control::settings(ui, &["length", "wisps"], &mut project.hair.groom, &Project::default().hair.groom);
    });
    let fields: Vec<_> = controls(&harness, Role::SpinButton).iter().map(|(_, rect)| rect.center()).collect();
    type_at(&mut harness, fields[0], "90");
    assert!((harness.state().state.hair.groom.length - 0.9).abs() < 1e-6, "the setting goes to 1 m");
    assert!(control::said(&harness.ctx).is_empty());
    type_at(&mut harness, fields[1], "5000");
    assert_eq!(harness.state().state.hair.groom.wisps, 1000);
    assert_eq!(control::said(&harness.ctx), ["Wisps: found 5000; must be 8 to 1000. It is set to 1000."]);
}

#[test]
fn a_dialog_hides_the_tooltip_under_it() {
    let mut harness = row();
    let rail = controls(&harness, Role::Slider)[0].1;
    // Away from the centre of the screen, where the dialog is.
    let at = rail.left_center() + vec2(4.0, 0.0);
    assert!(tooltip_at(&mut harness, at).is_some());
    harness.hover_at(at);
    harness.run_steps(4);
    assert!(super::tooltip(&harness).is_some());
    harness.state_mut().state.1 = true;
    harness.run_steps(4);
    assert_eq!(super::tooltip(&harness), None);
}
