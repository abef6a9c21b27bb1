//! Which keys run which command: those of the table of commands, changed by a preset and by the user.

mod names;
mod preset;

use std::collections::BTreeMap;
use std::sync::Arc;

use egui::{Context, Id, KeyboardShortcut};
use serde::{Deserialize, Serialize};

use super::command::{COMMANDS, CommandGroup, CommandInfo};

pub(crate) use names::{name_of, shortcut};
pub(crate) use preset::{Navigation, Preset};

/// The most keys of one command.
pub(crate) const MAX_KEYS: usize = 4;

/// The keys of commands, as they are stored between runs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(crate) struct Keymap {
    preset: Preset,
    /// The keys of commands that the user changed, by the id of the command.
    changed: BTreeMap<String, Vec<String>>,
}

impl Keymap {
    /// The keys of a command, the first one for menus.
    pub(crate) fn keys<'k>(&'k self, info: &'k CommandInfo) -> Vec<&'k str> {
        match self.changed.get(info.id) {
            Some(own) => own.iter().map(String::as_str).filter(|text| shortcut(text).is_some()).collect(),
            None => self.preset.keys(info).to_vec(),
        }
    }

    /// The key for menus.
    pub(crate) fn first(&self, info: &CommandInfo) -> Option<String> {
        self.keys(info).first().map(|key| (*key).to_owned())
    }

    /// Whether the user changed the keys of a command.
    pub(crate) fn is_changed(&self, info: &CommandInfo) -> bool {
        self.changed.contains_key(info.id)
    }

    /// Whether the user changed any key.
    pub(crate) fn has_changes(&self) -> bool {
        !self.changed.is_empty()
    }

    /// The preset below the user's changes.
    pub(crate) fn preset(&self) -> Preset {
        self.preset
    }

    /// Takes another preset. The user's changes stay.
    pub(crate) fn set_preset(&mut self, preset: Preset) {
        self.preset = preset;
    }

    /// Adds a key to a command, as its last.
    pub(crate) fn add(&mut self, info: &CommandInfo, key: &str) {
        let mut keys: Vec<String> = self.keys(info).into_iter().map(str::to_owned).collect();
        if shortcut(key).is_some() && keys.len() < MAX_KEYS && !keys.iter().any(|known| is_same(known, key)) {
            keys.push(key.to_owned());
            self.set(info, keys);
        }
    }

    /// Takes a key from a command.
    pub(crate) fn remove(&mut self, info: &CommandInfo, key: &str) {
        let keys = self.keys(info).into_iter().filter(|known| !is_same(known, key)).map(str::to_owned);
        let keys = keys.collect();
        self.set(info, keys);
    }

    fn set(&mut self, info: &CommandInfo, keys: Vec<String>) {
        if keys == self.preset.keys(info) {
            self.changed.remove(info.id);
        } else {
            self.changed.insert(info.id.to_owned(), keys);
        }
    }

    /// Restores the keys of a command to those of the preset.
    pub(crate) fn restore(&mut self, info: &CommandInfo) {
        self.changed.remove(info.id);
    }

    /// Restores the keys of all commands to those of the preset.
    pub(crate) fn restore_all(&mut self) {
        self.changed.clear();
    }

    /// What else a key of `info` does: the name of another command, or of what the window itself does with it.
    pub(crate) fn conflict(&self, info: &CommandInfo, key: &str) -> Option<String> {
        let wanted = shortcut(key)?;
        if let Some(use_of) = fixed_use(wanted) {
            return Some(use_of);
        }
        let others = COMMANDS.iter().filter(|other| other.id != info.id);
        let mut same =
            others.filter(|other| self.keys(other).iter().any(|known| shortcut(known) == Some(wanted)));
        same.next().map(|other| other.label.to_owned())
    }

    /// The number of keys that stand for more than one thing.
    pub(crate) fn conflicts(&self) -> usize {
        let keys = COMMANDS.iter().flat_map(|info| self.keys(info).into_iter().map(move |key| (info, key)));
        keys.filter(|(info, key)| self.conflict(info, key).is_some()).count()
    }

