//! Where journals lie, and those that earlier runs left.

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::date;
use lovelock_record::claim;

use super::note;
use super::owner::Owner;
use super::reader::{Contents, owner_in};
use crate::error::ProjectError;
use crate::files::{canonical, write_whole};
use crate::history::History;
use crate::state_folder::state_folder;

/// The extension of journals, without the dot.
const EXTENSION: &str = "journal";
/// The extension of files that hold the path of a journal beside its project.
const POINTER: &str = "at";
/// The extension of the picture of a journal.
const PICTURE: &str = "png";
/// The most journals that are listed.
const MOST: usize = 200;

/// Where journals lie: beside their project as a hidden file, otherwise in a folder of the user.
#[derive(Clone, Debug, Default)]
pub struct Journals {
    folder: Option<PathBuf>,
}

/// Changes that an earlier run of the program did not save.
#[derive(Debug)]
pub struct Unsaved {
    journal: PathBuf,
    /// The file of the project; `None` for one that was never saved.
    pub project: Option<PathBuf>,
    /// When the last change was written.
    pub changed: SystemTime,
    /// The number of steps that can be undone.
    pub steps: usize,
    /// A small picture of it, if one was made.
    pub picture: Option<PathBuf>,
    /// The program that wrote it.
    pub owner: Owner,
    /// Whether the file of the project was written after the last change.
    pub saved_later: bool,
}

impl Journals {
    /// Those of the user: [`state_folder`]`/journals`.
    pub fn of_user() -> Self {
        Self { folder: state_folder().map(|folder| folder.join("journals")) }
    }

    /// Those in `folder`, which need not be there yet, and those beside projects.
    pub fn new(folder: impl Into<PathBuf>) -> Self {
        Self { folder: Some(folder.into()) }
    }

    /// The folder of journals that cannot lie beside their project.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// What earlier runs did not save, the newest first. Journals beside projects are found if this user wrote them, and the one of `opened`
    /// always. Journals of programs that run are left alone.
    pub fn unsaved(&self, opened: Option<&Path>) -> Vec<Unsaved> {
        for pointer in self.files(POINTER) {
            let beside = fs::read_to_string(&pointer).map(PathBuf::from);
            let gone =
                beside.is_ok_and(|beside| self.set_aside_dead(&beside).is_ok_and(|aside| !aside.stays()));
            if gone {
                let _ = fs::remove_file(&pointer);
            }
        }
        if let Some(project) = opened {
            let _ = self.set_aside_dead(&beside(project));
        }
        // Those that were written here get names that no program writes to.
        for journal in self.files(EXTENSION).iter().filter(|journal| !is_aside(journal)) {
            let _ = self.set_aside_dead(journal);
        }
        let mut found: Vec<Unsaved> = self
            .files(EXTENSION)
            .into_iter()
            .filter(|journal| is_aside(journal))
            .take(MOST)
            .filter_map(|journal| unsaved_in(&journal))
            .collect();
        found.sort_by_key(|unsaved| std::cmp::Reverse(unsaved.changed));
        found
    }

    /// The files in the folder with an extension.
    fn files(&self, extension: &str) -> Vec<PathBuf> {
        let entries = self.folder.as_ref().and_then(|folder| fs::read_dir(folder).ok());
        let paths = entries.into_iter().flatten().filter_map(|entry| Some(entry.ok()?.path()));
        let mut paths: Vec<_> =
            paths.filter(|path| path.extension().is_some_and(|found| found == extension)).collect();
        paths.sort();
        paths
    }

