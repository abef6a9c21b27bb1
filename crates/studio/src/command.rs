//! What the user can ask for by key, menu, button or palette: one table.

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

    /// The command of that id.
    pub fn from_id(id: &str) -> Option<Self> {
        COMMANDS.iter().find(|info| info.id == id).map(|info| info.command)
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

const fn entry(
    command: Command,
    id: &'static str,
    label: &'static str,
    tooltip: &'static str,
    shortcuts: &'static [&'static str],
    group: CommandGroup,
) -> CommandInfo {
    CommandInfo { command, id, label, tooltip, shortcuts, group, in_palette: true }
}

/// Every command, in the order of [`Command`].
pub const COMMANDS: &[CommandInfo] = {
    use Command as C;
    use CommandGroup as G;
    &[
        entry(
            C::PlayPause,
            "play-pause",
            "Play or pause",
            "Plays and pauses the dance.",
            &["Space"],
            G::Playback,
        ),
        entry(C::StepForward, "step-forward", "Next frame", "Moves one frame on.", &["Right"], G::Playback),
        entry(C::StepBack, "step-back", "Previous frame", "Moves one frame back.", &["Left"], G::Playback),
        entry(
            C::JumpToStart,
            "jump-to-start",
            "First frame",
            "Jumps to the start of the dance.",
            &["Home"],
            G::Playback,
        ),
        entry(
            C::JumpToEnd,
            "jump-to-end",
            "Last frame",
            "Jumps to the end of the dance.",
            &["End"],
            G::Playback,
        ),
        entry(
            C::ToggleLoop,
            "toggle-loop",
            "Loop",
            "Starts the dance again when it ends, or holds its last pose.",
            &["L"],
            G::Playback,
        ),
        entry(
            C::SettleHair,
            "settle-hair",
            "Settle the hair",
            "Puts the hair back to its style and lets it fall into place.",
            &["Shift+S"],
            G::Hair,
        ),
        entry(
            C::Scissors,
            "scissors",
            "Scissors",
            "Takes the scissors, or puts them away: a line drawn over hair cuts it off.",
            &["X"],
            G::Hair,
        ),
        entry(
            C::ShowColliders,
            "show-colliders",
            "Show colliders",
            "Shows what hair collides with over the picture, or hides it.",
            &["B"],
            G::View,
        ),
        entry(
            C::RecordTake,
            "record-take",
            "Record a take",
            "Records the simulation, to be played and lit again; asked again, it ends.",
            &["R"],
            G::File,
        ),
        entry(
            C::Record,
            "record",
            "Record a film…",
            "Records the dance as a film or as pictures; asked again while it runs, it cancels.",
            &["Ctrl+R"],
            G::File,
        ),
        entry(
            C::PlayTake,
            "play-take",
            "Play the last take",
            "Plays the take that was recorded last in place of the simulation.",
            &["P"],
            G::Playback,
        ),
        entry(
            C::LeaveTake,
            "leave-take",
            "Leave the take",
            "Simulates the hair again in place of the take that plays.",
            &["Shift+R"],
            G::Playback,
        ),
        entry(
            C::PlayBackwards,
            "play-backwards",
            "Play backwards",
            "Plays a take from its end to its start.",
            &["Shift+Space"],
            G::Playback,
        ),
        entry(
            C::WriteTracks,
            "write-tracks",
            "Write tracks",
            "Controls that you move while the dance plays become tracks; asked again, it ends.",
            &["W"],
            G::Playback,
        ),
        entry(
            C::AddMarker,
            "add-marker",
            "Add a marker",
            "Puts a flag on the timeline where the dance is.",
            &["M"],
            G::Playback,
        ),
        entry(
            C::MarkIn,
            "mark-in",
            "In point here",
            "Lets films and pictures begin where the dance is.",
            &["I"],
            G::Playback,
        ),
        entry(
            C::MarkOut,
            "mark-out",
            "Out point here",
            "Lets films and pictures end where the dance is.",
            &["O"],
            G::Playback,
        ),
        entry(
            C::SavePicture,
            "save-picture",
            "Save picture",
            "Saves the frame in the viewport as a PNG file.",
            &["Ctrl+P"],
            G::File,
        ),
        entry(
            C::ExportCurves,
            "export-curves",
            "Export curves",
            "Writes the hair as curves that move, with the body, for other programs: USD or glTF.",
            &[],
            G::File,
        ),
        entry(
            C::FrameHair,
            "frame-hair",
            "Frame the hair",
            "Moves the camera until the hair fills the picture.",
            &["F"],
            G::View,
        ),
        entry(
            C::ToggleFollow,
            "toggle-follow",
            "Follow the head",
            "Lets the camera follow the head smoothly, or stand still.",
            &["Shift+F"],
            G::View,
        ),
        entry(
            C::ResetCamera,
            "reset-camera",
            "Reset the camera",
            "Goes back to the default view.",
            &["Shift+Home"],
            G::View,
        ),
        entry(C::Undo, "undo", "Undo", "Takes back the last change.", &["Ctrl+Z"], G::Edit),
        entry(
            C::Redo,
            "redo",
            "Redo",
            "Does the change again that was taken back.",
            &["Ctrl+Shift+Z", "Ctrl+Y"],
            G::Edit,
        ),
        entry(
            C::NewProject,
            "new-project",
            "New project",
            "Starts from the default project.",
            &["Ctrl+N"],
            G::File,
        ),
        entry(
            C::Open,
            "open",
            "Open…",
            "Opens a project, take, hair (.hair, .tfx), character (.glb, .gltf) or motion (.bvh) file.",
            &["Ctrl+O"],
            G::File,
        ),
        entry(C::Save, "save", "Save", "Saves the project.", &["Ctrl+S"], G::File),
        entry(
            C::SaveAs,
            "save-as",
            "Save as…",
            "Saves the project under another name.",
            &["Ctrl+Shift+S"],
            G::File,
        ),
        entry(
            C::PresetSmooth,
            "preset-smooth",
            "Hairstyle: smooth bob",
            "Grows the shipped smooth hairstyle, with its colour.",
            &["Alt+1"],
            G::Hair,
        ),
        entry(
            C::PresetCurly,
            "preset-curly",
            "Hairstyle: red curls",
            "Grows the shipped curls, with their colour.",
            &["Alt+2"],
            G::Hair,
        ),
        entry(
            C::PresetLong,
            "preset-long",
            "Hairstyle: long waves",
            "Grows the shipped long hairstyle, with its colour.",
            &["Alt+3"],
            G::Hair,
        ),
        CommandInfo {
            in_palette: false,
            ..entry(
                C::Palette,
                "palette",
                "Command palette",
                "Finds a command by typing a part of its name.",
                &["Ctrl+K"],
                G::View,
            )
        },
        entry(
            C::Compare,
            "compare",
            "Compare methods",
            "Shows several ways to draw the hair beside each other.",
            &["C"],
            G::View,
        ),
        entry(
            C::CompareTakes,
            "compare-takes",
            "Compare with a take…",
            "Shows a take beside what is shown now, at the same time of the dance.",
            &["Shift+C"],
            G::View,
        ),
        entry(
            C::TogglePanels,
            "toggle-panels",
            "Hide or show the panels",
            "Leaves the picture alone on the screen.",
            &["Tab"],
            G::View,
        ),
        entry(C::ShowKeys, "show-keys", "Keys", "Lists the keys.", &["?", "F1"], G::Help),
        entry(
            C::Quit,
            "quit",
            "Quit",
            "Leaves the program; asks where changes are not saved.",
            &["Ctrl+Q"],
            G::File,
        ),
    ]
};

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn the_table_is_in_the_order_of_the_enum() {
        for (i, info) in COMMANDS.iter().enumerate() {
            assert_eq!(info.command as usize, i, "{}", info.id);
            assert_eq!(info.command.info(), info);
            assert_eq!(Command::from_id(info.id), Some(info.command));
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
