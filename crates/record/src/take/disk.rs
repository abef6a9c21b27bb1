//! The unfinished file of a take: its name, its lock and the disk below it.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::TakeError;
use crate::claim::is_still;

/// What a take is written to: a file, except in tests of full disks.
pub(super) trait Disk: Write + Send {
    /// Waits until everything written is on the disk.
    fn sync(&mut self) -> io::Result<()>;
}

impl Disk for File {
    fn sync(&mut self) -> io::Result<()> {
        self.sync_data()
    }
}

/// Creates the disk from the locked file.
pub(super) type Mount = dyn Fn(File) -> Box<dyn Disk> + Send + Sync;

/// The disk of every real take: the file itself.
pub(super) fn mount_file(file: File) -> Box<dyn Disk> {
    Box::new(file)
}

/// `NAME.part` beside `NAME`.
pub(crate) fn part_path(target: &Path) -> PathBuf {
    let mut name = target.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    target.with_file_name(name)
}

/// The takes that unfinished files were kept for when their name was recorded again, in no order: `NAME-cut1.take` and so on for `NAME.take`,
/// whose unfinished file is now `NAME-cut1.take.part`.
pub(crate) fn cut_takes(target: &Path) -> Vec<PathBuf> {
    let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let stem = target.file_stem().unwrap_or_default().as_encoded_bytes();
    let is_cut = |take: &Path| {
        let number = take.file_stem().unwrap_or_default().as_encoded_bytes().strip_prefix(stem);
        let number = number.and_then(|rest| rest.strip_prefix(CUT.as_bytes()));
        let is_same_kind = take.extension() == target.extension();
        is_same_kind
            && number.is_some_and(|number| !number.is_empty() && number.iter().all(u8::is_ascii_digit))
    };
    let entries = fs::read_dir(folder).into_iter().flatten().filter_map(Result::ok);
    entries
        .map(|entry| entry.path())
        .filter(|part| part.extension().is_some_and(|found| found == "part"))
        .map(|part| part.with_extension(""))
        .filter(|take| is_cut(take))
        .collect()
}

/// What the name of an unfinished take gets, with a number, when another one of that name is recorded.
const CUT: &str = "-cut";

/// Most unfinished takes of one name that are kept.
const MAX_KEPT: u32 = 10_000;

/// Creates the unfinished file, empty and locked. One that an earlier recording left is renamed and kept:
/// `NAME.take.part` becomes `NAME-cut1.take.part`.
pub(super) fn claim(target: &Path) -> Result<File, TakeError> {
    let part = part_path(target);
    if let Some(folder) = target.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        fs::create_dir_all(folder).map_err(|error| TakeError::io(target, "create its folder", error))?;
    }
    match OpenOptions::new().read(true).append(true).open(&part) {
        Ok(old) => {
            lock(&old, &part)?;
            set_aside(&old, target, &part)?;
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(error) => return Err(TakeError::io(&part, "open", error)),
    }
    let file = match OpenOptions::new().append(true).create_new(true).open(&part) {
        Ok(file) => file,
        // Another writer created it since the check above.
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
            return Err(TakeError::Busy { path: part });
        }
        Err(error) => return Err(TakeError::io(&part, "create", error)),
    };
    lock(&file, &part)?;
    Ok(file)
}

/// Locks the unfinished file. Meanwhile its writer may have finished it, or another program may have removed one that was still empty: then it
/// no longer has the name, which may belong to another recording.
fn lock(file: &File, part: &Path) -> Result<(), TakeError> {
    match file.try_lock() {
        Ok(()) if is_still(file, part) => Ok(()),
        Ok(()) | Err(TryLockError::WouldBlock) => Err(TakeError::Busy { path: part.to_owned() }),
        // Some network file systems support no locks; only the name then keeps two writers apart.
        Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => Ok(()),
        Err(TryLockError::Error(error)) => Err(TakeError::io(part, "lock", error)),
    }
}

/// Renames the file of an earlier recording, or removes it if it is empty.
fn set_aside(old: &File, target: &Path, part: &Path) -> Result<(), TakeError> {
    let length = old.metadata().map_err(|error| TakeError::io(part, "read", error))?.len();
    if length == 0 {
        return fs::remove_file(part).map_err(|error| TakeError::io(part, "remove", error));
    }
    let stem = target.file_stem().unwrap_or_default();
    for number in 1..=MAX_KEPT {
        let mut name = stem.to_owned();
        name.push(CUT);
        name.push(number.to_string());
        if let Some(extension) = target.extension() {
            name.push(".");
            name.push(extension);
        }
        let kept = part_path(&part.with_file_name(name));
        if !kept.exists() {
            return fs::rename(part, &kept)
                .map_err(|error| TakeError::io(part, format!("keep it as {}", kept.display()), error));
        }
    }
    Err(TakeError::request(part, format!("there are already {MAX_KEPT} unfinished takes of this name")))
}

/// Renames the finished file to its final name and replaces an existing take.
pub(super) fn publish(part: &Path, target: &Path) -> io::Result<()> {
    fs::rename(part, target)?;
    sync_folder(target);
    Ok(())
}

/// Writes the folder to the disk, which contains the names. Not every system can open a folder; the data is safe without it.
pub(super) fn sync_folder(path: &Path) {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_was_removed_before_it_was_locked_is_not_recorded_to() {
        let folder = tempfile::tempdir().unwrap();
        let part = folder.path().join("dance.take.part");
        let create = || OpenOptions::new().append(true).create_new(true).open(&part).unwrap();
        let first = create();
        fs::remove_file(&part).unwrap();
        let second = create();
        assert!(matches!(lock(&first, &part), Err(TakeError::Busy { .. })));
        assert!(lock(&second, &part).is_ok(), "control");
    }
}
