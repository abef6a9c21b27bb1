//! Keys and menus, made from the table of commands.

use super::command::{COMMANDS, Command, CommandGroup, CommandInfo, Shortcut};
use egui::{Key, KeyboardShortcut, Modifiers, RichText, Ui};

use super::theme;

/// The commands whose keys were pressed in this pass, unless a text field takes the keys.
pub(crate) fn pressed(ctx: &egui::Context) -> Vec<Command> {
    let typing = ctx.egui_wants_keyboard_input();
    let editing = ctx.text_edit_focused();
    let mut commands = Vec::new();
    // Keys with more modifiers first: Ctrl+Shift+Z must not also be Ctrl+Z.
    let mut bound: Vec<(KeyboardShortcut, Command)> = COMMANDS
        .iter()
        .flat_map(|info| info.shortcuts.iter().filter_map(|text| Some((shortcut(text)?, info.command))))
        .collect();
    bound.sort_by_key(|(shortcut, _)| std::cmp::Reverse(weight(shortcut.modifiers)));
    for (shortcut, command) in bound {
        if typing && !shortcut.modifiers.command {
            continue;
        }
        // A text field has its own undo and redo.
        if editing && matches!(command, Command::Undo | Command::Redo) {
            continue;
        }
        if ctx.input_mut(|input| input.consume_shortcut(&shortcut)) {
            // Tab also moves the keyboard focus to the next control, which would then receive all other keys.
            ctx.memory_mut(|memory| memory.move_focus(egui::FocusDirection::None));
            commands.push(command);
        }
    }
    commands
}

fn weight(modifiers: Modifiers) -> u32 {
    u32::from(modifiers.command) + u32::from(modifiers.shift) + u32::from(modifiers.alt)
}

/// The key of that name in egui; `None` if egui has none.
fn shortcut(text: &str) -> Option<KeyboardShortcut> {
    let Shortcut { ctrl, shift, alt, key } = Shortcut::parse(text)?;
    let logical = match key {
        "Left" => Key::ArrowLeft,
        "Right" => Key::ArrowRight,
        "?" => Key::Questionmark,
        name => Key::from_name(name)?,
    };
    let mut modifiers = Modifiers::NONE;
    modifiers.command = ctrl;
    modifiers.shift = shift;
    modifiers.alt = alt;
    Some(KeyboardShortcut::new(modifiers, logical))
}

/// Shows a menu per group of commands. Returns the command that was chosen.
pub(crate) fn menus(ui: &mut Ui, enabled: impl Fn(Command) -> bool) -> Option<Command> {
    let mut chosen = None;
    for group in CommandGroup::ALL {
        ui.menu_button(group.label(), |ui| {
            let mut part = None;
            for info in in_order(group) {
                if part.is_some_and(|part| part != part_of(info.command)) {
                    ui.separator();
                }
                part = Some(part_of(info.command));
                if entry(ui, info, enabled(info.command)) {
                    chosen = Some(info.command);
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
    infos.sort_by_key(|info| part_of(info.command));
    infos
}

/// The part of its menu to which a command belongs. Lines divide the parts.
fn part_of(command: Command) -> u8 {
    match command {
        Command::Save
        | Command::SaveAs
        | Command::ToggleLoop
        | Command::PlayBackwards
        | Command::PlayTake
        | Command::LeaveTake
        | Command::Palette
        | Command::TogglePanels
        | Command::Compare => 1,
        Command::RecordTake
        | Command::Record
        | Command::SavePicture
        | Command::ExportCurves
        | Command::PickSound
        | Command::AddMarker
        | Command::MarkIn
        | Command::MarkOut => 2,
        Command::Quit => 3,
        _ => 0,
    }
}

fn entry(ui: &mut Ui, info: &CommandInfo, enabled: bool) -> bool {
    let mut button = egui::Button::new(info.label);
    if let Some(key) = info.shortcuts.first() {
        button = button.shortcut_text(*key);
    }
    ui.add_enabled(enabled, button).on_hover_text(info.tooltip).clicked()
}

/// The list of keys.
pub(crate) fn list(ui: &mut Ui) {
    egui::Grid::new("keys").num_columns(2).spacing([24.0, 4.0]).striped(true).show(ui, |ui| {
        for info in COMMANDS.iter().filter(|info| !info.shortcuts.is_empty()) {
            ui.label(RichText::new(info.shortcuts.join("  ")).monospace().color(theme::ACCENT));
            ui.label(info.tooltip);
            ui.end_row();
        }
        for (keys, what) in [
            ("Drag", "Turns the camera about the hair."),
            ("Shift+drag, right drag", "Pans the camera."),
            ("Wheel", "Moves the camera closer or farther away."),
            ("Ctrl+wheel", "Magnifies the panes of a comparison."),
            ("Hold V", "Shows another pane of a comparison in place of a pane."),
            ("Click a pane", "Plots the transmittance along the light at that point."),
            ("Double-click a control", "Restores its default."),
            ("Ctrl+drag, Shift+drag", "While a mask is painted: erases it, smooths it."),
            ("Up, Down", "In the list of layers: select the layer above or below."),
            ("Delete, Ctrl+D, Ctrl+G, F2", "In the list of layers: remove, duplicate, group, rename."),
        ] {
            ui.label(RichText::new(keys).monospace().color(theme::ACCENT));
            ui.label(what);
            ui.end_row();
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_of_the_table_exists() {
        for info in COMMANDS {
            for text in info.shortcuts {
                assert!(shortcut(text).is_some(), "{}: {text}", info.id);
            }
        }
    }
}
