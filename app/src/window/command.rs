//! What the user can ask for by key, menu, button or palette: one table.

mod table;

pub use table::COMMANDS;

/// An action of the interface. [`COMMANDS`] says everything else about it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Command {
    /// Plays or pauses the dance.
    PlayPause,
    /// One frame on.
    StepForward,
    /// One frame back.
    StepBack,
    /// To the first frame.
    JumpToStart,
    /// To the last frame.
    JumpToEnd,
    /// Whether the dance starts again at its end.
    ToggleLoop,
    /// Lets the hair fall into place again.
    SettleHair,
    /// Takes the scissors, or puts them away.
    Scissors,
    /// Shows or hides what hair collides with.
    ShowColliders,
    /// Starts or ends the recording of a take.
    RecordTake,
    /// Starts or cancels the recording of a film or of pictures.
    Record,
    /// Plays the take that was recorded last.
    PlayTake,
    /// Simulates again in place of the take that plays.
    LeaveTake,
    /// Whether a take plays from its end to its start.
    PlayBackwards,
    /// Whether controls that are moved while the dance plays write tracks.
    WriteTracks,
    /// A named time where the dance is.
    AddMarker,
    /// Recordings begin where the dance is.
    MarkIn,
    /// Recordings end where the dance is.
    MarkOut,
    /// Saves the picture in the viewport as a PNG file.
    SavePicture,
    /// Writes the hair and the body as curves that move, for other programs.
    ExportCurves,
    /// Moves the camera until the hair fills the picture.
    FrameHair,
    /// Whether the camera follows the head.
    ToggleFollow,
    /// The default camera.
    ResetCamera,
    /// Takes back the last change.
    Undo,
    /// Does it again.
    Redo,
    /// The default project.
    NewProject,
    /// Opens a project, hairstyle, character or motion.
    Open,
    /// Saves the project.
    Save,
    /// Saves the project under another name.
    SaveAs,
    /// The shipped smooth hairstyle.
    PresetSmooth,
    /// The shipped curls.
    PresetCurly,
    /// The shipped long hair.
    PresetLong,
    /// The shipped ponytail.
    PresetPonytail,
    /// The shipped bun.
    PresetBun,
    /// The command palette.
    Palette,
    /// Several ways to draw the hair beside each other, or one picture.
    Compare,
    /// What is shown beside a take of one's choice.
    CompareTakes,
    /// Hides or shows all panels.
    TogglePanels,
    /// The list of keys.
    ShowKeys,
    /// Leaves the program.
    Quit,
}

/// Where a command stands in menus and in the list of keys.
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
}

/// Everything that the interface says about a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CommandInfo {
    /// Which command.
    pub command: Command,
    /// Stable name, for tests and saved layouts.
    pub id: &'static str,
    /// The name on buttons, in menus and in the palette.
    pub label: &'static str,
    /// What it does, in a sentence.
    pub tooltip: &'static str,
    /// Keys, the first one shown in menus, such as `Ctrl+Shift+Z`. `Ctrl` is the command key on a Mac.
    pub shortcuts: &'static [&'static str],
    /// Where it stands.
    pub group: CommandGroup,
    /// Whether the palette lists it.
    pub in_palette: bool,
}

impl Command {
    /// Everything that the interface says about it.
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
    /// Reads `Ctrl+Shift+Z`; none for an unknown modifier or no key.
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
            ("?", Command::ShowKeys),
        ] {
            assert!(command.info().shortcuts.contains(&key), "{key}");
        }
    }
}
