//! The folder for what the program keeps between two runs and no user chose a place for: unsaved changes, reports of failures, what was allowed.

use std::path::PathBuf;

/// The environment variable that names another folder.
pub const STATE_VARIABLE: &str = "LOVELOCK_STATE";

/// The folder: `$LOVELOCK_STATE`, otherwise `lovelock` in the user's folder of states (`~/.local/state` on Linux). `None` for a user without a
/// home. It need not be there yet.
pub fn state_folder() -> Option<PathBuf> {
    if let Some(folder) = std::env::var_os(STATE_VARIABLE).filter(|folder| !folder.is_empty()) {
        return Some(PathBuf::from(folder));
    }
    Some(dirs::state_dir().or_else(dirs::data_local_dir)?.join("lovelock"))
}
