//! The thread that writes a journal.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender};
use std::time::Duration;

use lovelock_base::clock::Stopwatch;
use lovelock_record::{claim, is_still};

use super::encoder::Encoder;
use super::folder::{Aside, Journals, Unsaved};
use super::note;
use super::owner::Owner;
use crate::history::HistoryMark;

/// After that time without changes, what was written is made to reach the disk: it survives a power failure too.
const SYNC_IDLE: Duration = Duration::from_millis(900);
/// While changes go on, it reaches the disk that often.
const SYNC_EVERY_SECS: f64 = 2.0;
/// How long after a failure it tries again.
const RETRY: Duration = Duration::from_secs(5);
/// How often it looks whether another program has opened the project, too.
const LOOK: Duration = Duration::from_secs(1);
/// A journal that has grown by that many bytes, and by twice its first length, is written anew.
const GROWS_BY: u64 = 8 << 20;

/// A history and the file of its project.
#[derive(Clone, Debug)]
pub(super) struct Marked {
    pub history: HistoryMark,
    pub project: Option<PathBuf>,
}

impl Marked {
    fn is_modified(&self) -> bool {
        !Arc::ptr_eq(&self.history.present, &self.history.saved) && self.history.present != self.history.saved
    }
}

/// A small picture of a project: RGBA, 8-bit sRGB, rows from the top.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `width × height × 4` bytes.
    pub rgba: Vec<u8>,
}

/// What the thread is told.
pub(super) enum Message {
    Mark(Arc<Marked>),
    Picture(Picture),
    /// Remove it once the changes are in the new journal.
    Replaces(Box<Unsaved>),
    /// Write all, make it reach the disk, and answer whether it did.
    Flush(SyncSender<bool>),
    /// The project was saved or given up: remove the journal.
    Close,
}

/// What happened to a journal that the user should know.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// Another program has the project open, whichever of the two was first.
    OpenElsewhere(Owner),
    /// The project that was opened has unsaved changes of an earlier run. They are among [`Journals::unsaved`].
    Found,
    /// The folder of the project cannot be written. Changes are kept in another one. Told when the project is opened, before there are any.
    KeptElsewhere {
        /// The folder that cannot be written.
        folder: PathBuf,
        /// Why.
        error: String,
        /// Where they are.
        kept_in: PathBuf,
    },
    /// Changes cannot be written anywhere.
    NotKept {
        /// The folder that was tried last.
        folder: PathBuf,
        /// Why.
        error: String,
    },
    /// Changes are kept again.
    KeptAgain,
}

/// The file that is written.
struct Slot {
    path: PathBuf,
    project: Option<PathBuf>,
    pointer: Option<PathBuf>,
    file: File,
    encoder: Encoder,
    /// Length when it was begun, and now.
    bytes: [u64; 2],
}

/// The thread.
pub(super) struct Writer {
    journals: Journals,
    owner: Owner,
    events: SyncSender<Event>,
    /// Called when there is an event.
    wake: Box<dyn Fn() + Send>,
    slot: Option<Slot>,
    /// A file of this program that could not be written any further. What is in it stays until another one has all.
    broken: Option<Slot>,
    marked: Option<Arc<Marked>>,
    replaced: Vec<Unsaved>,
    /// The number of those whose changes are in the newest mark.
    covered: usize,
    /// The time since the last sync, while something was written since.
    unsynced: Option<Stopwatch>,
    /// Why the last attempt failed.
    trouble: Option<Event>,
    /// The journal of a program that had the project open first. That program has a note.
    met: Option<(PathBuf, Owner)>,
    /// The program that has opened the project after this one.
    joined: Option<Owner>,
    looked: Stopwatch,
}

impl Writer {
    pub(super) fn new(journals: Journals, events: SyncSender<Event>, wake: Box<dyn Fn() + Send>) -> Self {
        Self {
            journals,
            owner: Owner::this(),
            events,
            wake,
            slot: None,
            broken: None,
            marked: None,
            replaced: Vec::new(),
            covered: 0,
            unsynced: None,
            trouble: None,
            met: None,
            joined: None,
            looked: Stopwatch::start(),
        }
    }

