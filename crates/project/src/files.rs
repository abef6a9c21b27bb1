//! Files that a project refers to, and which of them it may read.

use std::collections::BTreeSet;
use std::fs::File;
use std::io::Write;
use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::error::{Place, Problem, ProblemKind, ProjectError};

/// A file that a project refers to.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct FileRef {
    /// Absolute in memory. On disk it is relative to the project's folder, with `/` as separator, if it lies in that folder.
    pub path: PathBuf,
    /// On disk: whether the file is outside the project's folder. The user must pick it again before it is read.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub outside: bool,
}

impl FileRef {
    /// A file by its path; a relative path starts at the current folder.
    pub fn new(path: impl Into<PathBuf>) -> Self {
        let path = path.into();
        Self { path: std::path::absolute(&path).unwrap_or(path), outside: false }
    }

    /// The path as a project in `folder` stores it.
    pub(super) fn for_disk(&self, folder: &Path) -> Self {
        let path = canonical(&self.path);
        match path.strip_prefix(canonical(folder)) {
            Ok(inside) if !inside.as_os_str().is_empty() => {
                let names: Vec<_> = inside.iter().map(|name| name.to_string_lossy()).collect();
                Self { path: PathBuf::from(names.join("/")), outside: false }
            }
            _ => Self { path: self.path.clone(), outside: true },
        }
    }

    /// The path in memory of a path that a project in `folder` stores.
    pub(super) fn in_memory(&self, folder: &Path) -> Self {
        let path = folder.join(&self.path);
        Self { path: normal(&path), outside: self.outside }
    }
}

/// Which files a project may read: those in its own folder and below, and those that the user picked.
///
/// A project from an unknown source therefore cannot make the program read or overwrite files whose paths its author guessed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Access {
    folder: Option<PathBuf>,
    /// The folder of the take that is played.
    take_folder: Option<PathBuf>,
    picked: BTreeSet<PathBuf>,
    /// Whether files are picked by options of the command line.
    by_options: bool,
}

impl Access {
    /// Access for a project that has not been saved: only files that the user picks.
    pub fn new() -> Self {
        Self::default()
    }

    /// As [`Access::new`], for a command: a file that it may not read is one that an option can name.
    pub fn of_command() -> Self {
        Self { by_options: true, ..Self::default() }
    }

    /// Access for the project at `path`.
    pub fn for_project(path: &Path) -> Self {
        let mut access = Self::new();
        access.set_project(Some(path));
        access
    }

    /// Sets the project's folder after another project is opened or this one is saved elsewhere. Picked files stay picked.
    pub fn set_project(&mut self, path: Option<&Path>) {
        self.folder = path.map(folder_of).map(|folder| canonical(&folder));
    }

    /// Allows the take at `path` to read files in its folder and below, as for a project. If the folder is called `takes`, which
    /// is where the window saves takes, the parent folder (the project's) is allowed instead.
    pub fn set_take(&mut self, path: &Path) {
        let folder = canonical(&folder_of(path));
        let above = folder.parent().filter(|_| folder.ends_with("takes")).map(Path::to_owned);
        self.take_folder = Some(above.unwrap_or(folder));
    }

    /// Allows a file that the user picked in a dialog, dropped on the window or named on the command line.
    pub fn pick(&mut self, path: &Path) {
        self.picked.insert(canonical(path));
    }

    /// Whether the user picked `path`.
    pub fn is_picked(&self, path: &Path) -> bool {
        self.picked.contains(&canonical(path))
    }

    /// Whether the project may read `path`. Symbolic links are resolved first.
    pub fn allows(&self, path: &Path) -> bool {
        let path = canonical(path);
        let folders = [&self.folder, &self.take_folder];
        self.picked.contains(&path) || folders.into_iter().flatten().any(|folder| path.starts_with(folder))
    }

    /// The path of a file that is to be read.
    ///
    /// # Errors
    /// A problem that says what to do, if the file is missing, is not a file, or is not allowed.
    pub fn read(&self, place: Place, file: &FileRef) -> Result<PathBuf, Problem> {
        let name = file.path.display();
        if !self.allows(&file.path) {
            let option = self.by_options.then(|| place.option()).flatten();
            let how = match option {
                Some(option) => format!("name it by {option} to allow it"),
                None if self.by_options => "name it by --allow to allow it".to_owned(),
                None => "pick the file yourself to allow it".to_owned(),
            };
            return Err(Problem::new(
                place,
                ProblemKind::NeedsPermission(file.path.clone()),
                format!("{name} is outside the project's folder and was not loaded; {how}"),
            ));
        }
        match std::fs::metadata(&file.path) {
            Ok(data) if data.is_file() => Ok(file.path.clone()),
            Ok(_) => Err(Problem::not_loaded(place, format!("{name} is not a file; pick another"))),
            Err(error) => Err(Problem::not_loaded(
                place,
                format!("{name} cannot be read ({error}); put it back or pick another"),
            )),
        }
    }
}

