//! Folders that a recording creates, which are removed if it writes nothing.

use std::path::{Path, PathBuf};

/// Folders that did not exist. Dropping it removes those that exist by then and are empty.
pub struct NewFolders(Vec<PathBuf>);

impl NewFolders {
    /// Those of the path and its parent folders that do not exist, innermost first.
    pub fn missing_on(path: &Path) -> Self {
        let named = path.ancestors().filter(|path| !path.as_os_str().is_empty());
        Self(named.take_while(|path| path.symlink_metadata().is_err()).map(Path::to_owned).collect())
    }
}

impl Drop for NewFolders {
    fn drop(&mut self) {
        for folder in &self.0 {
            // Fails for a folder that is not empty and for a film, which must stay.
            let _ = std::fs::remove_dir(folder);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn only_new_and_empty_folders_are_removed() {
        let dir = tempfile::tempdir().expect("a folder");
        let at = |name: &str| dir.path().join(name);
        fs::create_dir(at("old")).expect("a folder");

        // Nothing written: new folders are removed, existing ones stay even if they are empty.
        for out in ["old/new/frames", "old"] {
            let folders = NewFolders::missing_on(&at(out));
            fs::create_dir_all(at(out)).expect("folders");
            drop(folders);
            assert!(at("old").is_dir() && !at("old/new").exists(), "{out}");
        }

        // Something written: everything stays.
        let (frames, film) =
            (NewFolders::missing_on(&at("new/frames")), NewFolders::missing_on(&at("films/a.mp4")));
        for file in ["new/frames/frame_000000.png", "films/a.mp4"] {
            fs::create_dir_all(at(file).parent().expect("a folder")).expect("folders");
            fs::write(at(file), b"x").expect("a file");
        }
        drop((frames, film));
        assert!(at("new/frames/frame_000000.png").is_file() && at("films/a.mp4").is_file());
    }
}
