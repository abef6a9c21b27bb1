//! The steps of the tour.

use crate::window::command::Command;
use crate::window::keymap::Keymap;
use crate::window::page::Page;
use crate::window::pointer_tool::PointerTool;

/// What a step points at.
pub(super) enum Target {
    /// The image.
    Image,
    /// A section of a panel, which is unfolded and scrolled to.
    Section(&'static str),
    /// A button that runs a command.
    Command(Command),
}

/// A step.
pub(super) struct Step {
    pub(super) target: Target,
    pub(super) title: &'static str,
    /// What it says; `{}` stands for the key of the command.
    says: &'static str,
    key: Option<Command>,
}

impl Step {
    /// What it says, with the keys that the user has.
    pub(super) fn text(&self, keymap: &Keymap) -> String {
        let key = self.key.as_ref().and_then(|command| keymap.first(command.info()?));
        self.says.replace("{}", key.as_deref().unwrap_or("a key that you choose in the preferences"))
    }
}

/// The steps, in their order.
pub(super) static STEPS: [Step; 10] = [
    Step {
        target: Target::Image,
        title: "The image",
        says: "Drag to turn the camera, Shift+drag to pan, turn the wheel to come closer. {} brings the hair back into view. Everything \
               can be changed while the dance plays.",
        key: Some(Command::FrameHair),
    },
    Step {
        target: Target::Command(Command::PlayPause),
        title: "Playback",
        says: "{} pauses and plays. Drag along the ruler to go to any time of the dance.",
        key: Some(Command::PlayPause),
    },
    Step {
        target: Target::Section("Hairstyle"),
        title: "Hairstyles",
        says: "Click a picture to take that hairstyle. Below are its controls: drag Length under Cut, for example. A coloured label is a \
               changed value; double-click it to restore the default. {} undoes any change.",
        key: Some(Command::Undo),
    },
    Step {
        target: Target::Section("Layers"),
        title: "Layers",
        says: "Layers change a hairstyle step by step, like those of a paint program: each has a weight and a mask that you paint on the \
               head.",
        key: None,
    },
    Step {
        target: Target::Section("Ties and scissors"),
        title: "Ties and scissors",
        says: "Add a ponytail or a braid and drag its ring on the head. {} takes up the scissors: drag a line across the hair.",
        key: Some(Command::Use(PointerTool::Scissors)),
    },
    Step {
        target: Target::Section("Simulation"),
        title: "Simulation",
        says: "How hair moves: stiffness, damping, wind. The hair answers at once.",
        key: None,
    },
    Step {
        target: Target::Section("Shadow"),
        title: "Shadow methods",
        says: "Choose how hair shadows itself. {} puts several methods side by side, each with its error and its cost.",
        key: Some(Command::Show(Page::Compare)),
    },
    Step {
        target: Target::Section("Light"),
        title: "Light",
        says: "Drag the handle on the sphere to turn the light. Add more lights, or light from a picture all around.",
        key: None,
    },
    Step {
        target: Target::Command(Command::RecordTake),
        title: "Takes",
        says: "{} records a take of the simulation and ends it. A take can be scrubbed, lit again and filmed.",
        key: Some(Command::RecordTake),
    },
    Step {
        target: Target::Section("Recording"),
        title: "Films and frames",
        says: "Size, quality and the button that records a film. {} finds any command or setting by its name, and the menu Help has the \
               manual and this tour.",
        key: Some(Command::Palette),
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_step_names_a_key_where_it_has_a_place_for_one() {
        for step in &STEPS {
            assert_eq!(step.key.is_some(), step.says.contains("{}"), "{}", step.title);
            assert!(!step.text(&Keymap::default()).contains("that you choose"), "{}", step.title);
            assert!(step.says.len() < 260, "{}: too long to read beside a control", step.title);
        }
    }
}
