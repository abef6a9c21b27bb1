//! Folders that a recording makes, gone again where it wrote nothing.

use std::path::{Path, PathBuf};

/// Folders that were not there; dropping it removes those that are there by then and empty.
pub(crate) struct NewFolders(Vec<PathBuf>);

impl NewFolders {
    /// The path and the folders above it that do not exist, the innermost first.
    pub(crate) fn missing_on(path: &Path) -> Self {
        let named = path.ancestors().filter(|path| !path.as_os_str().is_empty());
        Self(named.take_while(|path| path.symlink_metadata().is_err()).map(Path::to_owned).collect())
    }
}

impl Drop for NewFolders {
    fn drop(&mut self) {
        for folder in &self.0 {
            // Fails where the folder holds something, and on a film: these are to stay.
            let _ = std::fs::remove_dir(folder);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    #[test]
    fn only_new_and_empty_folders_go() {
        let dir = tempfile::tempdir().expect("a folder");
        let at = |name: &str| dir.path().join(name);
        fs::create_dir(at("old")).expect("a folder");

        // Nothing written: what was made goes, what was there stays, also where it is empty.
        for out in ["old/new/frames", "old"] {
            let folders = NewFolders::missing_on(&at(out));
            fs::create_dir_all(at(out)).expect("folders");
            drop(folders);
            assert!(at("old").is_dir() && !at("old/new").exists(), "{out}");
        }

        // Something written: all of it stays.
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
