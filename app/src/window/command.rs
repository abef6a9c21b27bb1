//! The commands that keys, menus, buttons and the palette run, in one table.

mod table;

pub use table::COMMANDS;

/// A command of the interface. [`COMMANDS`] has its names, keys and menu.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Command {
    /// Starts or pauses playback.
    PlayPause,
    /// Moves one frame forward.
    StepForward,
    /// Moves one frame back.
    StepBack,
    /// Seeks to the first frame.
    JumpToStart,
    /// Seeks to the last frame.
    JumpToEnd,
    /// Switches looping.
    ToggleLoop,
    /// Resets the hair to its style and lets it settle.
    SettleHair,
    /// Switches the scissors.
    Scissors,
    /// Shows or hides the mask of the selected layer.
    ShowMask,
    /// Starts or ends painting the mask of the selected layer.
    PaintMask,
    /// Switches the brushes of hair.
    Brushes,
    /// Makes the brush smaller.
    BrushSmaller,
    /// Makes the brush larger.
    BrushLarger,
    /// Shows or hides the colliders.
    ShowColliders,
    /// Starts or ends the recording of a take.
    RecordTake,
    /// Starts or cancels the recording of a film or of images.
    Record,
    /// Plays the latest take.
    PlayTake,
    /// Returns from a take to the simulation.
    LeaveTake,
    /// Switches backward playback of a take.
    PlayBackwards,
    /// Switches the recording of tracks by controls that are moved during playback.
    WriteTracks,
    /// Adds a marker at the current time.
    AddMarker,
    /// Sets the in point of recordings to the current frame.
    MarkIn,
    /// Sets the out point of recordings to the current frame.
    MarkOut,
    /// Saves the image in the viewport as a PNG file.
    SavePicture,
    /// Exports hair as animated curves, with the body, for other programs.
    ExportCurves,
    /// Compares shadow methods and writes a report.
    ExportReport,
    /// Picks the sound of the dance.
    PickSound,
    /// Moves the camera until the hair fills the image.
    FrameHair,
    /// Switches whether the camera follows the head.
    ToggleFollow,
    /// Restores the default camera.
    ResetCamera,
    /// Undoes the last change.
    Undo,
    /// Redoes the change that was undone last.
    Redo,
    /// Starts from the default project.
    NewProject,
    /// Opens a project, hairstyle, character or motion.
    Open,
    /// Saves the project.
    Save,
    /// Saves the project under another name.
    SaveAs,
    /// Loads the shipped smooth bob.
    PresetSmooth,
    /// Loads the shipped curls.
    PresetCurly,
    /// Loads the shipped long hair.
    PresetLong,
    /// Loads the shipped ponytail.
    PresetPonytail,
    /// Loads the shipped bun.
    PresetBun,
    /// Opens the command palette.
    Palette,
    /// Shows or closes the comparison.
    Compare,
    /// Shows or closes the wall of variants.
    Wall,
    /// Adds a pane with a take that the user picks.
    CompareTakes,
    /// Hides or shows the panels.
    TogglePanels,
    /// Opens or closes the manual.
    Manual,
    /// Starts or ends the mode in which a click on a control opens what the manual writes about it.
    WhatIsThis,
    /// Shows the list of keys.
    ShowKeys,
    /// Shows version, licence and graphics card.
    About,
    /// Quits the program.
    Quit,
}

/// The menu of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum CommandGroup {
    /// Time.
    Playback,
    /// The camera and the panels.
    View,
    /// Files and recordings.
    File,
    /// Changes.
    Edit,
    /// Hairstyles.
    Hair,
    /// The program itself.
    Help,
}

impl CommandGroup {
    /// All groups, in the order of menus.
    pub const ALL: [Self; 6] = [Self::File, Self::Edit, Self::Playback, Self::View, Self::Hair, Self::Help];

    /// The name in menus.
    pub fn label(self) -> &'static str {
        match self {
            Self::Playback => "Playback",
            Self::View => "View",
            Self::File => "File",
            Self::Edit => "Edit",
            Self::Hair => "Hair",
            Self::Help => "Help",
        }
    }

    /// The letter that opens its menu with Alt.
    pub fn letter(self) -> char {
        match self {
            Self::Playback => 'P',
            Self::View => 'V',
            Self::File => 'F',
            Self::Edit => 'E',
            // H is that of Help, as elsewhere.
            Self::Hair => 'A',
            Self::Help => 'H',
        }
    }
}

