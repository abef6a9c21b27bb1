//! Files that one recording at a time may write.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::Path;

/// Opens the file of an unfinished recording, making it where it is missing, and keeps others away as long as it is open. What
/// an earlier recording has left in it stays.
///
/// # Errors
/// [`io::ErrorKind::ResourceBusy`] where another recording has it.
pub(crate) fn claim(path: &Path) -> io::Result<File> {
    let file = OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path)?;
    let busy = || io::Error::new(io::ErrorKind::ResourceBusy, "another recording is writing to it");
    match file.try_lock() {
        // Its writer may have given it another name meanwhile: then it is finished.
        Ok(()) if is_still(&file, path) => Ok(file),
        Ok(()) | Err(TryLockError::WouldBlock) => Err(busy()),
        // Some network disks know no locks; then nothing keeps two writers apart.
        Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => Ok(file),
        Err(TryLockError::Error(error)) => Err(error),
    }
}

/// Whether the open file is the one of that name.
#[cfg(unix)]
pub(crate) fn is_still(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    match (file.metadata(), fs::metadata(path)) {
        (Ok(open), Ok(named)) => (open.dev(), open.ino()) == (named.dev(), named.ino()),
        _ => false,
    }
}

/// Elsewhere a file that is open keeps its name.
#[cfg(not(unix))]
pub(crate) fn is_still(_: &File, _: &Path) -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_at_a_time_and_what_is_there_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.partial");
        fs::write(&path, b"left").unwrap();
        let first = claim(&path).unwrap();
        assert_eq!(claim(&path).unwrap_err().kind(), io::ErrorKind::ResourceBusy);
        drop(first);
        let again = claim(&path).unwrap();
        assert_eq!(again.metadata().unwrap().len(), 4);
        assert!(is_still(&again, &path));
        fs::rename(&path, folder.path().join("a")).unwrap();
        assert_eq!(is_still(&again, &path), !cfg!(unix));
    }
}
