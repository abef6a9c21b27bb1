//! Errors of stages.

/// Why a stage was refused.
#[derive(Debug, thiserror::Error)]
pub enum UsdError {
    /// The file could not be read.
    #[error("{name}: cannot be read: {source}")]
    Io {
        /// The file.
        name: String,
        /// The error of the system.
        source: std::io::Error,
    },
    /// The file contradicts itself or its format.
    #[error("{name}: byte {offset}: found {found}; must be {wanted}")]
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
}
