//! Keys and menus, made from the table of commands.

use super::command::{COMMANDS, Command, CommandGroup, CommandInfo};
use egui::text::{LayoutJob, TextFormat};
use egui::{
    Event, Id, Key, KeyboardShortcut, LayerId, Modifiers, Order, Popup, RichText, Stroke, TextStyle, Ui,
};

use crate::window::control::HoverTooltip;

use super::key_press::{are_held, consume, consume_all};
use super::keymap::{Keymap, shortcut};
use super::page::Page;
use super::purpose::Purpose;
use super::theme;

/// The commands whose keys were pressed in this pass, some as often as the key was, unless a text field takes the keys. Keys of commands
/// that are not `allowed` stay for others.
pub(crate) fn pressed(ctx: &egui::Context, allowed: impl Fn(&Command) -> bool) -> Vec<Command> {
    let typing = ctx.egui_wants_keyboard_input();
    let editing = ctx.text_edit_focused();
    let mut commands = Vec::new();
    let keymap = Keymap::of(ctx);
    let bound = COMMANDS.iter().filter(|info| allowed(&info.command)).flat_map(|info| {
        let keys = keymap.keys(info);
        keys.into_iter().filter_map(|text| Some((shortcut(text)?, &info.command))).collect::<Vec<_>>()
    });
    for (shortcut, command) in bound {
        let KeyboardShortcut { modifiers, logical_key } = shortcut;
        // A control with the focus takes plain keys. Function keys are never its own.
        if typing && !modifiers.command && !is_function_key(logical_key) {
            continue;
        }
        // A text field has its own undo and redo.
        if editing && matches!(command, Command::Undo | Command::Redo) {
            continue;
        }
        let times = consume_all(ctx, modifiers, logical_key);
        let times = if counts(command) { times } else { times.min(1) };
        commands.extend(std::iter::repeat_n(command, times).cloned());
    }
    commands
}

/// Whether a command runs as often as its key was pressed, even if that happened within one slow pass.
fn counts(command: &Command) -> bool {
    matches!(
        command,
        Command::Undo
            | Command::Redo
            | Command::StepForward
            | Command::StepBack
            | Command::ScaleUp
            | Command::ScaleDown
    )
}

fn is_function_key(key: Key) -> bool {
    let name = key.name();
    name.len() > 1 && name.starts_with('F')
}

/// The menus that are opened by Alt and a letter, and those that the arrow keys leave for the next.
#[derive(Clone, Debug, Default)]
pub(crate) struct MenuKeys {
    /// The letter and the button of each menu, from left to right.
    menus: Vec<(char, Id)>,
    /// The menu whose first entry gets the focus as soon as it is shown.
    entered: Option<Id>,
}

/// The popup that the button of a menu opens.
fn popup_of(button: Id) -> Id {
    // As `Popup::default_response_id` makes it.
    button.with("popup")
}

impl MenuKeys {
    /// Opens the menu whose letter was pressed with Alt. Comes before the menu bar.
    pub(crate) fn begin_pass(&mut self, ctx: &egui::Context) {
        // The menu bar of this pass lists them again.
        let menus = std::mem::take(&mut self.menus);
        if are_held(ctx) {
            return;
        }
        let open = menus.iter().position(|(_, button)| Popup::is_id_open(ctx, popup_of(*button)));
        let mut wanted = None;
        for (at, (letter, _)) in menus.iter().enumerate() {
            if let Some(key) = Key::from_name(&letter.to_string())
                && consume(ctx, Modifiers::ALT, key)
            {
                // Some systems also type the letter.
                ctx.input_mut(|input| input.events.retain(|event| !matches!(event, Event::Text(_))));
                wanted = Some(at);
            }
        }
        if let Some(at) = open
            && !ctx.text_edit_focused()
            && !menus.is_empty()
        {
            if consume(ctx, Modifiers::NONE, Key::ArrowRight) {
                wanted = Some((at + 1) % menus.len());
            } else if consume(ctx, Modifiers::NONE, Key::ArrowLeft) {
                wanted = Some((at + menus.len() - 1) % menus.len());
            }
        }
        if let Some(at) = wanted {
            let button = menus[at].1;
            ctx.memory_mut(|memory| memory.request_focus(button));
            Popup::open_id(ctx, popup_of(button));
            self.entered = Some(popup_of(button));
        }
        if let Some(popup) = self.entered.filter(|_| wanted.is_none()) {
            let layer = LayerId::new(Order::Foreground, popup);
            let first = ctx.viewport(|viewport| {
                let mut widgets = viewport.prev_pass.widgets.get_layer(layer);
                widgets.find(|widget| widget.enabled && widget.sense.is_focusable()).map(|widget| widget.id)
            });
            if let Some(first) = first {
                ctx.memory_mut(|memory| memory.request_focus(first));
            }
            if first.is_some() || !Popup::is_id_open(ctx, popup) {
                self.entered = None;
            }
        }
    }

    /// A menu of the bar that Alt and `letter`, one of the letters of its name, open.
    pub(crate) fn menu<R>(
        &mut self,
        ui: &mut Ui,
        name: &str,
        letter: char,
        content: impl FnOnce(&mut Ui) -> R,
    ) -> Option<R> {
        let shown = ui.menu_button(underlined(ui, name, letter), content);
        self.menus.push((letter, shown.response.id));
        shown.inner
    }
}

