//! A method to begin with: opacity maps in a folder.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// The files of the template.
const FILES: [(&str, &str); 2] = [
    ("method.toml", include_str!("template/method.toml")),
    ("method.wgsl", include_str!("template/method.wgsl")),
];

/// Writes the files of a method to begin with into a folder, which is made. Returns their paths.
///
/// # Errors
/// A file of that name is there already, or the folder cannot be written.
pub fn new_method(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let paths: Vec<PathBuf> = FILES.iter().map(|(name, _)| folder.join(name)).collect();
    if let Some(taken) = paths.iter().find(|path| path.exists()) {
        return Err(format!("{}: is there already; choose a new folder", taken.display()));
    }
    fs::create_dir_all(folder).map_err(|error| format!("{}: cannot be made: {error}", folder.display()))?;
    for (path, (_, text)) in paths.iter().zip(FILES) {
        // Fails where a file of that name has come in between.
        let written = fs::File::create_new(path).and_then(|mut file| file.write_all(text.as_bytes()));
        written.map_err(|error| format!("{}: cannot be written: {error}", path.display()))?;
    }
    Ok(paths)
}
