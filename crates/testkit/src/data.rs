//! What the machine offers to tests.

use std::path::{Path, PathBuf};

/// The folder of real files: `LOVELOCK_DATA`, or `shared/data` beside the repository. Where there is none, says
/// so and returns `None`; the test then has nothing to do.
pub fn data_dir() -> Option<PathBuf> {
    let dir = std::env::var_os("LOVELOCK_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"), PathBuf::from);
    if dir.is_dir() {
        return Some(dir);
    }
    eprintln!("skipped: no data folder");
    None
}

/// Call where no graphics adapter was found: a failure on a machine that tests for others (`CI=true`), a line
/// that says so elsewhere.
///
/// # Panics
/// Where the environment has `CI=true`.
pub fn skip_without_adapter(error: &dyn std::fmt::Display) {
    assert!(std::env::var("CI").as_deref() != Ok("true"), "no graphics adapter: {error}");
    eprintln!("skipped: no graphics adapter: {error}");
}
