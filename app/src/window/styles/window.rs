//! What the window does for the browser: the project with a style that is only shown, and files of styles.

use std::path::Path;
use std::sync::Arc;

use lovelock_project::Project;
use lovelock_project::styles::{Style, StyleParts, own_id};

use super::Request;
use crate::window::path_dialog::Purpose;
use crate::window::{Window, notices};

/// The project with a style that is shown without being applied, and what it was made of.
pub(crate) struct Preview {
    of: Arc<Project>,
    id: String,
    parts: StyleParts,
    project: Arc<Project>,
    /// The project at a time of its timeline, seconds.
    seen: (f64, Arc<Project>),
}

impl Window {
    /// The project that is simulated, and the one at the current time that is drawn: with the style on whose tile the pointer rests,
    /// and with the colours of the morph.
    pub(in crate::window) fn shown(&mut self) -> (Arc<Project>, Arc<Project>) {
        let (shown, seen) = self.previewed();
        let Some(look) = seen.morphed_look() else {
            self.morphed = None;
            return (shown, seen);
        };
        // The same allocation as long as nothing changes, so that nothing is drawn again.
        let known = self.morphed.take().filter(|(of, _)| Arc::ptr_eq(of, &seen));
        let (_, drawn) = self.morphed.insert(known.unwrap_or_else(|| {
            let drawn = Arc::new(Project { look, ..(*seen).clone() });
            (seen, drawn)
        }));
        (shown, Arc::clone(drawn))
    }

    /// The project with the style on whose tile the pointer rests, and the same at the current time.
    fn previewed(&mut self) -> (Arc<Project>, Arc<Project>) {
        let of = Arc::clone(self.history.project());
        let Some((id, style, parts)) = self.styles.preview() else {
            self.preview = None;
            return (of, self.seen());
        };
        let secs = self.now_secs();
        let same = |known: &Preview| Arc::ptr_eq(&known.of, &of) && known.id == id && known.parts == parts;
        let known = self.preview.take().filter(same);
        let mut preview = known.unwrap_or_else(|| {
            let mut project = (*of).clone();
            project.apply_style_below_layers(style, parts);
            let project = Arc::new(project);
            let seen = (f64::NAN, Arc::clone(&project));
            Preview { of, id: id.to_owned(), parts, project, seen }
        });
        if preview.project.is_animated() && preview.seen.0.to_bits() != secs.to_bits() {
            preview.seen = (secs, Arc::new(self.overdub.shown(&preview.project, secs)));
        }
        let shown = (Arc::clone(&preview.project), Arc::clone(&preview.seen.1));
        self.preview = Some(preview);
        shown
    }

    /// Does what the browser asks for.
    pub(in crate::window) fn answer_styles(&mut self) {
        for request in self.styles.requests() {
            match request {
                Request::Export(style) => {
                    self.exported = Some(style);
                    self.open_path_dialog(Purpose::ExportStyle);
                }
                Request::Done(said) => self.notices.push(notices::Kind::Done, said),
                Request::Failed(why) => self.fail(why),
            }
        }
    }

    /// Saves the style that is exported.
    pub(in crate::window) fn export_style(&mut self, path: &Path) -> Result<(), String> {
        let Some(style) = &self.exported else { return Ok(()) };
        style.save(path).map_err(|error| error.to_string())?;
        self.exported = None;
        self.notices.push(notices::Kind::Done, format!("Saved {}", path.display()));
        Ok(())
    }

    /// Copies a style file among the user's own and applies it.
    pub(in crate::window) fn open_style(&mut self, path: &Path) -> Result<(), String> {
        let (mut style, problems) = Style::load(path).map_err(|error| error.to_string())?;
        self.warn(problems.into_iter().map(|problem| problem.message));
        style.hair.style = own_id(path);
        match self.styles.own().map(|own| own.import(path)) {
            Some(Ok(copy)) => {
                style.hair.style = own_id(&copy);
                self.styles.refresh();
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
