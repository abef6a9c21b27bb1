//! The command palette: finds a command by part of its name.

use super::command::{COMMANDS, Command, CommandInfo};
use egui::{Key, Modal, RichText, ScrollArea};

use super::theme;

/// The typed text and the selected match.
#[derive(Clone, Debug, Default)]
pub(crate) struct Palette {
    open: bool,
    typed: String,
    chosen: usize,
}

impl Palette {
    /// Opens or closes the palette.
    pub(crate) fn toggle(&mut self) {
        *self = Self { open: !self.open, ..Self::default() };
    }

    /// Shows the palette if it is open. Returns the command that was chosen.
    pub(crate) fn show(&mut self, ctx: &egui::Context, enabled: impl Fn(Command) -> bool) -> Option<Command> {
        if !self.open {
            return None;
        }
        let mut result = None;
        let response = Modal::new(egui::Id::unique("palette")).show(ctx, |ui| {
            ui.set_width(420.0);
            let (up, down, enter) = ui.input_mut(|input| {
                let none = egui::Modifiers::NONE;
                (
                    input.consume_key(none, Key::ArrowUp),
                    input.consume_key(none, Key::ArrowDown),
                    input.consume_key(none, Key::Enter),
                )
            });
            let edit = egui::TextEdit::singleline(&mut self.typed)
                .hint_text("Type a command")
                .desired_width(f32::INFINITY);
            let field = ui.add(edit).on_hover_text("Part of the command's name.");
            field.request_focus();
            let found: Vec<_> = matches(&self.typed).filter(|info| enabled(info.command)).collect();
            if field.changed() {
                self.chosen = 0;
            }
            if down {
                self.chosen += 1;
            }
            if up {
                self.chosen = self.chosen.saturating_sub(1);
            }
            self.chosen = self.chosen.min(found.len().saturating_sub(1));
            ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
                for (i, info) in found.iter().enumerate() {
                    let key = info.shortcuts.first().copied().unwrap_or("");
                    let row = ui.horizontal(|ui| {
                        let label = ui.selectable_label(i == self.chosen, info.label);
                        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                            ui.label(RichText::new(key).monospace().color(theme::QUIET));
                        });
                        label.on_hover_text(info.tooltip)
                    });
                    if row.inner.clicked() || (enter && i == self.chosen) {
                        result = Some(info.command);
                    }
                }
                if found.is_empty() {
                    ui.label(RichText::new("No matching command").color(theme::QUIET));
                }
            });
        });
        if result.is_some() || response.should_close() {
            self.open = false;
        }
        result
    }
}

/// The commands whose label contains every word of `typed`.
fn matches(typed: &str) -> impl Iterator<Item = &'static CommandInfo> {
    let words: Vec<String> = typed.split_whitespace().map(str::to_lowercase).collect();
    COMMANDS.iter().filter(move |info| {
        let label = info.label.to_lowercase();
        info.in_palette && words.iter().all(|word| label.contains(word.as_str()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_in_any_order_find_a_command() {
        let found: Vec<_> = matches("hair frame").map(|info| info.command).collect();
        assert_eq!(found, [Command::FrameHair]);
        assert!(matches("no such thing").next().is_none());
        assert!(matches("").count() > 10);
    }
}