    /// Moves a journal that no program writes to the folder, if it holds unsaved changes; otherwise removes it. One that can only be
    /// read is copied, and stays. One of a newer version stays, too.
    ///
    /// # Errors
    /// If it cannot be moved or copied.
    pub(super) fn set_aside_dead(&self, journal: &Path) -> io::Result<Aside> {
        if !journal.exists() {
            note::forget(journal);
            return Ok(Aside::Nothing);
        }
        let (mut file, stays) = match open_dead(journal) {
            Ok(opened) => opened,
            Err(error) if error.kind() == io::ErrorKind::ResourceBusy => {
                let owner = File::open(journal).and_then(owner_in);
                return Ok(Aside::Busy(owner.ok().flatten().unwrap_or_default()));
            }
            Err(error) => return Err(error),
        };
        note::forget(journal);
        let is_in_folder = journal.parent() == self.folder();
        // One in the folder of a project names it. A foreign one that does not is not trusted with the files in it.
        let is_own = |contents: &Contents| is_in_folder || contents.last.project.is_some();
        let found = match Contents::read(&mut file) {
            Err(error) if error.kind() == io::ErrorKind::Unsupported => return Ok(Aside::Newer),
            found => found?,
        };
        let Some(contents) = found.filter(|contents| contents.last.modified && is_own(contents)) else {
            if !stays {
                fs::remove_file(journal)?;
            }
            return Ok(Aside::Nothing);
        };
        let named = contents.last.project.clone();
        // Beside a project, only the place counts: the folder may have been renamed or copied, and a foreign journal may name any file.
        let project =
            if is_in_folder { named.clone() } else { Some(project_beside(journal, named.as_deref())) };
        let renamed = project.as_deref().filter(|project| Some(*project) != named.as_deref());
        let renamed = renamed.map(|project| contents.of_project(project)).transpose()?;
        let name = name_of(project.as_deref(), &contents.owner);
        let folder = self.folder.clone().or_else(|| journal.parent().map(Path::to_owned)).unwrap_or_default();
        fs::create_dir_all(&folder)?;
        let aside = |ms| folder.join(format!("{name}.{ms}.{EXTENSION}"));
        let mut times = contents.last.time_ms..;
        if stays && aside(contents.last.time_ms).exists() {
            return Ok(Aside::Nothing);
        }
        let aside = times.find(|ms| !aside(*ms).exists()).map(aside).unwrap_or_default();
        let picture = folder.join(format!("{name}.{PICTURE}"));
        let _ = fs::rename(picture, aside.with_extension(PICTURE));
        if stays || renamed.is_some() || fs::rename(journal, &aside).is_err() {
            // It names another project now, stays, or is on another disk.
            write_whole(&aside, renamed.as_deref().unwrap_or(contents.bytes())).map_err(io::Error::other)?;
            if !stays {
                fs::remove_file(journal)?;
            }
        }
        Ok(Aside::Moved)
    }

    /// The paths of a new journal, the best first.
    pub(super) fn places(&self, project: Option<&Path>, owner: &Owner) -> Vec<PathBuf> {
        let inner = self.in_folder(project, owner, EXTENSION);
        project.map(beside).into_iter().chain(inner).collect()
    }

    /// The path of a journal for a project that another program has open.
    pub(super) fn second_place(&self, project: Option<&Path>, owner: &Owner) -> Option<PathBuf> {
        let name = name_of(project, owner);
        Some(self.folder.as_ref()?.join(format!("{name}-{}.{EXTENSION}", owner.process)))
    }

    /// The path of the picture of a journal.
    pub(super) fn picture(&self, project: Option<&Path>, owner: &Owner) -> Option<PathBuf> {
        self.in_folder(project, owner, PICTURE)
    }

    /// The path of the file that holds the path of a journal beside its project.
    pub(super) fn pointer(&self, project: &Path, owner: &Owner) -> Option<PathBuf> {
        self.in_folder(Some(project), owner, POINTER)
    }

    fn in_folder(&self, project: Option<&Path>, owner: &Owner, extension: &str) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join(format!("{}.{extension}", name_of(project, owner))))
    }
}

/// What became of a journal that was found.
#[derive(Debug)]
pub(super) enum Aside {
    /// There was none with unsaved changes that the folder lacks. None is there now, unless it can only be read.
    Nothing,
    /// It is in the folder.
    Moved,
    /// A program writes it.
    Busy(Owner),
    /// A newer version of the program has written it, and can read it.
    Newer,
}

impl Aside {
    /// Whether it is left where it is, for another program.
    fn stays(&self) -> bool {
        matches!(self, Self::Busy(_) | Self::Newer)
    }
}

