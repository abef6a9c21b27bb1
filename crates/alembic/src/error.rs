//! Errors of archives.

use thiserror::Error;

/// Why an archive was refused. The caller names the file.
#[derive(Debug, Error)]
pub enum AlembicError {
    /// The file cannot be read.
    #[error("cannot be read: {0}")]
    Io(#[from] std::io::Error),
    /// The file contradicts itself or the format.
    #[error("byte {offset}: found {found}; must be {wanted}")]
    Malformed {
        /// The position in the file, in bytes from its start.
        offset: u64,
        /// What was found there.
        found: String,
        /// What would be valid.
        wanted: &'static str,
    },
}

impl AlembicError {
    pub(crate) fn malformed(offset: u64, found: impl Into<String>, wanted: &'static str) -> Self {
        Self::Malformed { offset, found: found.into(), wanted }
    }
}
