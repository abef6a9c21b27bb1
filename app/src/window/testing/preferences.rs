//! Preferences: keys, scale and theme.

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, vec2};
use egui_kittest::kittest::{NodeT, Queryable};

use super::super::command::{COMMANDS, Command};
use super::whole::{CTRL, go, key, of, press_button, window};
use super::{control, screen_of};
use crate::window::keymap::{Keymap, Preset};
use crate::window::{keys, theme};

/// The window with the dialog open.
fn opened() -> super::whole::Whole {
    let mut harness = window();
    key(&mut harness, CTRL, Key::Comma);
    assert!(of(&harness).preferences.is_open());
    harness
}

fn info(command: &Command) -> &'static super::super::command::CommandInfo {
    command.info().expect("in the table")
}

#[test]
fn a_key_is_added_by_pressing_it_and_then_runs_its_command() {
    let mut harness = opened();
    harness.get_by_label("Search keys").click();
    go(&mut harness);
    harness.event(Event::Text("frame the hair".to_owned()));
    go(&mut harness);
    assert!(harness.query_by_label("Add a key to Quit").is_none(), "only what was searched");
    press_button(&mut harness, "Add a key to Frame the hair");
    assert!(of(&harness).preferences.takes_key());
    // It would close the dialog or run a command otherwise.
    key(&mut harness, CTRL, Key::Comma);
    let frame = info(&Command::FrameHair);
    assert_eq!(of(&harness).layout.keys.keys(frame), ["F", "Ctrl+,"]);
    assert!(of(&harness).preferences.is_open());
    // The conflict is shown, and removed where it is shown.
    assert!(harness.query_by_label_contains("in conflict with Preferences").is_some());
    let conflict = harness.get_by_label_contains("in conflict with Preferences");
    conflict.click();
    go(&mut harness);
    assert_eq!(of(&harness).layout.keys, Keymap::default());
    press_button(&mut harness, "Add a key to Frame the hair");
    key(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(of(&harness).preferences.is_open(), "Escape cancels only the wait for a key");
    press_button(&mut harness, "Add a key to Frame the hair");
    key(&mut harness, CTRL, Key::J);
    assert_eq!(of(&harness).layout.keys.keys(frame), ["F", "Ctrl+J"]);
    key(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(!of(&harness).preferences.is_open());
    let stored = of(&harness).stored_layout();
    assert_eq!(stored.keys, of(&harness).layout.keys, "kept between runs");
}

#[test]
fn changed_keys_run_their_commands_and_stand_in_menus() {
    let mut keymap = Keymap::default();
    let play = info(&Command::PlayPause);
    keymap.remove(play, "Space");
    keymap.add(play, "J");
    let state: Vec<Command> = Vec::new();
    let mut harness = screen_of(vec2(900.0, 700.0), state, move |ui, asked| {
        keymap.begin(ui.ctx());
        asked.extend(keys::pressed(ui.ctx(), |_| true));
        let mut menus = keys::MenuKeys::default();
        egui::MenuBar::new().ui(ui, |ui| keys::menus(ui, &mut menus, |_| true));
    });
    harness.key_press(Key::Space);
    harness.key_press(Key::J);
    harness.run();
    assert_eq!(harness.state().state, [Command::PlayPause]);
    harness.get_by_label("Playback").click();
    harness.run();
    let name = |node: egui_kittest::Node<'_>| node.accesskit_node().label().unwrap_or_default();
    assert!(harness.query_all_by_role(Role::Button).any(|node| name(node) == format!("{} J", play.label)));
}

#[test]
fn presets_change_the_keys_of_other_programs() {
    let mut keymap = Keymap::default();
    keymap.set_preset(Preset::Blender);
    let mut harness = screen_of(vec2(400.0, 300.0), Vec::new(), move |ui, asked: &mut Vec<Command>| {
        keymap.begin(ui.ctx());
        asked.extend(keys::pressed(ui.ctx(), |_| true));
    });
    harness.key_press(Key::Home);
    harness.key_press_modifiers(Modifiers::SHIFT, Key::ArrowLeft);
    harness.run();
    assert_eq!(harness.state().state, [Command::FrameHair, Command::JumpToStart]);
}

#[test]
fn keys_scale_the_interface_and_the_theme_can_be_light() {
    let mut harness = window();
    // A plus needs Shift on many keyboards.
    key(&mut harness, CTRL | Modifiers::SHIFT, Key::Plus);
    assert_eq!(of(&harness).layout.scale, 1.1);
    assert!((harness.ctx.zoom_factor() - 1.1).abs() < 0.01);
    key(&mut harness, CTRL, Key::Num0);
    for _ in 0..20 {
        key(&mut harness, CTRL, Key::Minus);
    }
    assert_eq!((of(&harness).layout.scale, harness.ctx.zoom_factor()), (0.75, 0.75));
    key(&mut harness, CTRL, Key::Num0);
    assert_eq!(harness.ctx.zoom_factor(), 1.0);
    key(&mut harness, CTRL, Key::Comma);
    control(&harness, Role::RadioButton, "Light").click();
    go(&mut harness);
    assert_eq!(of(&harness).layout.theme, theme::Choice::Light);
    assert_eq!(harness.ctx.theme(), egui::Theme::Light);
    // In the dialog the keys of the scale act, too.
    key(&mut harness, CTRL, Key::Equals);
    assert_eq!(of(&harness).layout.scale, 1.1);
    assert!(of(&harness).preferences.is_open());
}

#[test]
fn every_command_of_the_table_can_get_a_key() {
    let harness = opened();
    let listed = COMMANDS
        .iter()
        .filter(|info| harness.query_all_by_label(&format!("Add a key to {}", info.label)).next().is_some());
    assert_eq!(listed.count(), COMMANDS.len());
}
