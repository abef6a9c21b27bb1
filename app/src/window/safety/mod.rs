//! Nothing is lost: unsaved changes go into a journal, and those of earlier runs are offered.

pub(in crate::window) mod ago;
mod failures;
mod offer;
pub(in crate::window) mod picture;
mod unfinished;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::SystemTime;

use egui::Context;
use lovelock_base::clock::Stopwatch;
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_project::files::{Access, FileRef};
use lovelock_project::grants::Grants;
use lovelock_project::journal::{Event, Journal, Journals};
use lovelock_project::unfinished::Recordings;

use super::Window;
use super::notices::Kind;
use super::purpose::Purpose;
use offer::Offers;
use unfinished::Works;

/// Seconds between two pictures of an edited project.
const PICTURE_SECS: f64 = 15.0;

/// What keeps the work of the user safe. By default it does nothing, as in tests.
#[derive(Default)]
pub(super) struct Safety {
    journals: Journals,
    grants: Grants,
    journal: Option<Journal>,
    offers: Offers,
    works: Works,
    /// The project in the last picture.
    pictured: Option<(Arc<Project>, Stopwatch)>,
    /// What the user had picked, the take that was recorded last, and the file of the project, when they were remembered.
    remembered: (Access, Option<PathBuf>, Option<PathBuf>),
    /// The file of the project when it was opened or saved last.
    stamp: Option<Stamp>,
    failures: failures::Failures,
}

/// A file by its size and time.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Stamp {
    path: PathBuf,
    modified: Option<SystemTime>,
    bytes: u64,
}

impl Stamp {
    fn of(path: &Path) -> Option<Self> {
        let data = std::fs::metadata(path).ok()?;
        Some(Self { path: path.to_owned(), modified: data.modified().ok(), bytes: data.len() })
    }
}

impl Safety {
    /// That of a user's window, which is woken when there is something to tell.
    fn start(
        (journals, grants, recordings): (Journals, Grants, Recordings),
        ctx: &Context,
    ) -> Result<Self, ProjectError> {
        let wake = ctx.clone();
        let journal = Some(Journal::waking(journals.clone(), move || super::images::wake(&wake))?);
        let works = Works::new(recordings);
        Ok(Self { journals, grants, journal, works, ..Self::default() })
    }

    /// Whether work is kept safe: in a user's window, not in tests.
    pub(super) fn is_kept(&self) -> bool {
        self.journal.is_some()
    }

    /// Whether a dialog is open.
    pub(super) fn is_asking(&self) -> bool {
        self.offers.is_open() || self.works.is_open()
    }

    /// Remembers the file of the project as it is now.
    pub(super) fn stamp(&mut self, path: Option<&Path>) {
        self.stamp = path.and_then(Stamp::of);
    }

    /// Says if the file at `path` is no longer the one that was opened or saved, once.
    pub(super) fn check_stamp(&mut self, path: &Path) -> Result<(), String> {
        let Some(known) = self.stamp.as_ref().filter(|known| known.path == path) else { return Ok(()) };
        let now = Stamp::of(path);
        if now.is_none() || now.as_ref() == Some(known) {
            return Ok(());
        }
        self.stamp = now;
        Err(format!(
            "{} was written by another program since it was opened here. Save again to replace it, or save under another name.",
            path.display()
        ))
    }

    /// Writes all changes to the disk now. Returns whether that succeeded.
    fn flush(&mut self, document: &lovelock_project::document::Document) -> bool {
        let within = std::time::Duration::from_secs(3);
        self.journal.as_mut().is_some_and(|journal| journal.flush(document, within))
    }
}

impl Window {
    /// Begins to keep the work of the user safe, and offers what earlier runs left.
    pub(super) fn begin_safety(&mut self, ctx: &Context) -> Result<(), ProjectError> {
        self.begin_safety_in((Journals::of_user(), Grants::of_user(), Recordings::of_user()), ctx)?;
        self.safety.failures = failures::Failures::of_user();
        self.tell_earlier_failures();
        Ok(())
    }

    pub(super) fn begin_safety_in(
        &mut self,
        kept: (Journals, Grants, Recordings),
        ctx: &Context,
    ) -> Result<(), ProjectError> {
        self.safety = Safety::start(kept, ctx)?;
        self.safety.stamp(self.document.path());
        self.find_unsaved(ctx);
        self.safety.works.find();
        Ok(())
    }

