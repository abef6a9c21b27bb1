//! The list below the field of a path: the folder above, folders, files, and files that were used before.

use std::path::Path;

use egui::{Button, RichText, ScrollArea, Ui, vec2};
use egui_material_icons::MaterialIcon;
use egui_material_icons::icons::{ICON_ARROW_UPWARD, ICON_DESCRIPTION, ICON_FOLDER, ICON_HISTORY};

use super::folder::{Entry, Folder};
use crate::window::theme;

/// Height of the list, points: it stays the same, so that nothing below it moves.
const TALL: f32 = 176.0;

/// A row of the list.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub(super) entry: Entry,
    icon: MaterialIcon,
    label: String,
}

impl Row {
    /// An entry of the folder.
    pub(super) fn of(entry: Entry) -> Self {
        let icon = if entry.is_folder { ICON_FOLDER } else { ICON_DESCRIPTION };
        let label = if entry.is_folder { format!("{}/", entry.name) } else { entry.name.clone() };
        Self { entry, icon, label }
    }

    /// The folder above.
    pub(super) fn above(folder: &Path) -> Self {
        let entry = Entry::new(folder.to_owned(), true);
        Self { entry, icon: ICON_ARROW_UPWARD, label: "..".to_owned() }
    }

    /// A file that was used before.
    pub(super) fn recent(path: &Path) -> Self {
        let label = path.display().to_string();
        Self { entry: Entry::new(path.to_owned(), false), icon: ICON_HISTORY, label }
    }
}

/// The row that was clicked.
pub(super) struct Chosen {
    pub(super) entry: Entry,
    /// By a double-click.
    pub(super) is_twice: bool,
}

/// Shows the rows; `chosen` is the one that the keys have reached. Returns the one that was clicked.
pub(super) fn show(ui: &mut Ui, rows: &[Row], chosen: Option<usize>, folder: &Folder) -> Option<Chosen> {
    let mut clicked = None;
    let height = ui.spacing().interact_size.y;
    egui::Frame::canvas(ui.style()).show(ui, |ui| {
        ui.set_min_size(vec2(ui.available_width(), TALL));
        if rows.is_empty() {
            let text = if folder.is_reading() { "Reading the folder" } else { "No matching files" };
            ui.label(RichText::new(text).color(theme::quiet()));
            return;
        }
        let mut area = ScrollArea::vertical().max_height(TALL).auto_shrink(false);
        // The same list may be thousands of rows long: only those in sight are shown.
        let step = height + ui.spacing().item_spacing.y;
        let id = egui::Id::unique("path list row");
        let before: Option<usize> = ui.data(|data| data.get_temp(id)).flatten();
        if let Some(at) = chosen.filter(|_| chosen != before) {
            area = area.vertical_scroll_offset((at as f32 * step - 0.5 * TALL).max(0.0));
        }
        ui.data_mut(|data| data.insert_temp(id, chosen));
        area.show_rows(ui, height, rows.len(), |ui, range| {
            for at in range {
                let Some(row) = rows.get(at) else { break };
                let text = RichText::new(format!(
                    "{}  {}",
                    row.icon.codepoint,
                    lovelock_glyphs::visual_words(&row.label)
                ));
                let button = Button::selectable(chosen == Some(at), text).truncate();
                // As wide as the list, with the name at its left.
                let response = ui.add(button.min_size(vec2(ui.available_width(), height)));
                let label = row.label.clone();
                response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ListItem, true, &label));
                if response.clicked() {
                    clicked = Some(Chosen { entry: row.entry.clone(), is_twice: response.double_clicked() });
                }
            }
        });
    });
    clicked
}