/// A name with one of its letters underlined while Alt is held.
fn underlined(ui: &Ui, name: &str, letter: char) -> egui::WidgetText {
    let at = name.char_indices().find(|(_, c)| c.eq_ignore_ascii_case(&letter));
    let Some((at, found)) = at.filter(|_| ui.input(|input| input.modifiers.alt)) else {
        return RichText::new(name).into();
    };
    let plain = TextFormat::simple(TextStyle::Button.resolve(ui.style()), ui.visuals().text_color());
    let line = TextFormat { underline: Stroke::new(1.0, theme::bright()), ..plain.clone() };
    let end = at + found.len_utf8();
    let mut job = LayoutJob::default();
    for (text, format) in [(&name[..at], &plain), (&name[at..end], &line), (&name[end..], &plain)] {
        job.append(text, 0.0, format.clone());
    }
    job.into()
}

/// Shows a menu per group of commands. Returns the command that was chosen.
pub(crate) fn menus(ui: &mut Ui, keys: &mut MenuKeys, enabled: impl Fn(&Command) -> bool) -> Option<Command> {
    let mut chosen = None;
    for group in CommandGroup::ALL {
        keys.menu(ui, group.label(), group.letter(), |ui| {
            let mut part = None;
            for info in in_order(group) {
                if part.is_some_and(|part| part != part_of(&info.command)) {
                    ui.separator();
                }
                part = Some(part_of(&info.command));
                if entry(ui, info, enabled(&info.command)) {
                    chosen = Some(info.command.clone());
                    ui.close();
                }
            }
        });
    }
    chosen
}

/// The commands of a group in the order of its menu, divided into parts.
fn in_order(group: CommandGroup) -> Vec<&'static CommandInfo> {
    let mut infos: Vec<_> = COMMANDS.iter().filter(|info| info.group == group).collect();
    infos.sort_by_key(|info| part_of(&info.command));
    infos
}

/// The part of its menu to which a command belongs. Lines divide the parts.
fn part_of(command: &Command) -> u8 {
    match command {
        Command::Save
        | Command::PickFile(Purpose::SaveProject)
        | Command::ShowUnsaved
        | Command::ToggleLoop
        | Command::PlayBackwards
        | Command::PlayTake
        | Command::LeaveTake
        | Command::Palette
        | Command::TogglePanels
        | Command::ResetLayout
        | Command::Preferences
        | Command::ShowKeys
        | Command::Show(Page::Compare) => 1,
        Command::RecordTake
        | Command::Record
        | Command::PickFile(Purpose::Picture | Purpose::Curves | Purpose::Sound)
        | Command::ExportReport
        | Command::AddMarker
        | Command::MarkIn
        | Command::ScaleUp
        | Command::ScaleDown
        | Command::ScaleReset
        | Command::About
        | Command::MarkOut => 2,
        Command::Quit => 3,
        _ => 0,
    }
}

fn entry(ui: &mut Ui, info: &CommandInfo, enabled: bool) -> bool {
    let mut button = egui::Button::new(info.label);
    if let Some(key) = Keymap::of(ui.ctx()).first(info) {
        button = button.shortcut_text(key);
    }
    ui.add_enabled(enabled, button).hover_tooltip(info.tooltip).clicked()
}

/// Keys and what they do, with a sentence for its tooltip.
type KeyRow = (String, &'static str, Option<&'static str>);

/// What the pointer and keys do where no command is run.
const IN_PLACE: [(&str, &str); 15] = [
    ("F6, Shift+F6", "Next, previous area of the window"),
    ("Tab, Shift+Tab", "Next, previous control of the area"),
    ("Alt+letter", "Open the menu of that letter"),
    ("Escape", "Return the keyboard to the image"),
    ("Drag", "Turn the camera about the hair"),
    ("Shift+drag, right drag", "Pan the camera"),
    ("Wheel", "Move the camera closer or away"),
    ("Ctrl+wheel", "Magnify the panes of a comparison"),
    ("Hold V", "Show another pane in place of a pane"),
    ("Click a pane", "Plot the light along its ray"),
    ("Double-click", "Restore the default of a control"),
    ("Right-click, Shift+F10", "Open the menu of a control"),
    ("Ctrl+drag, Shift+drag", "Erase, smooth a mask"),
    ("Up, Down", "Select a layer of the list"),
    ("Delete, Ctrl+D, Ctrl+G, F2", "Remove, duplicate, group, rename"),
];

/// The list of keys, in two columns by menu.
pub(crate) fn list(ui: &mut Ui) {
    let keymap = Keymap::of(ui.ctx());
    let mut groups: Vec<(&str, Vec<KeyRow>)> = Vec::new();
    for group in CommandGroup::ALL {
        let rows = in_order(group).into_iter().map(|info| (keymap.keys(info).join("  "), info));
        let rows = rows.filter(|(keys, _)| !keys.is_empty());
        groups
            .push((group.label(), rows.map(|(keys, info)| (keys, info.label, Some(info.tooltip))).collect()));
    }
    groups.push(("In place", IN_PLACE.map(|(keys, what)| (keys.to_owned(), what, None)).to_vec()));
    let half = groups.iter().map(|(_, rows)| rows.len() + 1).sum::<usize>() / 2;
    let mut columns: [Vec<_>; 2] = Default::default();
    let mut above = 0;
    for (title, rows) in groups {
        let lines = rows.len() + 1;
        columns[usize::from(above + lines / 2 > half)].push((title, rows));
        above += lines;
    }
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = 28.0;
        for groups in columns {
            ui.vertical(|ui| {
                for (title, rows) in groups {
                    ui.label(RichText::new(title).strong());
                    let grid = egui::Grid::new(("keys", title)).num_columns(2).spacing([16.0, 0.0]);
                    grid.min_row_height(0.0).show(ui, |ui| {
                        for (keys, what, tip) in rows {
                            ui.label(RichText::new(keys).monospace().size(11.0).color(theme::accent()));
                            let what = ui.label(what);
                            if let Some(tip) = tip {
                                what.hover_tooltip(tip);
                            }
                            ui.end_row();
                        }
                    });
                }
            });
        }
    });
}