    /// Hands on what has changed, tells what happened, and shows what is offered. Called at the end of every pass.
    pub(super) fn keep_safe(&mut self, ctx: &Context) {
        self.tell_failures();
        let Some(journal) = &mut self.safety.journal else { return };
        if let Some(again) = journal.follow(&self.document) {
            ctx.request_repaint_after(again);
        }
        for event in journal.events() {
            self.tell_journal(event, ctx);
        }
        self.follow_take();
        self.follow_again();
        self.keep_picture();
        self.remember_picked();
    }

    fn tell_journal(&mut self, event: Event, ctx: &Context) {
        match event {
            Event::OpenElsewhere(owner) => self.notices.push(
                Kind::Failed,
                format!(
                    "This project is also open in another Lovelock (process {}). What is saved last replaces the rest: save one of \
                     them under another name.",
                    owner.process
                ),
            ),
            Event::Found => {
                self.find_unsaved(ctx);
            }
            Event::KeptElsewhere { folder, error, kept_in } => {
                // Nothing is at risk before the first change.
                let kind = if self.document.is_modified() { Kind::Failed } else { Kind::Warning };
                let (folder, kept_in) = (folder.display(), kept_in.display());
                self.notices.push(
                    kind,
                    format!(
                        "{folder} cannot be written ({error}). Your changes are kept in {kept_in}, and Save asks for another place."
                    ),
                );
            }
            Event::NotKept { folder, error } => self.fail(format!(
                "Unsaved changes are not kept safe: {} cannot be written ({error}). You can go on; save the project elsewhere \
                 with Ctrl+Shift+S.",
                folder.display()
            )),
            Event::KeptAgain => self.notices.push(Kind::Done, "Unsaved changes are kept safe again."),
        }
    }

    /// Keeps a small picture beside the journal, now and then.
    fn keep_picture(&mut self) {
        let Some(journal) = &self.safety.journal else { return };
        let project = self.document.project();
        let due = self
            .safety
            .pictured
            .as_ref()
            .is_none_or(|(of, since)| !Arc::ptr_eq(of, project) && since.secs() > PICTURE_SECS);
        let painted = self.session.painted.as_ref().filter(|_| due && self.document.is_modified());
        if let Some(small) = painted.and_then(|painted| picture::small(&painted.image)) {
            journal.keep_picture(small);
            self.safety.pictured = Some((Arc::clone(project), Stopwatch::start()));
        }
    }

    /// Remembers what the user has picked for this project, and for a take that was recorded from it.
    fn remember_picked(&mut self) {
        let (access, take) = (self.session.access(), &self.session.saved_take);
        let path = self.document.path();
        let (known_access, known_take, known_path) = &self.safety.remembered;
        // Saved under another name in the same folder, the access stays the same.
        if (access, take, path) == (known_access, known_take, known_path.as_deref()) {
            return;
        }
        let made = self.document.path().into_iter().chain(take.as_deref());
        for made in made {
            let project = self.document.project();
            let methods =
                project.user_methods().into_iter().map(|method| FileRef::new(method.description_file()));
            let methods: Vec<FileRef> = methods.collect();
            let files = project.files().into_iter().map(|(_, file)| file);
            self.safety.grants.remember(made, files.chain(&methods), access);
        }
        self.safety.remembered = (access.clone(), take.clone(), path.map(Path::to_owned));
    }

    /// Lets the project or take at `path` read what the user picked for it on an earlier day.
    pub(super) fn allow_granted(&mut self, path: &Path) {
        let grants = self.safety.grants.clone();
        self.session.allow(|access| grants.allow(path, access));
    }

    /// Says that saving failed, and asks for another place.
    pub(super) fn save_elsewhere(&mut self, error: String) {
        self.open_path_dialog(Purpose::SaveProject);
        if let Some(dialog) = &mut self.files.dialog {
            dialog.refuse(error);
        }
    }

    /// Writes all changes to the disk.
    #[cfg(test)]
    pub(super) fn flush_for_test(&mut self) -> bool {
        self.safety.flush(&self.document)
    }

    /// Ends the journal when the window closes. Its file stays if the window closes for another reason than the user's.
    pub(super) fn end_safety(&mut self) {
        let is_meant = self.files.quitting || !self.document.is_modified();
        match self.safety.journal.take() {
            Some(journal) if is_meant && !self.safety.failures.gives_up() => journal.close(),
            journal => drop(journal),
        }
    }
}
