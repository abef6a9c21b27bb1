//! The unfinished file of a take: its name, its lock, its disk.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::TakeError;
use crate::claim::is_still;

/// What a take is written to. A file, except in tests of full disks.
pub(super) trait Disk: Write + Send {
    /// Waits until what was written is on the disk.
    fn sync(&mut self) -> io::Result<()>;
}

impl Disk for File {
    fn sync(&mut self) -> io::Result<()> {
        self.sync_data()
    }
}

/// Makes the disk from the locked file.
pub(super) type Mount = dyn Fn(File) -> Box<dyn Disk> + Send + Sync;

/// The disk of every real take: the file itself.
pub(super) fn mount_file(file: File) -> Box<dyn Disk> {
    Box::new(file)
}

/// `NAME.part` beside `NAME`.
pub(super) fn part_path(target: &Path) -> PathBuf {
    let mut name = target.file_name().unwrap_or_default().to_owned();
    name.push(".part");
    target.with_file_name(name)
}

/// Most takes of one name that were cut short and kept.
const MOST_KEPT: u32 = 10_000;

/// Creates the unfinished file, empty and locked. One that an earlier recording left behind is kept under another name:
/// `NAME-cut1.take.part` for `NAME.take.part`.
pub(super) fn claim(target: &Path) -> Result<File, TakeError> {
    let part = part_path(target);
    if let Some(folder) = target.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        fs::create_dir_all(folder).map_err(|error| TakeError::io(target, "create its folder", error))?;
    }
    match OpenOptions::new().read(true).append(true).open(&part) {
        Ok(old) => {
            lock(&old, &part)?;
            if !is_still(&old, &part) {
                // Its writer has given it its name meanwhile, and perhaps another has begun.
                return Err(TakeError::Busy { path: part });
            }
            set_aside(&old, target, &part)?;
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => {}
        Err(error) => return Err(TakeError::io(&part, "open", error)),
    }
    let file = match OpenOptions::new().append(true).create_new(true).open(&part) {
        Ok(file) => file,
        // Another writer was quicker between the two.
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
            return Err(TakeError::Busy { path: part });
        }
        Err(error) => return Err(TakeError::io(&part, "create", error)),
    };
    lock(&file, &part)?;
    Ok(file)
}

fn lock(file: &File, part: &Path) -> Result<(), TakeError> {
    match file.try_lock() {
        Ok(()) => Ok(()),
        Err(TryLockError::WouldBlock) => Err(TakeError::Busy { path: part.to_owned() }),
        // Some network disks know no locks; then nothing keeps two writers apart but the name.
        Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => Ok(()),
        Err(TryLockError::Error(error)) => Err(TakeError::io(part, "lock", error)),
    }
}

/// Gives the file of an earlier recording a name of its own; an empty one goes.
fn set_aside(old: &File, target: &Path, part: &Path) -> Result<(), TakeError> {
    let length = old.metadata().map_err(|error| TakeError::io(part, "read", error))?.len();
    if length == 0 {
        return fs::remove_file(part).map_err(|error| TakeError::io(part, "remove", error));
    }
    let stem = target.file_stem().unwrap_or_default();
    for number in 1..=MOST_KEPT {
        let mut name = stem.to_owned();
        name.push(format!("-cut{number}"));
        if let Some(extension) = target.extension() {
            name.push(".");
            name.push(extension);
        }
        name.push(".part");
        let kept = part.with_file_name(name);
        if !kept.exists() {
            return fs::rename(part, &kept)
                .map_err(|error| TakeError::io(part, format!("keep it as {}", kept.display()), error));
        }
    }
    Err(TakeError::request(part, format!("{MOST_KEPT} unfinished takes of this name are kept already")))
}

/// Gives the finished file its name, over a take that was there.
pub(super) fn publish(part: &Path, target: &Path) -> io::Result<()> {
    fs::rename(part, target)?;
    sync_folder(target);
    Ok(())
}

/// Names live in the folder. Not every system lets a folder be opened; the bytes are safe anyway.
pub(super) fn sync_folder(path: &Path) {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
}
