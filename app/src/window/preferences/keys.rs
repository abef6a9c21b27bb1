//! The editor of keys: every command with its keys, which can be searched, added and removed.

use egui::{
    Align, ComboBox, Context, Event, FocusDirection, Key, Layout, RichText, ScrollArea, TextEdit, Ui,
    WidgetInfo,
};
use egui_material_icons::icons::{ICON_ADD, ICON_UNDO, ICON_WARNING};

use crate::window::command::{COMMANDS, CommandInfo};
use crate::window::control::HoverTooltip;
use crate::window::keymap::{Keymap, MAX_KEYS, Preset, name_of};
use crate::window::search::{best_first, fit};
use crate::window::theme;

/// What was typed, and the command that waits for a key.
#[derive(Default)]
pub(super) struct KeyEditor {
    typed: String,
    only_conflicts: bool,
    waits: Option<&'static CommandInfo>,
}

/// A change of the keys.
enum Edit {
    Wait(&'static CommandInfo),
    Remove(&'static CommandInfo, String),
    Restore(&'static CommandInfo),
}

impl KeyEditor {
    /// Whether the next key becomes one of a command.
    pub(super) fn takes_key(&self) -> bool {
        self.waits.is_some()
    }

    /// Takes the key that was pressed for the command that waits for one. Escape cancels.
    pub(super) fn take_key(&mut self, ctx: &Context, keymap: &mut Keymap) {
        let Some(info) = self.waits else { return };
        let mut pressed = None;
        ctx.input_mut(|input| {
            input.events.retain(|event| match event {
                Event::Key { key, modifiers, pressed: true, .. } => {
                    pressed.get_or_insert((*modifiers, *key));
                    false
                }
                Event::Key { .. } | Event::Text(_) => false,
                _ => true,
            });
        });
        // Tab and the arrows would also move the focus.
        ctx.memory_mut(|memory| memory.move_focus(FocusDirection::None));
        if let Some((modifiers, key)) = pressed {
            if key != Key::Escape {
                keymap.add(info, &name_of(modifiers, key));
            }
            self.waits = None;
        }
    }

    /// Shows the editor; the list is `height` points high.
    pub(super) fn show(&mut self, ui: &mut Ui, keymap: &mut Keymap, height: f32) {
        self.head(ui, keymap);
        let conflicts = keymap.conflicts();
        self.only_conflicts &= conflicts > 0;
        let commands = COMMANDS.iter().filter(|info| {
            !self.only_conflicts || keymap.keys(info).iter().any(|key| keymap.conflict(info, key).is_some())
        });
        let found = best_first(&self.typed, commands, |typed, info| {
            fit(typed, info.label, &[info.tooltip, &keymap.keys(info).join(" ")])
        });
        let mut edit = None;
        let list = ScrollArea::vertical().min_scrolled_height(height).max_height(height);
        list.auto_shrink(false).show(ui, |ui| {
            for &info in &found {
                edit = self.row(ui, keymap, info).or(edit.take());
            }
            if found.is_empty() {
                ui.label(RichText::new("No command matches.").color(theme::quiet()));
            }
        });
        match edit {
            Some(Edit::Wait(info)) => self.waits = Some(info),
            Some(Edit::Remove(info, key)) => keymap.remove(info, &key),
            Some(Edit::Restore(info)) => keymap.restore(info),
            None => {}
        }
        ui.horizontal(|ui| {
            let reset = ui.add_enabled(keymap.has_changes(), egui::Button::new("Reset all keys"));
            if reset.hover_tooltip("Restores the keys of the preset for every command.").clicked() {
                keymap.restore_all();
            }
            if conflicts > 0 {
                let text = format!("{conflicts} in conflict");
                let text = RichText::new(text).color(theme::wrong());
                ui.toggle_value(&mut self.only_conflicts, text)
                    .hover_tooltip("Lists only keys that do two things.");
            }
        });
    }

    /// Preset and search.
    fn head(&mut self, ui: &mut Ui, keymap: &mut Keymap) {
        ui.horizontal(|ui| {
            ui.label("Keys");
            let mut preset = keymap.preset();
            let combo = ComboBox::from_id_salt("preset of keys").width(120.0).selected_text(preset.label());
            let shown = combo.show_ui(ui, |ui| {
                for choice in Preset::ALL {
                    ui.selectable_value(&mut preset, choice, choice.label());
                }
            });
            shown.response.widget_info(|| WidgetInfo::labeled(egui::Role::ComboBox, true, "Preset of keys"));
            shown.response.hover_tooltip(
                "Keys, and drags that move the camera. Keys that you changed stay as they are.",
            );
            if preset != keymap.preset() {
                keymap.set_preset(preset);
            }
            let field =
                TextEdit::singleline(&mut self.typed).char_limit(80).hint_text("Search command or key");
            let field = ui.add(field.desired_width(f32::INFINITY));
            let typed = self.typed.clone();
            field.widget_info(|| WidgetInfo {
                label: Some("Search keys".to_owned()),
                ..WidgetInfo::text_edit(true, typed.as_str(), typed.as_str(), "Search command or key")
            });
            field.hover_tooltip(
                "Lists only commands with this in their name or text, or with this key, such as Ctrl+S.",
            );
        });
        ui.label(RichText::new(keymap.preset().text()).small().color(theme::quiet()));
    }

    /// A command with its keys.
    fn row(&self, ui: &mut Ui, keymap: &Keymap, info: &'static CommandInfo) -> Option<Edit> {
        let mut edit = None;
        ui.horizontal(|ui| {
            let name = RichText::new(info.label);
            let name = if keymap.is_changed(info) { name.color(theme::accent()) } else { name };
            ui.label(name).hover_tooltip(info.tooltip);
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                // The scroll bar floats above the content.
                ui.add_space(ui.spacing().scroll.bar_width + 2.0);
                if self.waits == Some(info) {
                    ui.label(RichText::new("Press a key, or Escape to cancel").color(theme::accent()));
                    return;
                }
                let keys = keymap.keys(info);
                if keymap.is_changed(info) {
                    let restore =
                        ui.small_button(ICON_UNDO).hover_tooltip("Restores the keys of the preset.");
                    restore.widget_info(|| {
                        WidgetInfo::labeled(
                            egui::Role::Button,
                            true,
                            format!("Restore the keys of {}", info.label),
                        )
                    });
                    if restore.clicked() {
                        edit = Some(Edit::Restore(info));
                    }
                }
                let can_add = keys.len() < MAX_KEYS;
                let add = ui.add_enabled(can_add, egui::Button::new(ICON_ADD).small());
                add.widget_info(|| {
                    WidgetInfo::labeled(egui::Role::Button, can_add, format!("Add a key to {}", info.label))
                });
                if add.hover_tooltip("Waits for a key, and adds it.").clicked() {
                    edit = Some(Edit::Wait(info));
                }
                for key in keys.iter().rev() {
                    let conflict = keymap.conflict(info, key);
                    let text = match &conflict {
                        Some(_) => {
                            RichText::new(format!("{} {key}", ICON_WARNING.codepoint)).color(theme::wrong())
                        }
                        None => RichText::new(*key),
                    };
                    let button = ui.add(egui::Button::new(text.size(11.0)).small());
                    let spoken = match &conflict {
                        Some(other) => format!("Remove {key} from {}, in conflict with {other}", info.label),
                        None => format!("Remove {key} from {}", info.label),
                    };
                    button.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, &spoken));
                    let tip = match conflict {
                        Some(other) => format!("Also stands for: {other}. Click to remove the key here."),
                        None => "Click to remove the key.".to_owned(),
                    };
                    if button.hover_tooltip(tip).clicked() {
                        edit = Some(Edit::Remove(info, (*key).to_owned()));
                    }
                }
            });
        });
        edit
    }
}
