//! The menu *Help*: manual, what is this, about; and the palette in the whole window.

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers};
use egui_kittest::kittest::Queryable;

use super::super::command::Command;
use super::control;
use super::whole::{CTRL, go, key, of, press_button, project, window};
use crate::window::manual::{place_of_control, place_of_setting};

#[test]
fn every_setting_of_the_palette_has_a_place_in_the_manual() {
    for entry in lovelock_project::project::settings_of("") {
        assert!(place_of_setting(&entry.path).is_some(), "{}", entry.path);
    }
    assert!(place_of_setting("hair.groom.nothing").is_none());
    for name in ["Add layer", "Save as style…", "Head joint", "Curl radius"] {
        assert!(place_of_control(name).is_some(), "{name}");
    }
    assert!(place_of_control("No such control").is_none() && place_of_control("").is_none());
}

#[test]
fn help_opens_the_manual_and_about_and_explains_a_control() {
    let mut harness = window();
    key(&mut harness, Modifiers::NONE, Key::F1);
    assert!(of(&harness).help.manual.is_open());
    assert!(
        harness.query_all_by_label("Five minutes with Lovelock").next().is_some(),
        "the contents of the guide"
    );
    key(&mut harness, Modifiers::NONE, Key::Escape);
    key(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(!of(&harness).help.manual.is_open());

    let ctx = harness.ctx.clone();
    harness.state_mut().state.as_mut().expect("a window").run(Command::About, &ctx);
    go(&mut harness);
    assert!(harness.query_by_label(env!("LOVELOCK_VERSION")).is_some());
    assert!(harness.query_by_label(env!("CARGO_PKG_LICENSE")).is_some());
    press_button(&mut harness, "Close");
    harness.state_mut().state.as_mut().expect("a window").run(Command::ReportProblem, &ctx);
    harness.step();
    let copied = harness.output().platform_output.commands.iter().find_map(|command| match command {
        egui::OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    let copied = copied.expect("a report");
    assert!(copied.contains(env!("LOVELOCK_VERSION")) && copied.contains("Changed settings:"), "{copied}");
    go(&mut harness);

    // A click on a control in this mode changes nothing and opens the entry of the control.
    let before = project(&harness);
    let slider = control(&harness, Role::Slider, "Length").rect().center();
    key(&mut harness, Modifiers::SHIFT, Key::F1);
    super::click_at(&mut harness, slider);
    assert_eq!(project(&harness), before);
    let here = of(&harness).help.manual.text_here();
    assert!(of(&harness).help.manual.is_open() && here.contains("groom.length"), "{here}");
    // Other controls are explained where the guide mentions them.
    key(&mut harness, Modifiers::NONE, Key::Escape);
    key(&mut harness, Modifiers::NONE, Key::Escape);
    let save = control(&harness, Role::Button, "Save as style…").rect().center();
    key(&mut harness, Modifiers::SHIFT, Key::F1);
    super::click_at(&mut harness, save);
    let here = of(&harness).help.manual.text_here();
    assert!(here.contains("Save as style"), "{here}");
}

#[test]
fn the_palette_keeps_its_size_and_shows_a_setting() {
    let mut harness = window();
    let height = |harness: &egui_kittest::Harness<'_, super::Shown<Option<crate::window::Window>>>| {
        let id = egui::Id::unique("palette");
        harness.ctx.memory(|memory| memory.area_rect(id)).map_or(0.0, |rect| rect.height())
    };
    key(&mut harness, CTRL, Key::K);
    let tall = height(&harness);
    assert!(tall > 320.0, "{tall}");
    harness.event(Event::Text("no such thing".to_owned()));
    go(&mut harness);
    assert!((height(&harness) - tall).abs() < 1.0);
    key(&mut harness, Modifiers::NONE, Key::Escape);
    key(&mut harness, CTRL, Key::K);
    assert!((height(&harness) - tall).abs() < 1.0, "it opens as tall as before");
    // The panels are hidden and the section is folded: both are mended.
    harness.state_mut().state.as_mut().expect("a window").layout.panels_hidden = true;
    harness.event(Event::Text("exposure".to_owned()));
    go(&mut harness);
    harness.key_press(Key::Enter);
    harness.run_steps(40);
    assert!(!of(&harness).layout.panels_hidden);
    assert!(harness.get_all_by_label("Exposure").any(|node| node.rect().is_positive()));
    // A layer is added by its name.
    key(&mut harness, Modifiers::NONE, Key::Escape);
    key(&mut harness, CTRL, Key::K);
    harness.event(Event::Text("braid".to_owned()));
    go(&mut harness);
    harness.key_press(Key::Enter);
    go(&mut harness);
    assert!(project(&harness).hair.stack.layers.iter().any(|layer| layer.operation.id() == "braid"));
}
