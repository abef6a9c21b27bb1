//! Files that the user named once on this machine, for what was made from them.
//!
//! A project or take may read the files of its own folder. Others must be picked by the user, so that a file from an unknown source cannot read
//! what its author guessed. What the user has picked is remembered here for the projects and takes that were made with it.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::files::{Access, FileRef, canonical, write_whole};
use crate::state_folder::state_folder;

/// The most projects and takes that are remembered.
const MOST: usize = 2000;

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
    pub fn remember<'a>(&self, made: &Path, files: impl IntoIterator<Item = &'a FileRef>, access: &Access) {
        let made = canonical(made);
        let picked =
            files.into_iter().map(|file| canonical(&file.path)).filter(|file| access.is_picked(file));
        let mut from: Vec<PathBuf> = picked.collect();
        from.sort();
        from.dedup();
        let mut grants = self.read();
        let earlier = grants.iter().position(|grant| grant.made == made);
        // A project or take that replaces another one has files of its own.
        let earlier = earlier.map(|at| grants.remove(at));
        if earlier.as_ref().map_or(&[][..], |grant| &grant.from) == from {
            return;
        }
        if !from.is_empty() {
            grants.push(Grant { made, from });
        }
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
        // What replaces it has grants of its own.
        grants.remember(&take, &[FileRef::new(&body)], &access);
        assert!(allowed(&take, &body) && !allowed(&take, &hair));
        grants.remember(&take, &[], &access);
        assert!(!allowed(&take, &body));
        // A list that is damaged allows nothing, and is replaced.
        std::fs::write(folder.path().join("state/grants.json"), b"[{]").expect("a file");
        assert!(!allowed(&take, &hair));
        grants.remember(&take, &files, &access);
        assert!(allowed(&take, &hair));
    }
}