/// Names, keys and menu of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CommandInfo {
    /// Which command.
    pub command: Command,
    /// Stable name, for tests and saved layouts.
    pub id: &'static str,
    /// The name on buttons, in menus and in the palette.
    pub label: &'static str,
    /// A sentence that says what it does.
    pub tooltip: &'static str,
    /// Keys, the first one shown in menus, such as `Ctrl+Shift+Z`. `Ctrl` is the command key on a Mac.
    pub shortcuts: &'static [&'static str],
    /// Its menu.
    pub group: CommandGroup,
    /// Whether the palette lists it.
    pub in_palette: bool,
}

impl Command {
    /// Its names, keys and menu.
    pub fn info(self) -> &'static CommandInfo {
        // The table is in the order of the enum, which a test checks.
        &COMMANDS[self as usize]
    }
}

/// A key with its modifiers, as [`CommandInfo::shortcuts`] writes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shortcut<'a> {
    /// Control, or the command key on a Mac.
    pub ctrl: bool,
    /// Shift.
    pub shift: bool,
    /// Alt.
    pub alt: bool,
    /// The key: `A` to `Z`, `Space`, `Tab`, `Left`, `Right`, `Home`, `End`, `?`, `F1` and so on.
    pub key: &'a str,
}

impl<'a> Shortcut<'a> {
    /// Reads a shortcut such as `Ctrl+Shift+Z`; `None` if a modifier is unknown or the key is missing.
    pub fn parse(text: &'a str) -> Option<Self> {
        let mut parts = text.split('+').rev();
        let key = parts.next().filter(|key| !key.is_empty())?;
        let mut shortcut = Self { ctrl: false, shift: false, alt: false, key };
        for modifier in parts {
            match modifier {
                "Ctrl" => shortcut.ctrl = true,
                "Shift" => shortcut.shift = true,
                "Alt" => shortcut.alt = true,
                _ => return None,
            }
        }
        Some(shortcut)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn hairstyles_have_the_names_of_the_browser() {
        let commands = [
            (Command::PresetSmooth, "smooth"),
            (Command::PresetCurly, "curly"),
            (Command::PresetLong, "long"),
            (Command::PresetPonytail, "ponytail"),
            (Command::PresetBun, "bun"),
        ];
        for (command, id) in commands {
            let name = &lovelock_project::styles::shipped::by_id(id).expect("shipped").style.name;
            assert_eq!(command.info().label, format!("Hairstyle: {name}"));
        }
    }

    #[test]
    fn the_table_is_in_the_order_of_the_enum() {
        for (i, info) in COMMANDS.iter().enumerate() {
            assert_eq!(info.command as usize, i, "{}", info.id);
            assert_eq!(info.command.info(), info);
        }
        assert_eq!(Command::Quit as usize + 1, COMMANDS.len(), "every command has its row");
    }

    #[test]
    fn ids_labels_and_keys_are_distinct() {
        let mut seen = BTreeSet::new();
        for info in COMMANDS {
            for text in [info.id, info.label].into_iter().chain(info.shortcuts.iter().copied()) {
                assert!(seen.insert(text), "`{text}` is used twice");
            }
            assert!(info.tooltip.ends_with('.'), "{}: a tooltip is a sentence", info.id);
        }
    }

    #[test]
    fn every_shortcut_can_be_read() {
        for shortcut in COMMANDS.iter().flat_map(|info| info.shortcuts) {
            assert!(Shortcut::parse(shortcut).is_some(), "{shortcut}");
        }
        let redo = Shortcut { ctrl: true, shift: true, alt: false, key: "Z" };
        assert_eq!(Shortcut::parse("Ctrl+Shift+Z"), Some(redo));
        for wrong in ["", "Ctrl+", "Hyper+Z"] {
            assert_eq!(Shortcut::parse(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn the_keys_that_were_promised_are_there() {
        for (key, command) in [
            ("Space", Command::PlayPause),
            ("Right", Command::StepForward),
            ("Left", Command::StepBack),
            ("Home", Command::JumpToStart),
            ("End", Command::JumpToEnd),
            ("R", Command::RecordTake),
            ("Ctrl+R", Command::Record),
            ("C", Command::Compare),
            ("F", Command::FrameHair),
            ("Ctrl+Z", Command::Undo),
            ("Ctrl+Shift+Z", Command::Redo),
            ("Ctrl+S", Command::Save),
            ("Ctrl+K", Command::Palette),
            ("Tab", Command::TogglePanels),
            ("F9", Command::TogglePanels),
            ("F1", Command::Manual),
            ("Shift+F1", Command::WhatIsThis),
            ("?", Command::ShowKeys),
        ] {
            assert!(command.info().shortcuts.contains(&key), "{key}");
        }
    }
}
