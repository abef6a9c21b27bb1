//! Errors of hair files.

use thiserror::Error;

/// Why a hair file was refused. Each message is one line that names the file.
#[derive(Debug, Error)]
pub enum HairFileError {
    /// The file could not be opened or read.
    #[error("{name}: cannot be read: {source}")]
    Io {
        /// The file.
        name: String,
        /// The error of the system.
        source: std::io::Error,
    },
    /// The file contradicts itself, its format or its own size.
    #[error("{name}: byte {offset}: found {found}, wanted {wanted}")]
    Malformed {
        /// The file.
        name: String,
        /// The position in the file, in bytes from its start.
        offset: u64,
        /// What was found there.
        found: String,
        /// What would be valid.
        wanted: String,
    },
    /// The file is valid, but none of its strands can be drawn.
    #[error("{name}: no strand left to draw ({reason}), wanted a strand of two points or more")]
    NothingToDraw {
        /// The file.
        name: String,
        /// Why no strands are left.
        reason: String,
    },
}