/// The folder of a file, absolute.
pub(super) fn folder_of(path: &Path) -> PathBuf {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    path.parent().map_or_else(|| path.clone(), Path::to_owned)
}

/// The path with symbolic links resolved as far as it exists, and the rest normalised.
pub(crate) fn canonical(path: &Path) -> PathBuf {
    let path = normal(path);
    let mut missing = Vec::new();
    let mut at = path.as_path();
    loop {
        if let Ok(real) = at.canonicalize() {
            return missing.iter().rev().fold(real, |path: PathBuf, name| path.join(name));
        }
        match (at.parent(), at.file_name()) {
            (Some(parent), Some(name)) => {
                missing.push(name.to_owned());
                at = parent;
            }
            _ => return path,
        }
    }
}

/// Absolute, without `.` and `..`.
fn normal(path: &Path) -> PathBuf {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                out.pop();
            }
            part => out.push(part),
        }
    }
    out
}

/// Writes a file beside `path`, flushes it to disk, then renames it, so that no incomplete file has the final name.
///
/// # Errors
/// If the folder cannot be written or the disk is full.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), ProjectError> {
    let partial = partial_name(path);
    let written = File::create(&partial).and_then(|mut file| {
        file.write_all(bytes)?;
        file.sync_all()
    });
    written.and_then(|()| std::fs::rename(&partial, path)).map_err(|error| {
        // The error that matters is the first one.
        let _ = std::fs::remove_file(&partial);
        ProjectError::output(path, format!("{}: could not be saved: {error}", path.display()))
    })
}

/// `NAME.partial` beside `NAME`.
fn partial_name(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".partial");
    path.with_file_name(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_project_reaches_its_own_folder_and_below() {
        let dir = tempfile::tempdir().expect("a folder");
        let inside = dir.path().join("project/hair/a b ü.hair");
        let outside = dir.path().join("secret.hair");
        std::fs::create_dir_all(inside.parent().expect("a parent")).expect("folders");
        std::fs::write(&inside, b"x").expect("a file");
        std::fs::write(&outside, b"x").expect("a file");
        let mut access = Access::for_project(&dir.path().join("project/p.lovelock"));
        assert!(access.allows(&inside));
        assert!(!access.allows(&outside));
        assert!(!access.allows(&dir.path().join("project/../secret.hair")), "a way out by `..`");
        let problem = access.read(Place::Hair, &FileRef::new(&outside)).expect_err("refused");
        assert!(matches!(problem.kind, ProblemKind::NeedsPermission(_)));
        assert!(problem.message.contains("secret.hair"));
        let problem = Access::of_command().read(Place::Motion, &FileRef::new(&outside)).expect_err("refused");
        assert!(problem.message.ends_with("name it by --motion to allow it"), "{}", problem.message);
        access.pick(&outside);
        assert!(access.read(Place::Hair, &FileRef::new(&outside)).is_ok());
    }

    #[cfg(unix)]
    #[test]
    fn a_link_does_not_lead_out() {
        let dir = tempfile::tempdir().expect("a folder");
        let folder = dir.path().join("project");
        std::fs::create_dir(&folder).expect("a folder");
        std::fs::write(dir.path().join("secret"), b"x").expect("a file");
        std::os::unix::fs::symlink(dir.path().join("secret"), folder.join("link.hair")).expect("a link");
        let access = Access::for_project(&folder.join("p.lovelock"));
        assert!(!access.allows(&folder.join("link.hair")));
    }

    #[test]
    fn an_unsaved_project_reaches_nothing_that_was_not_picked() {
        let dir = tempfile::tempdir().expect("a folder");
        let file = dir.path().join("x.hair");
        std::fs::write(&file, b"x").expect("a file");
        let mut access = Access::new();
        assert!(!access.allows(&file));
        access.pick(&file);
        assert!(access.allows(&file));
        std::fs::remove_file(&file).expect("removed");
        let problem = access.read(Place::Hair, &FileRef::new(&file)).expect_err("missing");
        assert_eq!(problem.kind, ProblemKind::NotLoaded);
    }

    #[test]
    fn disk_and_memory_agree() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = FileRef::new(folder.path().join("sub/x.bvh"));
        let disk = file.for_disk(folder.path());
        assert_eq!(disk, FileRef { path: "sub/x.bvh".into(), outside: false });
        assert_eq!(disk.in_memory(folder.path()), file);
        let far = FileRef::new(folder.path().parent().expect("a parent").join("y.bvh"));
        let disk = far.for_disk(folder.path());
        assert!(disk.outside && disk.path.is_absolute());
        assert_eq!(disk.in_memory(folder.path()).path, far.path);
    }
}
