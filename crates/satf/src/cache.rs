//! The database in a folder of the user's: read if it is there, made and kept if not.

use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::{fs, process};

use thiserror::Error;

use crate::database::Database;
use crate::file::{DatabaseError, VERSION};

/// What the user is told once about the kept database. It is usable in each case.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum Note {
    /// The file could not be used, so the database was made again.
    #[error("The hair database was rebuilt: {} could not be used ({reason}).", .path.display())]
    MadeAgain {
        /// The file.
        path: PathBuf,
        /// Why it could not be used.
        reason: String,
    },
    /// The database could not be kept, so it will be made again at the next start.
    #[error("The hair database could not be saved as {} ({reason}).", .path.display())]
    NotKept {
        /// The file.
        path: PathBuf,
        /// Why it could not be written.
        reason: String,
    },
}

/// The file of this program's version in `folder`.
pub fn path_in(folder: &Path) -> PathBuf {
    folder.join(format!("satf-{VERSION}.bin"))
}

/// The database: read from its file in `folder`, or made and written there. A file that cannot be used is replaced.
/// `progress` receives rising fractions while it is made, see [`Database::build`].
///
/// Problems with the file or the folder are told in the note and change nothing else.
pub fn load_or_build(folder: &Path, progress: &(dyn Fn(f32) + Sync)) -> (Database, Option<Note>) {
    let path = path_in(folder);
    let reason = match fs::read(&path) {
        Ok(bytes) => match Database::from_bytes(&bytes) {
            Ok(database) => return (database, None),
            Err(error) => Some(DatabaseError::to_string(&error)),
        },
        Err(error) if error.kind() == ErrorKind::NotFound => None,
        Err(error) => Some(error.to_string()),
    };
    let database = Database::build(progress);
    let kept = keep(folder, &path, &database.to_bytes());
    let note = match (reason, kept) {
        (Some(reason), _) => Some(Note::MadeAgain { path, reason }),
        (None, Err(error)) => Some(Note::NotKept { path, reason: error.to_string() }),
        (None, Ok(())) => None,
    };
    (database, note)
}

static SHARED: OnceLock<(Database, Option<Note>)> = OnceLock::new();

/// The database of this process if it has been read or made, without waiting for it.
pub fn ready() -> Option<&'static (Database, Option<Note>)> {
    SHARED.get()
}

/// What the user is told of the database of this process, if it has been read or made.
pub fn note() -> Option<&'static Note> {
    SHARED.get().and_then(|(_, note)| note.as_ref())
}

/// The database of this process, read or made at its first use, and what the user is told of it.
pub fn shared() -> &'static (Database, Option<Note>) {
    SHARED.get_or_init(|| match dirs::cache_dir() {
        Some(folder) => load_or_build(&folder.join("lovelock"), &|_| ()),
        None => (Database::build(&|_| ()), None),
    })
}

/// Writes under a temporary name and renames, so that nobody reads half a file.
fn keep(folder: &Path, path: &Path, bytes: &[u8]) -> io::Result<()> {
    fs::create_dir_all(folder)?;
    // Two programs may start at once.
    let temporary = path.with_extension(format!("{}.tmp", process::id()));
    let written = fs::write(&temporary, bytes).and_then(|()| fs::rename(&temporary, path));
    if written.is_err() {
        // What is left of it is of no use; that it cannot be removed changes nothing.
        let _ = fs::remove_file(&temporary);
    }
    written
}
