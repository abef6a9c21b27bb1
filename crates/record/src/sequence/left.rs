//! What an interrupted sequence leaves: complete images and its journal.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use super::journal::{JOURNAL_NAME, Journal, whole_frames};
use crate::RecordError;
use crate::manifest::{MANIFEST_NAME, Manifest};
use crate::partial::{PartialFile, open_file};

/// Writes the manifest of a folder.
pub(super) fn write_manifest(folder: &Path, manifest: &Manifest) -> Result<(), RecordError> {
    let path = folder.join(MANIFEST_NAME);
    let write = || {
        let mut file = PartialFile::create(&path, &open_file)?;
        serde_json::to_writer_pretty(&mut file, manifest)?;
        file.write_all(b"\n")?;
        file.commit(true)
    };
    write().map_err(|error| RecordError::io(&path, "write the manifest", error))
}

/// Whether an interrupted recording left its journal in the folder.
pub(crate) fn is_left(folder: &Path) -> bool {
    folder.join(JOURNAL_NAME).exists()
}

/// Lists the complete images of an interrupted recording in a manifest. Returns their number.
///
/// # Errors
/// If another program writes to the folder, or it cannot be written.
pub(crate) fn keep_unfinished(folder: &Path) -> Result<u64, RecordError> {
    if !is_left(folder) {
        return Ok(0);
    }
    let mut journal = Journal::claim(folder)?;
    let Some(there) = journal.earlier(folder) else {
        journal.remove();
        return Ok(0);
    };
    let frames: Vec<_> = whole_frames(folder, there.frames).into_values().collect();
    let count = frames.len() as u64;
    if count > 0 {
        write_manifest(folder, &Manifest { frames, complete: false, ..there })?;
    }
    journal.remove();
    Ok(count)
}

/// Removes the images and the journal of an interrupted recording.
///
/// # Errors
/// If another program writes to the folder, or a file cannot be removed.
pub(crate) fn discard_unfinished(folder: &Path) -> io::Result<()> {
    if !is_left(folder) {
        return Ok(());
    }
    let mut journal = Journal::claim(folder).map_err(|error| io::Error::other(error.to_string()))?;
    let there = journal.earlier(folder);
    for frame in whole_frames(folder, there.map(|there| there.frames).unwrap_or_default()).into_values() {
        // Names come from a file: only those in the folder itself are removed.
        if Path::new(&frame.file).components().count() == 1 {
            fs::remove_file(folder.join(&frame.file))?;
        }
    }
    journal.remove();
    // An empty folder was made by the recording.
    let _ = fs::remove_dir(folder);
    Ok(())
}
