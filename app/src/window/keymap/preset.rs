//! Sets of keys and of drags for the camera: those of this program, and those that users of other programs know.

use egui::{Modifiers, PointerButton};
use serde::{Deserialize, Serialize};

use crate::window::command::CommandInfo;

/// A set of keys and drags.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum Preset {
    /// The keys of this program.
    #[default]
    Lovelock,
    /// Keys and drags as in Blender.
    Blender,
    /// Keys and drags as in Maya.
    Maya,
}

/// What a drag does to the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Navigation {
    /// Turns it about the hair.
    Orbit,
    /// Moves it sideways.
    Pan,
    /// Moves it closer or away.
    Zoom,
}

type Keys = &'static [(&'static str, &'static [&'static str])];

const BLENDER: Keys = &[
    ("frame-hair", &["Home", "F"]),
    ("jump-to-start", &["Shift+Left"]),
    ("jump-to-end", &["Shift+Right"]),
    ("palette", &["F3", "Ctrl+K"]),
    ("save-picture", &["F12"]),
    ("record", &["Ctrl+F12"]),
    ("toggle-panels", &["Ctrl+Space", "F9", "Tab"]),
    ("redo", &["Ctrl+Shift+Z"]),
];

const MAYA: Keys = &[
    ("frame-hair", &["F", "A"]),
    ("step-forward", &["Alt+.", "Right"]),
    ("step-back", &["Alt+,", "Left"]),
    ("jump-to-start", &["Shift+Alt+,", "Home"]),
    ("jump-to-end", &["Shift+Alt+.", "End"]),
    ("undo", &["Z", "Ctrl+Z"]),
    ("redo", &["Shift+Z", "Ctrl+Shift+Z", "Ctrl+Y"]),
    ("toggle-panels", &["Ctrl+Space", "F9", "Tab"]),
];

impl Preset {
    /// All of them.
    pub(crate) const ALL: [Self; 3] = [Self::Lovelock, Self::Blender, Self::Maya];

    /// The name.
    pub(crate) fn label(self) -> &'static str {
        match self {
            Self::Lovelock => "Lovelock",
            Self::Blender => "Blender-like",
            Self::Maya => "Maya-like",
        }
    }

    /// How the camera is moved with the pointer.
    pub(crate) fn text(self) -> &'static str {
        match self {
            Self::Lovelock => "Drag to turn the camera, Shift+drag or right drag to pan, wheel to zoom.",
            Self::Blender => {
                "Middle drag to turn the camera, Shift+middle drag to pan, Ctrl+middle drag or wheel to zoom. A plain drag turns, too."
            }
            Self::Maya => {
                "Alt+drag to turn the camera, Alt+middle drag to pan, Alt+right drag or wheel to zoom. A plain drag turns, too."
            }
        }
    }

    fn table(self) -> Keys {
        match self {
            Self::Lovelock => &[],
            Self::Blender => BLENDER,
            Self::Maya => MAYA,
        }
    }

    /// The keys of a command.
    pub(crate) fn keys(self, info: &CommandInfo) -> &'static [&'static str] {
        let own = self.table().iter().find(|(id, _)| *id == info.id);
        own.map_or(info.shortcuts, |(_, keys)| keys)
    }

    /// The commands with keys of their own, by id.
    #[cfg(test)]
    pub(super) fn ids(self) -> impl Iterator<Item = &'static str> {
        self.table().iter().map(|(id, _)| *id)
    }

    /// Whether a drag with these keys moves the camera even over what a tool would edit.
    pub(crate) fn keeps_from_tools(self, held: Modifiers) -> bool {
        self == Self::Maya && held.alt
    }

    /// What a drag with a button does to the camera.
    pub(crate) fn navigation(self, button: PointerButton, held: Modifiers) -> Option<Navigation> {
        match (self, button) {
            (Self::Blender, PointerButton::Middle) if held.command => Some(Navigation::Zoom),
            (Self::Maya, PointerButton::Secondary) if held.alt => Some(Navigation::Zoom),
            (Self::Blender, PointerButton::Middle) | (_, PointerButton::Primary) if held.shift => {
                Some(Navigation::Pan)
            }
            (Self::Blender, PointerButton::Middle) | (_, PointerButton::Primary) => Some(Navigation::Orbit),
            (_, PointerButton::Middle | PointerButton::Secondary) => Some(Navigation::Pan),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_preset_moves_the_camera_as_its_program_does() {
        use Navigation::{Orbit, Pan, Zoom};
        use PointerButton::{Middle, Primary, Secondary};
        let (none, shift, alt) = (Modifiers::NONE, Modifiers::SHIFT, Modifiers::ALT);
        let ctrl = Modifiers::COMMAND;
        for (preset, button, held, wanted) in [
            (Preset::Lovelock, Primary, none, Orbit),
            (Preset::Lovelock, Primary, shift, Pan),
            (Preset::Lovelock, Middle, none, Pan),
            (Preset::Lovelock, Secondary, none, Pan),
            (Preset::Blender, Middle, none, Orbit),
            (Preset::Blender, Middle, shift, Pan),
            (Preset::Blender, Middle, ctrl, Zoom),
            (Preset::Maya, Primary, alt, Orbit),
            (Preset::Maya, Middle, alt, Pan),
            (Preset::Maya, Secondary, alt, Zoom),
        ] {
            assert_eq!(preset.navigation(button, held), Some(wanted), "{preset:?} {button:?} {held:?}");
        }
    }
}
