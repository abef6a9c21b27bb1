//! Names of keys in the table of commands, and the keys of egui.

use egui::{Key, KeyboardShortcut, Modifiers};

use crate::window::command::Shortcut;

/// The key of a name such as `Ctrl+Shift+Z`; `None` if there is none.
pub(crate) fn shortcut(text: &str) -> Option<KeyboardShortcut> {
    let Shortcut { ctrl, shift, alt, key } = Shortcut::parse(text)?;
    let logical = key_of(key)?;
    let mut modifiers = Modifiers::NONE;
    modifiers.command = ctrl;
    modifiers.shift = shift;
    modifiers.alt = alt;
    Some(KeyboardShortcut::new(modifiers, logical))
}

fn key_of(name: &str) -> Option<Key> {
    match name {
        "Left" => Some(Key::ArrowLeft),
        "Right" => Some(Key::ArrowRight),
        "?" => Some(Key::Questionmark),
        name => Key::from_name(name),
    }
}

/// The name of a key that was pressed.
pub(crate) fn name_of(pressed: Modifiers, key: Key) -> String {
    let name = match key {
        Key::Questionmark => "?",
        Key::OpenBracket => "[",
        Key::CloseBracket => "]",
        Key::Comma => ",",
        Key::Period => ".",
        other => other.name(),
    };
    // These signs need Shift on many keyboards.
    let is_sign = matches!(key, Key::Questionmark | Key::OpenBracket | Key::CloseBracket | Key::Plus);
    let parts = [(pressed.command, "Ctrl"), (pressed.shift && !is_sign, "Shift"), (pressed.alt, "Alt")];
    let mut text = String::new();
    for (_, part) in parts.into_iter().filter(|(held, _)| *held) {
        text.push_str(part);
        text.push('+');
    }
    text.push_str(name);
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::command::COMMANDS;

    #[test]
    fn every_key_of_the_table_has_its_name() {
        for info in COMMANDS {
            for text in info.shortcuts {
                let KeyboardShortcut { modifiers, logical_key } = shortcut(text).expect("a key");
                assert_eq!(name_of(modifiers, logical_key), *text, "{}", info.id);
            }
        }
    }

    #[test]
    fn every_key_can_be_named() {
        for key in Key::ALL {
            let name = name_of(Modifiers::COMMAND | Modifiers::SHIFT, *key);
            let read = shortcut(&name).unwrap_or_else(|| panic!("{name}"));
            assert_eq!(read.logical_key, *key, "{name}");
        }
    }
}
