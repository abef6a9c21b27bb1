//! Keyboard shortcuts, menus and the list of keys.

use super::super::command::{COMMANDS, Command, CommandGroup, CommandInfo};
use egui::accesskit::Role;
use egui::{Key, Modifiers, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use egui_kittest::{Harness, Node};

use super::{Shown, screen_of};
use crate::window::keys;

/// A text field and a button, and the commands that keys requested.
fn screen() -> Harness<'static, Shown<(String, Vec<Command>)>> {
    screen_of(
        vec2(400.0, 300.0),
        (String::new(), Vec::new()),
        |ui, (typed, asked): &mut (String, Vec<Command>)| {
            asked.extend(keys::pressed(ui.ctx(), |_| true));
            let _ = ui.button("A button");
            let label = ui.label("Name");
            ui.text_edit_singleline(typed).labelled_by(label.id);
        },
    )
}

fn key(text: &str) -> (Modifiers, Key) {
    let mut modifiers = Modifiers::NONE;
    let mut parts: Vec<&str> = text.split('+').collect();
    let name = parts.pop().expect("a key");
    for part in parts {
        match part {
            "Ctrl" => modifiers |= Modifiers::COMMAND | Modifiers::CTRL,
            "Shift" => modifiers |= Modifiers::SHIFT,
            "Alt" => modifiers |= Modifiers::ALT,
            other => panic!("no modifier is called {other}"),
        }
    }
    // A question mark needs Shift on most keyboards.
    if name == "?" {
        return (modifiers | Modifiers::SHIFT, Key::Questionmark);
    }
    (modifiers, Key::from_name(name).expect("egui knows the key"))
}

#[test]
fn every_shortcut_runs_only_its_command() {
    let mut harness = screen();
    for info in COMMANDS {
        for text in info.shortcuts {
            let (modifiers, key) = key(text);
            harness.state_mut().state.1.clear();
            harness.key_press_modifiers(modifiers, key);
            harness.run();
            assert_eq!(harness.state().state.1, std::slice::from_ref(&info.command), "{text}");
        }
    }
}

#[test]
fn undo_counts_every_press_of_its_key_within_one_pass() {
    let mut harness = screen();
    for (name, times) in [("Ctrl+Z", 3), ("Ctrl+S", 1)] {
        let (modifiers, key) = key(name);
        harness.state_mut().state.1.clear();
        for _ in 0..3 {
            for pressed in [true, false] {
                let event = egui::Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
                // As one pass: the harness would make a pass of each event.
                harness.input_mut().events.push(event);
            }
        }
        harness.step();
        assert_eq!(harness.state().state.1.len(), times, "{name}: {:?}", harness.state().state.1);
    }
}

#[test]
fn letters_typed_in_a_text_field_are_not_shortcuts() {
    let mut harness = screen();
    harness.get_by_label("Name").click();
    harness.run();
    harness.key_press(Key::R);
    harness.key_press(Key::Space);
    harness.run();
    assert!(harness.state().state.1.is_empty());
    harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::CTRL, Key::S);
    harness.run();
    assert_eq!(harness.state().state.1, [Command::Save], "Ctrl+S saves from anywhere");
}

#[test]
fn undo_in_a_text_field_undoes_typing() {
    let mut harness = screen();
    harness.get_by_label("Name").click();
    harness.run();
    harness.event(egui::Event::Text("hair".to_owned()));
    harness.run();
    let ctrl = Modifiers::COMMAND | Modifiers::CTRL;
    for (modifiers, key) in [(ctrl, Key::Z), (ctrl | Modifiers::SHIFT, Key::Z), (ctrl, Key::Y)] {
        harness.key_press_modifiers(modifiers, key);
        harness.run();
        assert!(harness.state().state.1.is_empty(), "{key:?} is the text's: {:?}", harness.state().state.1);
    }
    // Outside text fields the same keys undo edits of the project.
    harness.get_by_label("A button").click();
    harness.run();
    harness.key_press_modifiers(ctrl, Key::Z);
    harness.run();
    assert_eq!(harness.state().state.1, [Command::Undo]);
}

#[test]
fn tab_hides_the_panels_and_other_keys_still_work() {
    let mut harness = screen();
    for _ in 0..3 {
        harness.state_mut().state.1.clear();
        harness.key_press(Key::Tab);
        harness.run();
        harness.key_press(Key::Space);
        harness.run();
        assert_eq!(harness.state().state.1, [Command::TogglePanels, Command::PlayPause]);
    }
}

#[test]
fn the_list_contains_every_key() {
    // What the dialog has at 1024 × 700, the smallest screen.
    let room = vec2(940.0, 620.0);
    let harness = screen_of(room, (), |ui, ()| keys::list(ui));
    for info in COMMANDS.iter().filter(|info| !info.shortcuts.is_empty()) {
        assert!(harness.query_by_label(&info.shortcuts.join("  ")).is_some(), "{}", info.id);
        assert!(harness.query_by_label(info.label).is_some(), "{}", info.id);
    }
    assert!(harness.query_by_label_contains("Double-click").is_some());
    let taken = harness.state().taken;
    assert!(taken.right() <= room.x && taken.bottom() <= room.y, "no row is cut: {taken:?}");
}

/// The entry of an open menu: its label and its key, if any.
pub(super) fn entry<'t, S>(harness: &'t Harness<'_, S>, info: &CommandInfo) -> Node<'t> {
    let label = info.label;
    let with_key = info.shortcuts.first().map(|key| format!("{label} {key}"));
    harness
        .query_all_by_role(Role::Button)
        .find(|node| {
            let name = node.accesskit_node().label().unwrap_or_default();
            name == label || Some(name) == with_key
        })
        .unwrap_or_else(|| panic!("no entry `{label}`"))
}

#[test]
fn menus_contain_every_command_once_and_disable_unavailable_ones() {
    let mut harness = screen_of(vec2(900.0, 700.0), None, |ui, chosen: &mut Option<Command>| {
        let enabled = |command: &Command| *command != Command::Undo;
        let asked =
            egui::MenuBar::new().ui(ui, |ui| keys::menus(ui, &mut keys::MenuKeys::default(), enabled)).inner;
        *chosen = asked.or(chosen.take());
    });
    for group in CommandGroup::ALL {
        for info in COMMANDS.iter().filter(|info| info.group == group) {
            harness.state_mut().state = None;
            harness.get_by_label(group.label()).click();
            harness.run();
            entry(&harness, info).click();
            harness.run();
            let wanted = (info.command != Command::Undo).then(|| info.command.clone());
            assert_eq!(harness.state().state, wanted, "{}", info.id);
            harness.key_press(Key::Escape);
            harness.run();
        }
    }
}
