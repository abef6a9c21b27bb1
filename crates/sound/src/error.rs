//! Why a sound cannot be used.

use std::io;
use std::path::PathBuf;

/// Why a file cannot be read as a sound. Each message is one sentence that names the file.
#[derive(Debug, thiserror::Error)]
pub enum SoundError {
    /// The file could not be opened or read.
    #[error("{}: could not be read: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The file is no sound, or one that cannot be used.
    #[error("{}: {found}; must be {wanted}", path.display())]
    Refused {
        /// The file.
        path: PathBuf,
        /// What was found in it.
        found: String,
        /// What would be valid.
        wanted: String,
    },
    /// Reading was cancelled.
    #[error("cancelled")]
    Cancelled,
}
