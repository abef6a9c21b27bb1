//! Saving, renaming and deleting the user's own styles.

use std::path::{Path, PathBuf};

use egui::{Context, Id, Key, Modal, TextEdit};
use lovelock_project::error::ProjectError;
use lovelock_project::styles::{OwnStyles, Style};

use super::{Browser, Request, short};

/// An open dialog.
#[derive(Clone, Debug)]
pub(super) enum Dialog {
    /// A name for a new style.
    Save { style: Box<Style>, name: String },
    /// Another name.
    Rename { path: PathBuf, name: String },
    /// Whether a style is deleted.
    Delete { path: PathBuf, name: String },
}

/// Shows the dialog that is open, and does what it is for.
pub(super) fn show(ctx: &Context, browser: &mut Browser) {
    let Some(mut dialog) = browser.dialog.take() else { return };
    let modal = Modal::new(Id::unique("style")).show(ctx, |ui| {
        ui.set_width(360.0);
        let (heading, button) = match &dialog {
            Dialog::Save { .. } => ("Save as a style of your own".to_owned(), "Save style"),
            Dialog::Rename { .. } => ("Rename your style".to_owned(), "Rename style"),
            Dialog::Delete { path, name } => (format!("Delete {name} ({})?", short(path)), "Delete style"),
        };
        ui.heading(heading);
        let mut entered = false;
        if let Dialog::Save { name, .. } | Dialog::Rename { name, .. } = &mut dialog {
            ui.horizontal(|ui| {
                let label = ui.label("Name");
                let field = ui.add(TextEdit::singleline(name).desired_width(260.0)).labelled_by(label.id);
                entered = field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
                if ui.memory(|memory| memory.focused().is_none()) && !entered {
                    field.request_focus();
                }
            });
        }
        ui.horizontal(|ui| {
            let done = ui.button(button).clicked() || entered;
            (done, ui.button("Cancel").clicked())
        })
        .inner
    });
    let (done, cancelled) = modal.inner;
    if done {
        if let Some(own) = browser.own.clone() {
            let request = match carry_out(&own, &dialog) {
                Ok(said) => {
                    browser.refresh();
                    Request::Done(said)
                }
                Err(error) => {
                    // The name can be put right.
                    browser.dialog = Some(dialog);
                    Request::Failed(error.to_string())
                }
            };
            browser.requests.push(request);
        }
    } else if !cancelled && !modal.should_close() {
        browser.dialog = Some(dialog);
    }
}

fn carry_out(own: &OwnStyles, dialog: &Dialog) -> Result<String, ProjectError> {
    let at = |path: &Path| path.display().to_string();
    match dialog {
        Dialog::Save { style, name } => {
            let style = Style { name: name.trim().to_owned(), ..(**style).clone() };
            Ok(format!("Saved the style {}", at(&own.save(&style)?)))
        }
        Dialog::Rename { path, name } => Ok(format!("Renamed to {}", at(&own.rename(path, name.trim())?))),
        Dialog::Delete { path, name } => {
            own.delete(path)?;
            Ok(format!("Deleted the style {name}"))
        }
    }
}