    /// Writes what it is told until the other side is dropped.
    pub(super) fn run(mut self, messages: &Receiver<Message>) {
        loop {
            let fails = matches!(self.trouble, Some(Event::NotKept { .. }));
            let wait = match self.project_slot() {
                _ if self.unsynced.is_some() => SYNC_IDLE,
                Some(_) => LOOK,
                None => RETRY,
            };
            let first = match messages.recv_timeout(wait) {
                Ok(message) => Some(message),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => break,
            };
            let is_idle = first.is_none();
            let (mut flushes, mut picture, mut closes, mut is_marked) = (Vec::new(), None, false, false);
            // Only the newest of several marks is written.
            for message in first.into_iter().chain(messages.try_iter()) {
                match message {
                    Message::Mark(marked) => {
                        (self.marked, is_marked) = (Some(marked), true);
                        self.covered = self.replaced.len();
                    }
                    Message::Picture(new) => picture = Some(new),
                    Message::Replaces(unsaved) => self.replaced.push(*unsaved),
                    Message::Flush(answer) => flushes.push(answer),
                    Message::Close => closes = true,
                }
            }
            if closes {
                (self.marked, self.unsynced) = (None, None);
                for slot in self.slot.take().into_iter().chain(self.broken.take()) {
                    self.remove(slot);
                }
            } else if is_marked || !flushes.is_empty() || (is_idle && fails) {
                self.write();
            }
            if let Some(picture) = picture {
                self.write_picture(&picture);
            }
            if self.looked.elapsed() >= LOOK || !flushes.is_empty() {
                self.look();
            }
            let often = self.unsynced.is_some_and(|since| since.secs() > SYNC_EVERY_SECS);
            if is_idle || often || !flushes.is_empty() {
                self.sync();
            }
            let is_kept = self.slot.is_some();
            for answer in flushes {
                let _ = answer.try_send(is_kept);
            }
        }
        self.sync();
    }

    /// The file that is written, if it is that of a project with a file, which other programs may open.
    fn project_slot(&self) -> Option<&Slot> {
        self.slot.as_ref().filter(|slot| slot.project.is_some())
    }

    /// Tells if another program has opened the project, once for each.
    fn look(&mut self) {
        self.looked = Stopwatch::start();
        // One that was removed or replaced is written elsewhere.
        if self.project_slot().is_some_and(|slot| !is_still(&slot.file, &slot.path)) {
            self.write();
        }
        let joined = self.project_slot().and_then(|slot| note::take(&slot.path));
        if let Some(owner) = joined.filter(|owner| self.joined.as_ref() != Some(owner)) {
            self.joined = Some(owner.clone());
            self.tell(Event::OpenElsewhere(owner));
        }
        self.follow_first();
    }

    /// Follows the program that had the project open first. When it has ended, its place is taken: a program that opens the project next is
    /// noticed there. If another one has taken it already, both are told.
    fn follow_first(&mut self) {
        let Some((place, first)) = self.met.clone() else { return };
        let Some(slot) = self.project_slot() else { return };
        if slot.path == place {
            self.met = None;
            return;
        }
        // What cannot be set aside now is tried again at the next look.
        let Ok(aside) = self.journals.set_aside_dead(&place) else { return };
        match aside {
            Aside::Busy(owner) => {
                if owner != first && owner != self.owner {
                    self.meet(&place, owner);
                }
                return;
            }
            Aside::Newer => return,
            Aside::Moved => self.tell(Event::Found),
            Aside::Nothing => {}
        }
        // One that can only be read stays.
        let Some(marked) = self.marked.clone().filter(|_| !place.exists()) else { return };
        if let Ok(slot) = self.begin(place, &marked, take_name) {
            self.met = None;
            // All of the one before is in the new one. A file of another program may have its name by now.
            if let Some(before) = self.slot.replace(slot)
                && is_still(&before.file, &before.path)
            {
                let _ = fs::remove_file(&before.path);
                note::forget(&before.path);
            }
        }
    }

