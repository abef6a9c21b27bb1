//! The journal of an unfinished sequence: its settings and its complete frames.
//!
//! It stays in the folder while frames are written, and also after a crash. Each line is JSON: first a manifest with the frames that a
//! manifest listed before and that are kept, then one line per frame, just before the frame gets its final name.

use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File};
use std::io::{self, Read, Seek, Write};
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::RecordError;
use crate::claim::claim;
use crate::manifest::{Manifest, ManifestFrame, read_manifest};
use crate::partial::partial_path;

/// Name of the journal in the folder.
pub(super) const JOURNAL_NAME: &str = "manifest.partial";

/// Largest journal that is read, in bytes: a few million frames.
const MAX_BYTES: u64 = 1 << 29;

/// The journal. It is open and locked, so that no other recording writes to the folder.
pub(super) struct Journal {
    path: PathBuf,
    file: File,
    /// Whether the file was empty.
    is_new: bool,
}

/// What an earlier recording left.
pub(super) struct Recorded {
    /// All its frames.
    pub manifest: Manifest,
    /// How many of the first ones a manifest listed before that recording, or lists.
    pub listed: usize,
}

impl Recorded {
    /// The frames that a manifest listed before that recording, or lists.
    pub fn listed(&self) -> &[ManifestFrame] {
        &self.manifest.frames[..self.listed]
    }
}

impl Journal {
    /// Locks the folder for this recording.
    ///
    /// # Errors
    /// If another recording has locked the folder, or if it cannot be written.
    pub fn claim(folder: &Path) -> Result<Self, RecordError> {
        let path = folder.join(JOURNAL_NAME);
        let file =
            claim(&path).map_err(|error| RecordError::io(folder, "start a sequence in the folder", error))?;
        let is_new = file.metadata().is_ok_and(|data| data.len() == 0);
        Ok(Self { path, file, is_new })
    }

    /// What an earlier recording left in the folder: its journal or, if it ended regularly, its manifest.
    pub fn earlier(&mut self, folder: &Path) -> Option<Recorded> {
        self.recorded().or_else(|| {
            let manifest = read_manifest(folder).ok()?;
            Some(Recorded { listed: manifest.frames.len(), manifest })
        })
    }

    /// What the journal itself says.
    pub fn recorded(&mut self) -> Option<Recorded> {
        let mut text = Vec::new();
        let read = self.file.rewind().and_then(|()| (&self.file).take(MAX_BYTES).read_to_end(&mut text));
        read.ok().and_then(|_| parse(&text))
    }

    /// Starts a new journal. `head` has the frames that a manifest listed and that are kept, `kept` the others.
    ///
    /// # Errors
    /// Errors such as a full disk. The earlier journal then stays as it was.
    pub fn begin(&mut self, head: &Manifest, kept: &BTreeMap<u64, ManifestFrame>) -> io::Result<()> {
        let mut text = serde_json::to_vec(head)?;
        text.push(b'\n');
        for frame in kept.values() {
            text.extend(serde_json::to_vec(frame)?);
            text.push(b'\n');
        }
        // Under another name first: until the new one is whole, nothing else lists the images of the earlier recording.
        let new = partial_path(&self.path);
        let mut file = claim(&new)?;
        let written = file
            .set_len(0)
            .and_then(|()| file.write_all(&text))
            .and_then(|()| file.sync_all())
            .and_then(|()| fs::rename(&new, &self.path));
        if let Err(error) = written {
            let _ = fs::remove_file(&new);
            return Err(error);
        }
        self.file = file;
        Ok(())
    }

    /// Adds a frame that is about to get its final name.
    ///
    /// # Errors
    /// As [`Journal::begin`].
    pub fn add(&mut self, frame: &ManifestFrame) -> io::Result<()> {
        let mut line = serde_json::to_vec(frame)?;
        line.push(b'\n');
        self.file.write_all(&line)
    }

    /// Removes the journal if it did not exist before, so that the folder is as it was.
    pub fn release(self) {
        if self.is_new {
            self.remove();
        }
    }

    /// Removes the journal, because the manifest now lists all frames.
    pub fn remove(self) {
        // Removed before it is closed and unlocked, so that no other recording can have started to use it.
        let _ = fs::remove_file(&self.path);
    }
}

/// What a journal says. Lines that are not whole, as a full disk leaves them, are ignored.
fn parse(text: &[u8]) -> Option<Recorded> {
    let mut lines = text.split_inclusive(|&byte| byte == b'\n').filter(|line| line.ends_with(b"\n"));
    let mut manifest: Manifest = serde_json::from_slice(lines.next()?).ok()?;
    let listed = manifest.frames.len();
    manifest.frames.extend(lines.filter_map(|line| serde_json::from_slice::<ManifestFrame>(line).ok()));
    Some(Recorded { manifest, listed })
}

/// The frames of a manifest whose files match their length and checksum.
pub(super) fn whole_frames(folder: &Path, frames: Vec<ManifestFrame>) -> BTreeMap<u64, ManifestFrame> {
    let is_whole = |frame: &ManifestFrame| {
        let path = folder.join(&frame.file);
        let is_long = fs::metadata(&path).is_ok_and(|data| data.is_file() && data.len() == frame.bytes);
        is_long
            && fs::read(&path).is_ok_and(|bytes| format!("{:08x}", crc32fast::hash(&bytes)) == frame.crc32)
    };
    frames.into_iter().filter(is_whole).map(|frame| (frame.number, frame)).collect()
}

/// How the settings of an existing sequence differ from those of the one that should continue it; empty if they are the same.
pub(super) fn differences(there: &Manifest, wanted: &Manifest) -> Vec<String> {
    let size = |of: &Manifest| format!("{}x{}", of.width, of.height);
    let mut found = Vec::new();
    found.extend(difference("size", &size(there), &size(wanted)));
    found.extend(difference("rate", &there.fps.to_string(), &wanted.fps.to_string()));
    let keys_of = |of: &Value| of.as_object().map(|map| map.keys().cloned().collect::<Vec<_>>());
    let keys: BTreeSet<String> =
        [&there.settings, &wanted.settings].into_iter().filter_map(keys_of).flatten().collect();
    for key in keys {
        let (there, wanted) = (&there.settings[&key], &wanted.settings[&key]);
        if let (Some(parts), Some(others)) = (keys_of(there), keys_of(wanted)) {
            // Fingerprints are meaningless to the user; only the names of those that differ are shown.
            let parts: BTreeSet<String> = parts.into_iter().chain(others).collect();
            let changed = parts.into_iter().filter(|part| there[part] != wanted[part]);
            found.extend(changed.map(|part| format!("{part} changed")));
        } else {
            found.extend(difference(&key, &text_of(there), &text_of(wanted)));
        }
    }
    found
}

fn difference(what: &str, there: &str, wanted: &str) -> Option<String> {
    (there != wanted).then(|| format!("{what} was {there} and is {wanted} now"))
}

fn text_of(value: &Value) -> String {
    match value {
        Value::Null => "none".to_owned(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}
