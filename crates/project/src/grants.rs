//! Files that the user named once on this machine, for what was made from them.
//!
//! A project or take may read the files of its own folder. Others must be picked by the user, so that a file from an unknown source cannot read
//! what its author guessed. What the user has picked is remembered here for the projects and takes that were made with it.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::files::{Access, FileRef, canonical, write_whole};
use crate::state_folder::state_folder;

/// The most projects and takes that are remembered.
const MOST: usize = 2000;

/// The most files of one project or take that are remembered.
const MOST_FILES: usize = 200;

/// The longest list that is read, bytes.
const LONGEST: u64 = 16 << 20;

/// The files that projects and takes may read outside their folders, because the user picked them.
#[derive(Clone, Debug, Default)]
pub struct Grants {
    file: Option<PathBuf>,
}

/// What one project or take may read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Grant {
    made: PathBuf,
    /// The files, those that were used last at the end.
    from: Vec<PathBuf>,
}

impl Grants {
    /// Those of the user: the file `grants.json` in [`state_folder`].
    pub fn of_user() -> Self {
        Self { file: state_folder().map(|folder| folder.join("grants.json")) }
    }

    /// Those in a file, which need not be there yet.
    pub fn new(file: impl Into<PathBuf>) -> Self {
        Self { file: Some(file.into()) }
    }

    fn read(&self) -> Vec<Grant> {
        let Some(file) = &self.file else { return Vec::new() };
        let is_short = std::fs::metadata(file).is_ok_and(|data| data.is_file() && data.len() <= LONGEST);
        let text = is_short.then(|| std::fs::read(file).ok()).flatten();
        text.and_then(|text| serde_json::from_slice(&text).ok()).unwrap_or_default()
    }

    /// Lets the project or take at `made` read what the user picked for it before.
    pub fn allow(&self, made: &Path, access: &mut Access) {
        let made = canonical(made);
        for grant in self.read().iter().filter(|grant| grant.made == made) {
            grant.from.iter().for_each(|file| access.pick(file));
        }
    }

    /// Remembers which of `files` the user has picked, for the project or take at `made` that reads them. Nothing is lost but a
    /// question later if it cannot be written.
    ///
    /// What was remembered for it before stays: edits that are never saved do not take files from the project on the disk.
    pub fn remember<'a>(&self, made: &Path, files: impl IntoIterator<Item = &'a FileRef>, access: &Access) {
        let made = canonical(made);
        let picked =
            files.into_iter().map(|file| canonical(&file.path)).filter(|file| access.is_picked(file));
        let picked: BTreeSet<PathBuf> = picked.collect();
        let mut grants = self.read();
        let earlier = grants.iter().position(|grant| grant.made == made);
        let earlier = earlier.map(|at| grants.remove(at).from).unwrap_or_default();
        let mut from: Vec<PathBuf> =
            earlier.iter().filter(|file| !picked.contains(*file)).cloned().chain(picked.clone()).collect();
        let surplus = from.len().saturating_sub(MOST_FILES);
        from.drain(..surplus);
        if from == earlier {
            return;
        }
        grants.push(Grant { made, from });
        let surplus = grants.len().saturating_sub(MOST);
        grants.drain(..surplus);
        if let (Some(file), Ok(text)) = (&self.file, serde_json::to_vec_pretty(&grants)) {
            let _ = file.parent().map(std::fs::create_dir_all);
            let _ = write_whole(file, &text);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Place;

    #[test]
    fn what_was_picked_once_is_allowed_for_what_was_made_from_it_and_nothing_else() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            std::fs::write(&path, b"x").expect("a file");
            path
        };
        let (hair, body, secret) = (path("library/a.hair"), path("library/b.glb"), path("library/secret"));
        let (take, other) = (path("takes ü/dance.take"), path("mail/dance.take"));
        let grants = Grants::new(folder.path().join("state/grants.json"));
        let mut access = Access::of_command();
        access.pick(&hair);
        access.pick(&body);
        let files = [&hair, &secret].map(FileRef::new);
        grants.remember(&take, &files, &access);

        let allowed = |made: &Path, file: &Path| {
            let mut access = Access::of_command();
            grants.allow(made, &mut access);
            access.read(Place::Hair, &FileRef::new(file)).is_ok()
        };
        assert!(allowed(&take, &hair));
        assert!(!allowed(&take, &body), "picked, and not a part of it");
        assert!(!allowed(&take, &secret), "a part of it that nobody picked");
        assert!(!allowed(&other, &hair), "another take that names the same file");
        // Edits that may never be saved take nothing away.
        grants.remember(&take, &[FileRef::new(&body)], &access);
        assert!(allowed(&take, &body) && allowed(&take, &hair) && !allowed(&take, &secret));
        grants.remember(&take, &[], &access);
        assert!(allowed(&take, &body) && allowed(&take, &hair));
        assert!(!allowed(&other, &body), "a name that nothing was remembered for");
        // A list that is damaged allows nothing, and is replaced.
        std::fs::write(folder.path().join("state/grants.json"), b"[{]").expect("a file");
        assert!(!allowed(&take, &hair));
        grants.remember(&take, &files, &access);
        assert!(allowed(&take, &hair));
    }

    #[test]
    fn of_too_many_files_the_oldest_are_forgotten() {
        let folder = tempfile::tempdir().expect("a folder");
        let grants = Grants::new(folder.path().join("grants.json"));
        let project = folder.path().join("a.lovelock");
        let mut access = Access::new();
        let files: Vec<FileRef> = (0..=MOST_FILES)
            .map(|k| FileRef::new(folder.path().join(format!("library/{k:04}.hair"))))
            .collect();
        for file in &files {
            access.pick(&file.path);
        }
        let (last, others) = files.split_last().expect("files");
        grants.remember(&project, others, &access);
        // Used again, so that it is no longer the oldest.
        grants.remember(&project, &files[..1], &access);
        grants.remember(&project, [last], &access);
        let mut granted = Access::new();
        grants.allow(&project, &mut granted);
        assert!(granted.is_picked(&files[0].path) && granted.is_picked(&last.path));
        assert!(!granted.is_picked(&files[1].path) && granted.is_picked(&files[2].path));
    }
}
