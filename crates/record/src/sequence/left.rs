//! What an interrupted sequence leaves: complete images and its journal.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::journal::{JOURNAL_NAME, Journal, Recorded, whole_frames};
use super::sound_file::SOUND_NAME;
use super::{SequenceFormat, frame_name};
use crate::RecordError;
use crate::manifest::{MANIFEST_NAME, Manifest, ManifestFrame, read_manifest};
use crate::partial::{PartialFile, open_file, partial_path};

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

/// The journal of a recording to the folder.
pub(crate) fn journal_path(folder: &Path) -> PathBuf {
    folder.join(JOURNAL_NAME)
}

/// Whether an interrupted recording left its journal in the folder.
pub(crate) fn is_left(folder: &Path) -> bool {
    journal_path(folder).exists()
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
    let mut count = 0;
    // A recording that has not begun its journal has changed nothing: the manifest of the one before it stays.
    if let Some(Recorded { manifest: there, .. }) = journal.recorded() {
        let frames: Vec<_> = whole_frames(folder, there.frames).into_values().collect();
        count = frames.len() as u64;
        if count > 0 && !finished(folder, &frames) {
            write_manifest(folder, &Manifest { frames, complete: false, ..there })?;
        }
    }
    remove_partial_files(folder);
    journal.remove();
    remove_if_empty(folder);
    Ok(count)
}

/// Removes the images and the journal of an interrupted recording. Images that a manifest lists, or listed before
/// the recording, stay.
///
/// # Errors
/// If another program writes to the folder, or a file cannot be removed.
pub(crate) fn discard_unfinished(folder: &Path) -> io::Result<()> {
    if !is_left(folder) {
        return Ok(());
    }
    let mut journal = Journal::claim(folder).map_err(|error| io::Error::other(error.to_string()))?;
    if let Some(Recorded { manifest: mut there, listed }) = journal.recorded() {
        let mut frames = whole_frames(folder, there.frames.split_off(listed));
        let before: Vec<_> = whole_frames(folder, there.frames).into_values().collect();
        if let Ok(manifest) = read_manifest(folder) {
            // The recording was killed when it had written the manifest, or before it had changed anything.
            for listed in manifest.frames {
                frames.remove(&listed.number);
            }
        } else if !before.is_empty() {
            let manifest = Manifest { frames: before, complete: false, ..there };
            write_manifest(folder, &manifest).map_err(io::Error::other)?;
        }
        for frame in frames.into_values() {
            // Names come from a file: only those in the folder itself are removed.
            if Path::new(&frame.file).components().count() == 1 {
                fs::remove_file(folder.join(&frame.file))?;
            }
        }
    }
    remove_partial_files(folder);
    journal.remove();
    remove_if_empty(folder);
    Ok(())
}

/// Whether the manifest already lists these images as a whole sequence: the recording was killed before it could remove its journal.
fn finished(folder: &Path, frames: &[ManifestFrame]) -> bool {
    read_manifest(folder).is_ok_and(|manifest| manifest.complete && manifest.frames == frames)
}

/// Removes the files of a recording that had no final name yet. The caller has locked the folder, so nobody writes them.
fn remove_partial_files(folder: &Path) {
    let is_ours = |name: &str| {
        let number = name.strip_prefix("frame_").and_then(|rest| rest.split('.').next()?.parse::<u64>().ok());
        let is_frame = |number| SequenceFormat::ALL.iter().any(|&format| frame_name(number, format) == name);
        [MANIFEST_NAME, SOUND_NAME, JOURNAL_NAME].contains(&name) || number.is_some_and(is_frame)
    };
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        // That of the manifest has another name than the journal, which is `manifest.partial`.
        let target = path.with_extension("");
        let is_partial = partial_path(&target) == path;
        if is_partial && target.file_name().and_then(|name| name.to_str()).is_some_and(is_ours) {
            let _ = fs::remove_file(path);
        }
    }
}

/// An empty folder was made by the recording.
fn remove_if_empty(folder: &Path) {
    let _ = fs::remove_dir(folder);
}
