//! The note that a second program on a project leaves for the first: a small file beside the first one's journal.

use std::fs;
use std::path::{Path, PathBuf};

use super::owner::Owner;
use crate::files::write_whole;

/// The extension of notes, in place of that of the journal.
const EXTENSION: &str = "opened";
/// The longest note that is read, bytes.
const LONGEST: u64 = 4096;

/// The note for the program that writes a journal.
fn note_at(journal: &Path) -> PathBuf {
    journal.with_extension(EXTENSION)
}

/// Tells the program that writes `journal` that `owner` has opened the project, too.
pub(super) fn leave(journal: &Path, owner: &Owner) {
    if let Ok(text) = serde_json::to_vec(owner) {
        // In a folder that cannot be written, the first program is not told.
        let _ = write_whole(&note_at(journal), &text);
    }
}

/// Removes the note for the program that writes `journal`, and returns who has left it, if there is one.
pub(super) fn take(journal: &Path) -> Option<Owner> {
    let note = note_at(journal);
    // Others may write to the folder: reading a pipe would not end.
    let is_note = fs::metadata(&note).is_ok_and(|data| data.is_file() && data.len() <= LONGEST);
    let text = is_note.then(|| fs::read(&note).ok()).flatten()?;
    forget(journal);
    serde_json::from_slice(&text).ok()
}

/// Removes a note whose reader is gone.
pub(super) fn forget(journal: &Path) {
    let _ = fs::remove_file(note_at(journal));
}
