//! The contents of the folder that a dialog shows, read on a thread: a folder on a network may take long.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};

use crate::window::purpose::Purpose;

/// The most entries of a folder that are listed.
const MAX: usize = 5000;

/// A row of the list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Entry {
    pub(super) path: PathBuf,
    pub(super) name: String,
    pub(super) is_folder: bool,
}

impl Entry {
    pub(super) fn new(path: PathBuf, is_folder: bool) -> Self {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Self { path, name, is_folder }
    }
}

/// A folder, with its entries when they are read.
#[derive(Debug, Default)]
pub(super) struct Folder {
    path: PathBuf,
    reading: Option<Receiver<Vec<Entry>>>,
    entries: Vec<Entry>,
}

impl Folder {
    /// Shows the folder at `path`: reads it if it is another one than before.
    pub(super) fn show(&mut self, path: &Path, purpose: Purpose, ctx: &egui::Context) {
        if self.path != path {
            let (sender, reading) = sync_channel(1);
            let (at, wake) = (path.to_owned(), ctx.clone());
            let spawned = std::thread::Builder::new().name("list folder".to_owned()).spawn(move || {
                let _ = sender.send(list(&at, purpose));
                wake.request_repaint();
            });
            *self = Self {
                path: path.to_owned(),
                reading: spawned.is_ok().then_some(reading),
                entries: Vec::new(),
            };
        }
        match self.reading.as_ref().map(Receiver::try_recv) {
            Some(Ok(entries)) => (self.entries, self.reading) = (entries, None),
            Some(Err(TryRecvError::Disconnected)) => self.reading = None,
            Some(Err(TryRecvError::Empty)) | None => {}
        }
    }

    /// Whether the folder is still being read.
    pub(super) fn is_reading(&self) -> bool {
        self.reading.is_some()
    }

    /// The folders, then the files, whose names begin with `prefix`, whatever the case. Hidden ones only if it says so.
    pub(super) fn beginning(&self, prefix: &str) -> Vec<Entry> {
        let prefix = prefix.to_lowercase();
        let begins = |entry: &&Entry| {
            entry.name.to_lowercase().starts_with(&prefix)
                && (!entry.name.starts_with('.') || prefix.starts_with('.'))
        };
        self.entries.iter().filter(begins).cloned().collect()
    }
}

/// The folders in a folder and the files that `purpose` is about, by name.
fn list(folder: &Path, purpose: Purpose) -> Vec<Entry> {
    let Ok(entries) = std::fs::read_dir(folder) else { return Vec::new() };
    let entry = |path: PathBuf| {
        let is_folder = path.is_dir();
        (is_folder || purpose.lists(&path)).then(|| Entry::new(path, is_folder))
    };
    let mut found: Vec<Entry> = entries.filter_map(|found| entry(found.ok()?.path())).take(MAX).collect();
    found.sort_by_cached_key(|entry| (!entry.is_folder, entry.name.to_lowercase()));
    found
}

/// What all names begin with, whatever the case, in the spelling of the first.
pub(super) fn common_start(entries: &[Entry]) -> String {
    let Some((first, others)) = entries.split_first() else { return String::new() };
    let mut common: Vec<char> = first.name.chars().collect();
    for other in others {
        let same = |(a, b): &(&char, char)| a.to_lowercase().eq(b.to_lowercase());
        let length = common.iter().zip(other.name.chars()).take_while(same).count();
        common.truncate(length);
    }
    common.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_completed_as_far_as_they_agree() {
        let of = |names: &[&str]| {
            common_start(&names.iter().map(|name| Entry::new(PathBuf::from(name), false)).collect::<Vec<_>>())
        };
        assert_eq!(of(&["Dance-1.take", "dance-2.take"]), "Dance-");
        assert_eq!(of(&["ö a", "ö b"]), "ö ");
        assert_eq!(of(&["one"]), "one");
        assert_eq!(of(&[]), "");
    }

    #[test]
    fn a_folder_lists_folders_first_and_files_of_the_purpose() {
        let dir = tempfile::tempdir().expect("a folder");
        for name in ["b.lovelock", "A.lovelock", "c.txt", ".hidden.lovelock"] {
            std::fs::write(dir.path().join(name), b"x").expect("a file");
        }
        std::fs::create_dir(dir.path().join("z")).expect("a folder");
        let entries = list(dir.path(), Purpose::SaveProject);
        let mut folder = Folder { entries, ..Folder::default() };
        let names = |folder: &Folder, prefix: &str| -> Vec<String> {
            folder.beginning(prefix).into_iter().map(|entry| entry.name).collect()
        };
        assert_eq!(names(&folder, ""), ["z", "A.lovelock", "b.lovelock"]);
        assert_eq!(names(&folder, "a"), ["A.lovelock"]);
        assert_eq!(names(&folder, ".h"), [".hidden.lovelock"]);
        folder.entries = list(dir.path(), Purpose::Sequence);
        assert_eq!(names(&folder, ""), ["z"]);
        assert!(list(&dir.path().join("missing"), Purpose::Open).is_empty());
    }
}