    /// Uses these keys in the passes of a context.
    pub(crate) fn begin(&self, ctx: &Context) {
        let known = ctx.data(|data| data.get_temp::<Arc<Self>>(Self::place()));
        if known.is_none_or(|known| *known != *self) {
            ctx.data_mut(|data| data.insert_temp(Self::place(), Arc::new(self.clone())));
        }
    }

    /// The keys in use.
    pub(crate) fn of(ctx: &Context) -> Arc<Self> {
        ctx.data(|data| data.get_temp(Self::place())).unwrap_or_default()
    }

    fn place() -> Id {
        Id::unique("keymap")
    }
}

fn is_same(one: &str, other: &str) -> bool {
    shortcut(one).is_some_and(|key| Some(key) == shortcut(other))
}

/// What the window itself does with a key, whatever the commands.
fn fixed_use(KeyboardShortcut { modifiers, logical_key }: KeyboardShortcut) -> Option<String> {
    let with = (modifiers.command, modifiers.alt, modifiers.shift);
    match (with, logical_key) {
        (_, egui::Key::Escape) => Some("Return to the image".to_owned()),
        ((false, false, _), egui::Key::F6) => Some("Next area of the window".to_owned()),
        ((false, false, true), egui::Key::F10) => Some("Menu of a control".to_owned()),
        ((false, false, true), egui::Key::Tab) => Some("Previous control".to_owned()),
        ((false, false, false), egui::Key::V) => Some("Show another pane".to_owned()),
        ((false, false, _), egui::Key::B) => Some("Change the size of the brush".to_owned()),
        ((false, true, false), key) => {
            let menus = CommandGroup::ALL.map(|group| (group.letter(), group.label()));
            let menus = menus.into_iter().chain([('R', "Recent"), ('I', "Image size")]);
            let mut menus = menus.filter(|(letter, _)| key.name() == letter.to_string());
            menus.next().map(|(_, name)| format!("Open the menu {name}"))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn info(id: &str) -> &'static CommandInfo {
        COMMANDS.iter().find(|info| info.id == id).expect("a command")
    }

    #[test]
    fn presets_have_no_conflicts_and_only_commands_that_exist() {
        for preset in Preset::ALL {
            let mut keymap = Keymap::default();
            keymap.set_preset(preset);
            for known in COMMANDS {
                for key in keymap.keys(known) {
                    assert!(shortcut(key).is_some(), "{preset:?}: {key}");
                    assert_eq!(keymap.conflict(known, key), None, "{preset:?}: {} {key}", known.id);
                }
            }
            for id in preset.ids() {
                assert!(COMMANDS.iter().any(|info| info.id == id), "{preset:?}: {id}");
            }
            assert_eq!(keymap.conflicts(), 0);
        }
    }

    #[test]
    fn a_key_that_two_commands_have_is_a_conflict_of_both() {
        let mut keymap = Keymap::default();
        let (frame, play) = (info("frame-hair"), info("play-pause"));
        keymap.add(frame, "Space");
        assert_eq!(keymap.keys(frame), ["F", "Space"]);
        assert_eq!(keymap.conflict(frame, "Space").as_deref(), Some(play.label));
        assert_eq!(keymap.conflict(play, "Space").as_deref(), Some(frame.label));
        assert_eq!(keymap.conflicts(), 2);
        assert_eq!(keymap.conflict(frame, "Alt+V").as_deref(), Some("Open the menu View"));
        keymap.remove(play, "Space");
        assert!(keymap.keys(play).is_empty() && keymap.is_changed(play));
        assert_eq!(keymap.conflicts(), 0);
        keymap.remove(frame, "Space");
        assert!(!keymap.is_changed(frame), "the keys of the preset are no change");
        keymap.restore(play);
        assert!(!keymap.has_changes());
    }

    #[test]
    fn stored_keys_that_do_not_exist_are_ignored() {
        let stored = r#"{"preset":"Maya","changed":{"save":["Hyper+Q","Ctrl+S"],"gone":["A"]}}"#;
        let keymap: Keymap = serde_json::from_str(stored).expect("reads");
        assert_eq!((keymap.preset(), keymap.keys(info("save"))), (Preset::Maya, vec!["Ctrl+S"]));
        let unknown = serde_json::from_str::<Keymap>("{}").expect("reads");
        assert_eq!(unknown, Keymap::default());
    }
}
