//! What can be wrong with a hair file.

use thiserror::Error;

/// Why a hair file was refused. Every message is one line that names the file.
#[derive(Debug, Error)]
pub enum HairFileError {
    /// The file could not be opened or read.
    #[error("{name}: cannot be read: {source}")]
    Io {
        /// The file.
        name: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file contradicts itself, its format or its own size.
    #[error("{name}: byte {offset}: found {found}, wanted {wanted}")]
    Malformed {
        /// The file.
        name: String,
        /// Where in the file, in bytes from its start.
        offset: u64,
        /// What is there.
        found: String,
        /// What would be right.
        wanted: String,
    },
    /// The file is sound, but no strand in it can be drawn.
    #[error("{name}: no strand left to draw ({reason}), wanted a strand of two points or more")]
    NothingToDraw {
        /// The file.
        name: String,
        /// What became of the strands.
        reason: String,
    },
}