    /// Tells this program and the one that writes the journal at `place` of each other.
    fn meet(&mut self, place: &Path, owner: Owner) {
        note::leave(place, &self.owner);
        self.met = Some((place.to_owned(), owner.clone()));
        self.tell(Event::OpenElsewhere(owner));
    }

    fn tell(&self, event: Event) {
        // If nobody reads them, nobody needs more of them.
        let _ = self.events.try_send(event);
        (self.wake)();
    }

    fn sync(&mut self) {
        if self.unsynced.take().is_none() {
            return;
        }
        if let Some(slot) = &self.slot
            && let Err(error) = slot.file.sync_data()
        {
            let folder = folder_of(&slot.path);
            self.broken = self.slot.take();
            self.report(Some(Event::NotKept { folder, error: error.to_string() }));
            return;
        }
        if self.slot.is_some() {
            let covered = std::mem::take(&mut self.covered);
            self.replaced.drain(..covered).for_each(Unsaved::discard);
        }
    }

    /// Reports trouble when it begins, changes or ends.
    fn report(&mut self, trouble: Option<Event>) {
        if trouble == self.trouble {
            return;
        }
        match &trouble {
            Some(event) => self.tell(event.clone()),
            None if matches!(self.trouble, Some(Event::NotKept { .. })) => self.tell(Event::KeptAgain),
            None => {}
        }
        self.trouble = trouble;
    }

    /// Writes the newest mark.
    fn write(&mut self) {
        let Some(marked) = self.marked.take() else { return };
        let moves = self.slot.as_ref().is_some_and(|slot| slot.project != marked.project);
        // Files that were removed can still be written, and are lost.
        let is_gone = self.slot.as_ref().is_some_and(|slot| !is_still(&slot.file, &slot.path));
        // The project was saved elsewhere or replaced. The old journal stays until there is a new one.
        let before = if moves { self.slot.take() } else { None };
        if moves {
            (self.met, self.joined) = (None, None);
        }
        if is_gone {
            self.slot = None;
        }
        if let Some(slot) = &mut self.slot
            && slot.append(&marked).is_err()
        {
            self.broken = self.slot.take();
        }
        let grown = self.slot.as_ref().is_some_and(|slot| slot.bytes[1] > slot.bytes[0] * 3 + GROWS_BY);
        if grown && let Some(slot) = &self.slot {
            let path = slot.path.clone();
            if let Ok(slot) = self.begin(path, &marked, replace) {
                self.slot = Some(slot);
            }
        }
        // An untitled project that nobody has touched needs none.
        let needs = marked.project.is_some() || marked.is_modified() || !marked.history.past.is_empty();
        if self.slot.is_none() && needs {
            self.open(&marked);
        }
        if let Some(slot) = &self.slot
            && let Some(broken) = self.broken.take_if(|broken| broken.path != slot.path)
        {
            self.remove(broken);
        }
        if self.slot.is_some() {
            self.broken = None;
        }
        if let Some(before) = before.filter(|_| self.slot.is_some() || !needs) {
            self.remove(before);
        }
        if self.slot.is_some() {
            self.unsynced.get_or_insert_with(Stopwatch::start);
        }
        self.marked = Some(marked);
    }