/// Opens a journal that no program writes, and locks it. The second value says whether it can only be read, as on a disk that became
/// read-only, or if it is another user's.
///
/// # Errors
/// [`io::ErrorKind::ResourceBusy`] if a program writes it.
fn open_dead(journal: &Path) -> io::Result<(File, bool)> {
    let read_only = |error: &io::Error| {
        matches!(error.kind(), io::ErrorKind::ReadOnlyFilesystem | io::ErrorKind::PermissionDenied)
    };
    match claim(journal) {
        Ok(file) => return Ok((file, false)),
        Err(error) if read_only(&error) => {}
        Err(error) => return Err(error),
    }
    let file = File::open(journal)?;
    match file.try_lock_shared() {
        Err(TryLockError::WouldBlock) => Err(io::ErrorKind::ResourceBusy.into()),
        // As in `claim`, a file system without locks keeps nobody apart.
        Err(TryLockError::Error(error)) if error.kind() != io::ErrorKind::Unsupported => Err(error),
        Ok(()) | Err(TryLockError::Error(_)) => Ok((file, true)),
    }
}

/// The hidden journal beside a project.
pub(super) fn beside(project: &Path) -> PathBuf {
    let name = project.file_name().unwrap_or_default().to_string_lossy();
    project.with_file_name(format!(".{name}.{EXTENSION}"))
}

/// The project that a journal lies beside. `named` is the one it names: names that are not Unicode can be taken from there only.
fn project_beside(journal: &Path, named: Option<&Path>) -> PathBuf {
    let journal = std::path::absolute(journal).unwrap_or_else(|_| journal.to_owned());
    if let Some(named) = named.filter(|named| beside(named) == journal) {
        return named.to_owned();
    }
    let name = journal.file_stem().unwrap_or_default().to_string_lossy();
    journal.with_file_name(name.strip_prefix('.').unwrap_or(&name))
}

/// Whether a journal is one that was set aside: its name ends in a time.
fn is_aside(journal: &Path) -> bool {
    Path::new(journal.file_stem().unwrap_or_default()).extension().is_some()
}

/// The name of a journal in the folder, without extension.
fn name_of(project: Option<&Path>, owner: &Owner) -> String {
    let Some(project) = project else { return format!("untitled-{}-{}", owner.process, owner.since_ms) };
    let path = canonical(project);
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let stem: String =
        stem.chars().filter(|letter| letter.is_alphanumeric() || " _-".contains(*letter)).take(40).collect();
    format!("{stem}-{:08x}", crc32fast::hash(path.as_os_str().as_encoded_bytes()))
}

/// What a journal in the folder holds. One without unsaved changes is removed.
fn unsaved_in(journal: &Path) -> Option<Unsaved> {
    // Held while it is read, so that no other program removes it.
    let mut file = claim(journal).ok()?;
    let contents = Contents::read(&mut file).ok()?;
    let Some(contents) = contents.filter(|contents| contents.last.modified) else {
        remove_with_picture(journal);
        return None;
    };
    let changed = date::of_unix_ms(contents.last.time_ms);
    let project = contents.last.project.clone();
    let written = project.as_ref().and_then(|path| fs::metadata(path).ok()?.modified().ok());
    let picture = journal.with_extension(PICTURE);
    Some(Unsaved {
        steps: contents.steps(),
        saved_later: written.is_some_and(|written| written > changed),
        picture: picture.exists().then_some(picture),
        owner: contents.owner,
        journal: journal.to_owned(),
        project,
        changed,
    })
}

fn remove_with_picture(journal: &Path) {
    // Nothing depends on it: a journal that stays is offered again.
    let _ = fs::remove_file(journal);
    let _ = fs::remove_file(journal.with_extension(PICTURE));
}

impl Unsaved {
    /// The file of the journal.
    pub fn journal(&self) -> &Path {
        &self.journal
    }

    /// Its name for people: that of the project's file.
    pub fn name(&self) -> String {
        let stem = self.project.as_deref().and_then(Path::file_stem);
        stem.map_or_else(|| "untitled".to_owned(), |stem| stem.to_string_lossy().into_owned())
    }

    /// The project with its undo steps. The journal stays until it is discarded.
    ///
    /// # Errors
    /// If it was removed, another program recovers it, or it is damaged.
    pub fn history(&self) -> Result<History, ProjectError> {
        let journal = &self.journal;
        let failed =
            |error| ProjectError::output(journal, format!("{}: cannot be read: {error}", journal.display()));
        let mut file = File::open(journal).map_err(failed)?;
        let contents = Contents::read(&mut file).map_err(failed)?;
        let empty = || ProjectError::input(journal, format!("{}: holds no project", journal.display()));
        contents.ok_or_else(empty)?.history(journal)
    }

    /// Removes it for good.
    pub fn discard(self) {
        remove_with_picture(&self.journal);
    }
}
