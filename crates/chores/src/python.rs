//! Virtual environments of Python for programs of others.

use anyhow::Context as _;
use lovelock_xtask::tool;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Creates a virtual environment with the packages in `folder` if there is none. Returns the path of its Python.
pub(crate) fn environment(folder: &Path, packages: &[&str]) -> anyhow::Result<PathBuf> {
    environment_of("python3", folder, packages)
}

/// Written last, so that an incomplete environment is created again.
const MADE: &str = "made";

/// Whether there is an environment in `folder`.
pub(crate) fn is_made(folder: &Path) -> bool {
    folder.join(MADE).is_file()
}

/// As [`environment`], with a Python that may be of another version.
pub(crate) fn environment_of(python3: &str, folder: &Path, packages: &[&str]) -> anyhow::Result<PathBuf> {
    let python = folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    let made = folder.join(MADE);
    let wanted = packages.join(" ");
    if fs::read_to_string(&made).is_ok_and(|packages| packages == wanted) {
        return Ok(python);
    }
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| format!("could not remove {}", folder.display()))?;
    }
    println!("Creating a Python environment with {}.", packages.join(", "));
    tool::run(Command::new(python3).args(["-m", "venv"]).arg(folder))?;
    let pip = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    tool::run(Command::new(&python).args(pip).args(packages))?;
    fs::write(&made, wanted)?;
    Ok(python)
}
