//! Real data files and graphics adapters for tests.

use std::path::{Path, PathBuf};

/// The folder of real data files: `LOVELOCK_DATA`, or `shared/data` beside the repository. If there is none, prints that the
/// test is skipped and returns `None`.
pub fn data_dir() -> Option<PathBuf> {
    let dir = std::env::var_os("LOVELOCK_DATA")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"), PathBuf::from);
    if dir.is_dir() {
        return Some(dir);
    }
    eprintln!("skipped: no data folder");
    None
}

/// Call this if no graphics adapter was found. The test fails in continuous integration (`CI=true`) and prints that it is
/// skipped elsewhere.
///
/// # Panics
/// If the environment has `CI=true`.
pub fn skip_without_adapter(error: &dyn std::fmt::Display) {
    assert!(std::env::var("CI").as_deref() != Ok("true"), "no graphics adapter: {error}");
    eprintln!("skipped: no graphics adapter: {error}");
}