    /// Opens a journal at the first place that can be written.
    fn open(&mut self, marked: &Marked) {
        let project = marked.project.as_deref();
        let mut failed: Option<(PathBuf, io::Error)> = None;
        let mut places = self.journals.places(project, &self.owner);
        places.reverse();
        let second = self.journals.second_place(project, &self.owner);
        let mut is_busy = false;
        while let Some(place) = places.pop() {
            let is_own = self
                .broken
                .as_ref()
                .is_some_and(|broken| broken.path == place && is_still(&broken.file, &broken.path));
            let aside = self.journals.set_aside_dead(&place);
            // One that can only be read stays, and so does one of a newer version: no program has the place.
            let stays = match &aside {
                Ok(Aside::Newer) => true,
                Ok(Aside::Moved | Aside::Nothing) => place.exists(),
                Ok(Aside::Busy(_)) | Err(_) => false,
            };
            let opened = match aside {
                Ok(Aside::Busy(_)) if is_own => self.begin(place.clone(), marked, replace),
                Ok(Aside::Busy(owner)) => {
                    // Not again when it tries again after a failure.
                    let is_met =
                        self.met.as_ref().is_some_and(|(met, first)| *met == place && *first == owner);
                    if !is_busy && !is_met && owner != self.owner {
                        self.meet(&place, owner);
                    }
                    Err(io::ErrorKind::ResourceBusy.into())
                }
                Ok(Aside::Newer) => Err(io::ErrorKind::AlreadyExists.into()),
                Ok(Aside::Moved) => {
                    self.tell(Event::Found);
                    self.begin(place.clone(), marked, take_name)
                }
                Ok(Aside::Nothing) => self.begin(place.clone(), marked, take_name),
                // Its kind does not say who has the place.
                Err(error) => Err(io::Error::other(error)),
            };
            match opened {
                Ok(slot) => {
                    let kept_in = folder_of(&slot.path);
                    self.slot = Some(slot);
                    let elsewhere = failed.map(|(folder, error)| Event::KeptElsewhere {
                        folder,
                        error: error.to_string(),
                        kept_in,
                    });
                    self.report(elsewhere);
                    return;
                }
                Err(error) if is_taken(&error) => {
                    is_busy = true;
                    places = second.clone().into_iter().filter(|second| *second != place).collect();
                    // A program that takes the place at this very moment is met at the next look.
                    if !stays {
                        self.met.get_or_insert((place, Owner::default()));
                    }
                }
                Err(error) => {
                    failed.get_or_insert((folder_of(&place), error));
                }
            }
        }
        let (folder, error) =
            failed.unwrap_or_else(|| (PathBuf::new(), io::Error::other("there is no folder for them")));
        self.report(Some(Event::NotKept { folder, error: error.to_string() }));
    }

    /// Begins a journal with all of the history under another name, then publishes it by [`take_name`] or [`replace`].
    ///
    /// # Errors
    /// Those of [`is_taken`] if another program begins one there; others if it cannot be written.
    fn begin(
        &self,
        path: PathBuf,
        marked: &Marked,
        publish: fn(&Path, &Path) -> io::Result<()>,
    ) -> io::Result<Slot> {
        let project = marked.project.clone();
        let is_beside = self.journals.folder() != path.parent();
        if !is_beside && let Some(folder) = path.parent() {
            fs::create_dir_all(folder).map_err(io::Error::other)?;
        }
        let (encoder, bytes) = Encoder::begin(&self.owner, &marked.history, project.as_deref())?;
        let partial = path.with_extension("journal-partial");
        let mut file = claim(&partial)?;
        // What a killed program left may be a journal, too, by another name: it must not be written over.
        if file.metadata()?.len() > 0 {
            fs::remove_file(&partial)?;
            file = claim(&partial)?;
        }
        let written =
            file.write_all(&bytes).and_then(|()| file.sync_all()).and_then(|()| publish(&partial, &path));
        if let Err(error) = written {
            // The error that matters is the first one.
            let _ = fs::remove_file(&partial);
            return Err(error);
        }
        let pointer = project.as_deref().filter(|_| is_beside).and_then(|project| self.point(project, &path));
        let length = bytes.len() as u64;
        Ok(Slot { path, project, pointer, file, encoder, bytes: [length; 2] })
    }

    /// Writes down where a journal beside its project is, so that the next start finds it.
    fn point(&self, project: &Path, journal: &Path) -> Option<PathBuf> {
        let pointer = self.journals.pointer(project, &self.owner)?;
        let journal = std::path::absolute(journal).ok()?;
        fs::create_dir_all(pointer.parent()?).ok()?;
        fs::write(&pointer, journal.to_str()?).ok()?;
        Some(pointer)
    }

    /// Removes a journal: the project was saved or given up.
    fn remove(&self, slot: Slot) {
        // A file of another program may have its name by now.
        if is_still(&slot.file, &slot.path) {
            // What cannot be removed holds a saved state, or is offered again.
            let _ = fs::remove_file(&slot.path);
            note::forget(&slot.path);
            slot.pointer.map(fs::remove_file);
        }
        self.journals.picture(slot.project.as_deref(), &self.owner).map(fs::remove_file);
    }

