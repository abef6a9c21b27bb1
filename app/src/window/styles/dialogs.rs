//! Saving, updating, renaming and deleting the user's own styles.

use std::path::{Path, PathBuf};

use egui::{Context, Key, RichText, TextEdit, Ui};
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_project::styles::{OwnStyles, Style, own_id};

use super::{Browser, Entry, short};
use crate::window::command::Command;
use crate::window::control::titled_dialog;
use crate::window::theme;

/// Height of the line that says why a name cannot be used, points: it is there from the start, so that no button moves.
const SAID: f32 = 32.0;

/// An open dialog.
#[derive(Clone, Debug)]
pub(super) enum Dialog {
    /// A name for a new style.
    Save { style: Box<Style>, name: String },
    /// Whether a style is replaced. `asked` is the name that was typed, or none where the style itself is updated.
    Replace { path: PathBuf, style: Box<Style>, asked: Option<String> },
    /// Another name.
    Rename { path: PathBuf, name: String },
    /// Whether a style is deleted.
    Delete { path: PathBuf, name: String },
}

impl Dialog {
    /// Asks whether to replace one of the user's styles with the current hair.
    pub(super) fn update(entry: &Entry, project: &Project) -> Self {
        let Style { name, text, tags, .. } = (*entry.style).clone();
        let style = Box::new(Style { name, text, tags, ..Style::of_project(project) });
        Self::Replace { path: entry.file.clone().unwrap_or_default(), style, asked: None }
    }

    /// What it is about, and the button that does it.
    fn words(&self) -> (String, &'static str) {
        match self {
            Self::Save { .. } => ("Save as a style of your own".to_owned(), "Save style"),
            Self::Replace { style, asked: None, .. } => {
                (format!("Replace the contents of {} with the current hair?", style.name), "Update style")
            }
            Self::Replace { style, .. } => {
                (format!("You already have a style {}. Replace it?", style.name), "Replace")
            }
            Self::Rename { .. } => ("Rename your style".to_owned(), "Rename style"),
            Self::Delete { path, name } => (format!("Delete {name} ({})?", short(path)), "Delete style"),
        }
    }
}

/// Shows the dialog that is open, and does what it is for.
pub(super) fn show(ctx: &Context, project: &mut Project, browser: &mut Browser) {
    let Some(mut dialog) = browser.dialog.take() else { return };
    let (heading, button) = dialog.words();
    let modal = titled_dialog("style", &heading).show(ctx, |ui| {
        ui.set_width(360.0);
        ui.heading(heading);
        let mut entered = false;
        let mut named = false;
        if let Dialog::Save { name, .. } | Dialog::Rename { name, .. } = &mut dialog {
            named = true;
            entered = field(ui, name, &mut browser.dialog_error);
            ui.allocate_ui(egui::vec2(360.0, SAID), |ui| {
                ui.set_min_height(SAID);
                let said = browser.dialog_error.as_deref().unwrap_or_default();
                ui.add(egui::Label::new(RichText::new(said).color(theme::wrong())).wrap());
            });
        }
        ui.horizontal(|ui| {
            let done = ui.button(button).clicked() || entered;
            let cancel = ui.button("Cancel");
            // Enter does not replace or delete what cannot be brought back.
            if !named && ui.memory(|memory| memory.focused().is_none()) {
                cancel.request_focus();
            }
            (done, cancel.clicked())
        })
        .inner
    });
    let (done, cancelled) = modal.inner;
    let Some(own) = browser.own.clone() else { return };
    if done {
        browser.dialog_error = None;
        if let Some(asks) = replacement(&own, &dialog) {
            surrender_focus(ctx);
            browser.dialog = Some(asks);
            return;
        }
        match carry_out(&own, &dialog, project) {
            Ok((said, saved)) => {
                if let Some(path) = saved {
                    browser.reveal(own_id(&path));
                }
                browser.refresh();
                browser.requests.push_back(Command::Report(said));
            }
            Err(error) => {
                let is_named = matches!(dialog, Dialog::Save { .. } | Dialog::Rename { .. });
                if is_named {
                    // The name can be put right.
                    browser.dialog_error = Some(error.to_string());
                    browser.dialog = Some(dialog);
                } else {
                    browser.requests.push_back(Command::Fail(error.to_string()));
                }
            }
        }
    } else if cancelled || modal.should_close() {
        browser.dialog_error = None;
        // Back to the name that was typed.
        if let Dialog::Replace { style, asked: Some(name), .. } = dialog {
            surrender_focus(ctx);
            browser.dialog = Some(Dialog::Save { style, name });
        }
    } else {
        browser.dialog = Some(dialog);
    }
}

/// The field for a name; whether Enter confirms it.
fn field(ui: &mut Ui, name: &mut String, error: &mut Option<String>) -> bool {
    let row = ui.horizontal(|ui| {
        let label = ui.label("Name");
        let field = ui.add(TextEdit::singleline(name).desired_width(260.0)).labelled_by(label.id);
        let entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
        if ui.memory(|memory| memory.focused().is_none()) && !entered {
            field.request_focus();
        }
        if field.changed() {
            *error = None;
        }
        entered
    });
    row.inner
}

fn surrender_focus(ctx: &Context) {
    if let Some(focused) = ctx.memory(egui::Memory::focused) {
        ctx.memory_mut(|memory| memory.surrender_focus(focused));
    }
}

/// The question that must be answered first, if the name of a new style is in use.
fn replacement(own: &OwnStyles, dialog: &Dialog) -> Option<Dialog> {
    let Dialog::Save { style, name } = dialog else { return None };
    let path = own.named(name)?;
    let style = Box::new(Style { name: name.trim().to_owned(), ..(**style).clone() });
    Some(Dialog::Replace { path, style, asked: Some(name.clone()) })
}

/// Does what the dialog is for. Returns what was done, and the file of a style that has the hair of the project now.
fn carry_out(
    own: &OwnStyles,
    dialog: &Dialog,
    project: &mut Project,
) -> Result<(String, Option<PathBuf>), ProjectError> {
    let at = |path: &Path| path.display().to_string();
    match dialog {
        Dialog::Save { style, name } => {
            let style = Style { name: name.trim().to_owned(), ..(**style).clone() };
            let path = own.save(&style)?;
            project.become_style(&own_id(&path));
            Ok((format!("Saved the style {}", at(&path)), Some(path)))
        }
        Dialog::Replace { path, style, .. } => {
            own.replace(path, style)?;
            project.become_style(&own_id(path));
            Ok((format!("Updated the style {}", at(path)), Some(path.clone())))
        }
        Dialog::Rename { path, name } => {
            let new = own.rename(path, name.trim())?;
            // The hair keeps the style under its new name.
            if project.hair.style == own_id(path) {
                project.hair.style = own_id(&new);
            }
            Ok((format!("Renamed to {}", at(&new)), None))
        }
        Dialog::Delete { path, name } => {
            own.delete(path)?;
            Ok((format!("Deleted the style {name}"), None))
        }
    }
}
