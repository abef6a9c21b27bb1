//! Locks on files, so that only one program at a time writes to them.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::Path;

/// Opens a file, creates it if it is missing, and locks it for as long as it is open. What is in it stays.
///
/// # Errors
/// [`io::ErrorKind::ResourceBusy`] if another program holds the lock, or another part of this one.
pub fn claim(path: &Path) -> io::Result<File> {
    lock(OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path)?, path)
}

/// As [`claim`], but `None` if the file is missing.
///
/// # Errors
/// As [`claim`].
pub(crate) fn claim_existing(path: &Path) -> io::Result<Option<File>> {
    match OpenOptions::new().read(true).write(true).open(path) {
        Ok(file) => lock(file, path).map(Some),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(error),
    }
}

fn lock(file: File, path: &Path) -> io::Result<File> {
    let busy = || io::Error::new(io::ErrorKind::ResourceBusy, "another recording is writing to it");
    match file.try_lock() {
        // The other recording may have finished and renamed the file between `open` and `try_lock`.
        Ok(()) if is_still(&file, path) => Ok(file),
        Ok(()) | Err(TryLockError::WouldBlock) => Err(busy()),
        // Some network file systems support no locks; two writers are then not kept apart.
        Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => Ok(file),
        Err(TryLockError::Error(error)) => Err(error),
    }
}

/// Whether `path` still names the open file.
#[cfg(unix)]
pub fn is_still(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    match (file.metadata(), fs::metadata(path)) {
        (Ok(open), Ok(named)) => (open.dev(), open.ino()) == (named.dev(), named.ino()),
        _ => false,
    }
}

/// On other systems a file that is open cannot be renamed.
#[cfg(not(unix))]
pub fn is_still(_: &File, _: &Path) -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_second_claim_fails_and_the_contents_stay() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.partial");
        fs::write(&path, b"left").unwrap();
        let first = claim(&path).unwrap();
        assert_eq!(claim(&path).unwrap_err().kind(), io::ErrorKind::ResourceBusy);
        drop(first);
        let again = claim(&path).unwrap();
        assert_eq!(again.metadata().unwrap().len(), 4);
        assert!(is_still(&again, &path));
        assert_eq!(claim_existing(&path).unwrap_err().kind(), io::ErrorKind::ResourceBusy);
        let missing = folder.path().join("missing");
        assert!(claim_existing(&missing).unwrap().is_none() && !missing.exists());
        fs::rename(&path, folder.path().join("a")).unwrap();
        assert_eq!(is_still(&again, &path), !cfg!(unix));
    }
}