    fn write_picture(&self, picture: &Picture) {
        let Some(slot) = &self.slot else { return };
        if let Some(path) = self.journals.picture(slot.project.as_deref(), &self.owner) {
            // Nothing is lost without it.
            let _ = path.parent().map(fs::create_dir_all);
            let _ = lovelock_record::write_png(&path, picture.width, picture.height, &picture.rgba);
        }
    }
}

impl Slot {
    fn append(&mut self, marked: &Marked) -> io::Result<()> {
        let mut bytes = Vec::new();
        self.encoder.append(&marked.history, marked.project.as_deref(), &mut bytes)?;
        self.file.write_all(&bytes)?;
        self.bytes[1] += bytes.len() as u64;
        Ok(())
    }
}

fn folder_of(path: &Path) -> PathBuf {
    path.parent().map(Path::to_owned).unwrap_or_default()
}

/// Gives a journal a name that no other file has: two programs that begin at the same moment must not replace each other's.
fn take_name(partial: &Path, path: &Path) -> io::Result<()> {
    match fs::hard_link(partial, path) {
        Ok(()) => fs::remove_file(partial),
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Err(error),
        // Not every file system has links.
        Err(_) => fs::rename(partial, path),
    }
}

/// Gives a journal the name of one that this program writes.
fn replace(partial: &Path, path: &Path) -> io::Result<()> {
    fs::rename(partial, path)
}

/// Whether another program has the place of a journal, or begins one there.
fn is_taken(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::AlreadyExists | io::ErrorKind::ResourceBusy)
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::sync_channel;

    use super::super::folder::beside;
    use super::*;
    use crate::Project;
    use crate::document::Document;

    /// Two programs on a project with unsaved changes, whose folder has no journal yet.
    fn two_writers(folder: &Path) -> ([Writer; 2], Marked) {
        let project = folder.join("red hair.lovelock");
        let mut document = Document::new(Project::default(), Some(project.clone()));
        document.change("camera", |project| project.camera.distance = 7.0);
        let marked = Marked { history: document.history().mark(), project: Some(project) };
        let writer = || Writer::new(Journals::new(folder.join("state")), sync_channel(4).0, Box::new(|| ()));
        ([writer(), writer()], marked)
    }

    #[test]
    fn of_two_programs_that_begin_a_journal_at_the_same_moment_one_has_the_place() {
        let folder = tempfile::tempdir().expect("a folder");
        let ([first, second], marked) = two_writers(folder.path());
        let path = beside(marked.project.as_deref().expect("a file"));
        let slot = first.begin(path.clone(), &marked, take_name).expect("begun");
        // The second one has looked before the first one began.
        let error = second.begin(path.clone(), &marked, take_name).err().expect("it is taken");
        assert!(is_taken(&error) && is_still(&slot.file, &path), "{error}");
        assert!(!path.with_extension("journal-partial").exists());
        // Its own one it replaces.
        let slot = first.begin(path.clone(), &marked, replace).expect("begun");
        assert!(is_still(&slot.file, &path));
        // What has another's name by now is not removed.
        fs::remove_file(&path).expect("removed");
        fs::write(&path, "another").expect("a file");
        first.remove(slot);
        assert_eq!(path.exists(), cfg!(unix));
    }

    #[test]
    fn a_journal_that_a_killed_program_left_by_two_names_is_not_written_over() {
        let folder = tempfile::tempdir().expect("a folder");
        let ([first, second], marked) = two_writers(folder.path());
        let path = beside(marked.project.as_deref().expect("a file"));
        drop(first.begin(path.clone(), &marked, take_name).expect("begun"));
        fs::hard_link(&path, path.with_extension("journal-partial")).expect("a link");
        assert!(matches!(second.journals.set_aside_dead(&path), Ok(Aside::Moved)));
        let _slot = second.begin(path.clone(), &marked, take_name).expect("begun");
        let found = second.journals.unsaved(None);
        let distances: Vec<f32> = found
            .iter()
            .map(|unsaved| unsaved.history().expect("a history").project().camera.distance)
            .collect();
        assert_eq!(distances, [7.0]);
    }
}
