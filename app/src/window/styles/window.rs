//! What the window does for the browser with files of styles.

use std::path::Path;

use lovelock_project::styles::{Style, StyleParts, own_id};

use crate::window::{Window, notices};

impl Window {
    /// Saves the style that is exported.
    pub(in crate::window) fn export_style(&mut self, path: &Path) -> Result<(), String> {
        let Some(style) = &self.files.exported else { return Ok(()) };
        style.save(path).map_err(|error| error.to_string())?;
        self.files.exported = None;
        self.notices.push(notices::Kind::Done, format!("Saved {}", path.display()));
        Ok(())
    }

    /// Copies a style file among the user's own and applies it.
    pub(in crate::window) fn open_style(&mut self, path: &Path) -> Result<(), String> {
        let (mut style, problems) = Style::load(path).map_err(|error| error.to_string())?;
        self.warn(problems.into_iter().map(|problem| problem.message));
        style.hair.style = own_id(path);
        match self.panels.hair.styles.own().map(|own| own.import(path)) {
            Some(Ok(copy)) => {
                style.hair.style = own_id(&copy);
                self.panels.hair.styles.refresh();
                let text = format!("Added {} to your styles", style.name);
                self.notices.push(notices::Kind::Done, text);
            }
            Some(Err(error)) => self.fail(error.to_string()),
            None => {}
        }
        if let Some(file) = &style.hair.file {
            self.session.pick(&file.path);
        }
        self.change("style", |project| {
            project.apply_style_below_layers(&style, StyleParts::ALL);
        });
        Ok(())
    }
}
