//! The commands that keys, menus, buttons and the palette run, in one table.

mod table;

pub(crate) use table::COMMANDS;

use lovelock_groom::Preset;
use lovelock_project::styles::Style;
use lovelock_session::health::GaugeKind;

use super::page::Page;
use super::pointer_tool::PointerTool;
use super::purpose::Purpose;

/// A command of the interface. [`COMMANDS`] has the names, keys and menus of those that the user finds in a menu.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Command {
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
    /// Takes up a tool of the pointer, or puts it down if it is in use.
    Use(PointerTool),
    /// Shows or hides the mask of the selected layer.
    ShowMask,
    /// Makes the brush smaller.
    BrushSmaller,
    /// Makes the brush larger.
    BrushLarger,
    /// Shows or hides the colliders.
    ShowColliders,
    /// Starts or ends the recording of a take.
    RecordTake,
    /// Offers what earlier runs did not save.
    ShowUnsaved,
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
    /// Opens the dialog that picks a file or a folder for a purpose.
    PickFile(Purpose),
    /// Compares shadow methods and writes a report.
    ExportReport,
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
    /// Saves the project.
    Save,
    /// Loads a shipped hairstyle.
    Load(Preset),
    /// Opens the command palette.
    Palette,
    /// Shows a page, or the image if the page is shown already.
    Show(Page),
    /// Hides or shows the panels.
    TogglePanels,
    /// Returns every panel to its usual place and size.
    ResetLayout,
    /// Opens or closes the manual.
    Manual,
    /// Starts or ends the mode in which a click on a control opens what the manual writes about it.
    WhatIsThis,
    /// Shows the list of keys.
    ShowKeys,
    /// Shows recent projects and examples.
    StartPage,
    /// Begins the tour through the window.
    Tour,
    /// Opens or closes the dialog of theme, scale and keys.
    Preferences,
    /// Makes text and controls larger.
    ScaleUp,
    /// Makes text and controls smaller.
    ScaleDown,
    /// Restores the size of text and controls.
    ScaleReset,
    /// Shows version, licence and graphics card.
    About,
    /// Copies what a report of a problem needs.
    ReportProblem,
    /// Quits the program.
    Quit,
    /// Seeks to a time of the timeline, seconds.
    Seek(f64),
    /// Sets the rate of playback, seconds of the dance per second.
    SetRate(f64),
    /// Trims the clip to the in and out points.
    TrimToPoints,
    /// Removes the trim of the clip.
    RemoveTrim,
    /// Sets the key of a track at the current time.
    SetKey {
        /// The target of the track.
        target: String,
        /// The numbers of the key.
        value: Vec<f64>,
    },
    /// Removes the key of a track, by its target, at the current time.
    RemoveKey(String),
    /// Records one control alone while the dance plays.
    RecordControl {
        /// The target of its track.
        target: String,
        /// Its label.
        label: &'static str,
    },
    /// Starts to paint where the operation with this id acts.
    PaintMap(&'static str),
    /// Unfreezes all locks.
    Unfreeze,
    /// Saves a style to a file that the user picks.
    ExportStyle(Box<Style>),
    /// Selects the pane of the comparison that the panels edit, by its number from 0.
    EditPane(usize),
    /// Marks the place of a gauge in the image and moves the camera there, or removes the mark.
    ShowGauge(GaugeKind),
    /// Tells the user that something is done.
    Report(String),
    /// Tells the user that something failed, and why.
    Fail(String),
}

/// The menu of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(crate) enum CommandGroup {
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
    pub(crate) fn label(self) -> &'static str {
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
    pub(crate) fn letter(self) -> char {
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
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CommandInfo {
    /// Which command.
    pub(crate) command: Command,
    /// Stable name, for tests and saved layouts.
    pub(crate) id: &'static str,
    /// The name on buttons, in menus and in the palette.
    pub(crate) label: &'static str,
    /// A sentence that says what it does.
    pub(crate) tooltip: &'static str,
    /// Keys, the first one shown in menus, such as `Ctrl+Shift+Z`. `Ctrl` is the command key on a Mac.
    pub(crate) shortcuts: &'static [&'static str],
    /// Its menu.
    pub(crate) group: CommandGroup,
    /// Whether the palette lists it.
    pub(crate) in_palette: bool,
}

impl Command {
    /// Its names, keys and menu, if it has any.
    pub(crate) fn info(&self) -> Option<&'static CommandInfo> {
        COMMANDS.iter().find(|info| info.command == *self)
    }
}

/// A key with its modifiers, as [`CommandInfo::shortcuts`] writes it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shortcut<'a> {
    /// Control, or the command key on a Mac.
    pub(crate) ctrl: bool,
    /// Shift.
    pub(crate) shift: bool,
    /// Alt.
    pub(crate) alt: bool,
    /// The key: `A` to `Z`, `Space`, `Tab`, `Left`, `Right`, `Home`, `End`, `?`, `F1` and so on.
    pub(crate) key: &'a str,
}

impl<'a> Shortcut<'a> {
    /// Reads a shortcut such as `Ctrl+Shift+Z`; `None` if a modifier is unknown or the key is missing.
    pub(crate) fn parse(text: &'a str) -> Option<Self> {
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
        for preset in Preset::ALL {
            let name = &lovelock_project::styles::shipped::by_id(preset.id()).expect("shipped").style.name;
            let info = Command::Load(preset).info().expect("in the table");
            assert_eq!(info.label, format!("Hairstyle: {name}"));
        }
    }

    #[test]
    fn every_command_of_the_table_is_listed_once() {
        for info in COMMANDS {
            assert_eq!(info.command.info(), Some(info), "{}", info.id);
        }
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
            ("C", Command::Show(Page::Compare)),
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
            assert!(command.info().expect("in the table").shortcuts.contains(&key), "{key}");
        }
    }
}
