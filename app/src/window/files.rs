//! Opening and saving files.

use std::path::Path;

use lovelock_groom::CurveCache;
use lovelock_jobs::info::FileKind;
use lovelock_project::Project;
use lovelock_project::files::FileRef;
use lovelock_project::project::{Contender, load_project_with, save_project};
use lovelock_session::take::{project_of_cache, project_of_take};

use super::{Pending, Window, notices, remember};

impl Window {
    /// Opens a file of any kind that the program reads.
    pub(super) fn open_any(&mut self, path: &Path) {
        match FileKind::of(path) {
            Ok(FileKind::Project) if self.history.is_modified() => {
                self.pending = Some(Pending::Open(path.to_owned()));
            }
            Ok(FileKind::Project) => self.open_project(path),
            Ok(FileKind::Hair) if CurveCache::times_in(path).is_some() => self.open_take(path),
            Ok(FileKind::Take) => {
                self.open_take(path);
                // Saving must not write the take's project to the file of the previous project.
                self.project_path = None;
                self.session.set_project_path(None);
            }
            Ok(FileKind::Style) => self.open_style(path),
            Ok(kind) => self.open_part(path, |project| match kind {
                FileKind::Hair => project.set_hair_file(path),
                FileKind::Character => project.set_body_file(path),
                FileKind::Surroundings => project.set_surroundings_file(path),
                FileKind::Sound => project.set_sound_file(path),
                FileKind::Motion | FileKind::Project | FileKind::Style | FileKind::Take => {
                    project.set_motion_file(path);
                }
            }),
            Err(error) => self.warn([error.to_string()]),
        }
    }

    /// Makes a file that the user picked a part of the project.
    pub(super) fn open_part(&mut self, path: &Path, set: impl FnOnce(&mut Project)) {
        self.session.pick(path);
        self.change("file", set);
        // The project may have named the file before without having access to it.
        let project = self.history.project().clone();
        self.session.reload(&project);
    }

    /// Plays a take with the project that it was recorded from, or curves over time with the body and the motion of this one. One
    /// undo step restores the previous project.
    pub(super) fn open_take(&mut self, path: &Path) {
        let opened = match FileKind::of(path) {
            Ok(FileKind::Hair) => {
                project_of_cache(self.history.project(), path).map(|project| (project, Vec::new()))
            }
            _ => project_of_take(path),
        };
        match opened {
            Ok((take, problems)) => {
                self.session.pick(path);
                self.change("take", |project| *project = take);
                let project = self.history.project().clone();
                self.session.reload(&project);
                self.warn(problems.into_iter().map(|problem| problem.message));
            }
            Err(error) => self.warn([error.to_string()]),
        }
    }

    /// Adds a pane that shows a take, rendered with the settings of the project.
    pub(super) fn compare_with(&mut self, path: &Path) {
        match FileKind::of(path) {
            Ok(kind) if kind == FileKind::Take || CurveCache::times_in(path).is_some() => {
                self.session.pick(path);
                let file = FileRef::new(path);
                self.change("compare", |project| {
                    let own = Contender::of(project);
                    let other = Contender { take: Some(file), ..own.clone() };
                    project.compare.panes = vec![own, other];
                });
                self.layout.compare.shown = true;
                self.layout.wall.shown = false;
            }
            Ok(kind) => {
                self.warn([format!("{}: found a {} file; must be a take", path.display(), kind.label())]);
            }
            Err(error) => self.warn([error.to_string()]),
        }
    }

    pub(super) fn open_project(&mut self, path: &Path) {
        let mut access = self.session.access().clone();
        access.set_project(Some(path));
        match load_project_with(path, &mut access) {
            Ok((project, problems)) => {
                self.overdub.let_go();
                self.cancel_strokes();
                self.history = lovelock_project::history::History::new(project);
                self.project_path = Some(path.to_owned());
                self.session.set_project_path(self.project_path.as_ref());
                remember(&mut self.layout.recent, path);
                self.warn(problems.into_iter().map(|problem| problem.message));
            }
            Err(error) => self.warn([error.to_string()]),
        }
    }

    pub(super) fn save_to(&mut self, path: &Path) {
        match save_project(path, self.history.project()) {
            Ok(()) => {
                self.history.mark_saved();
                self.project_path = Some(path.to_owned());
                self.session.set_project_path(self.project_path.as_ref());
                remember(&mut self.layout.recent, path);
                self.notices.push(notices::Kind::Done, format!("Saved {}", path.display()));
            }
            Err(error) => self.warn([error.to_string()]),
        }
    }
}
