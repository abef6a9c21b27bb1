//! The location of the real files, and files that tests write.

pub mod fbx;

use std::path::PathBuf;

/// The folder of real test files. If it is missing, prints a line and returns `None`.
pub fn data_dir() -> Option<PathBuf> {
    let beside = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data");
    let folder = std::env::var_os("LOVELOCK_DATA").map_or_else(|| PathBuf::from(beside), PathBuf::from);
    if folder.is_dir() {
        Some(folder)
    } else {
        println!("skipped: no data folder");
        None
    }
}
