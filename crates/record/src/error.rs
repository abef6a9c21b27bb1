//! What can go wrong while pictures are written or read back.

use std::io;
use std::path::PathBuf;

/// Why a recording could not start, go on, finish, or be read back.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The request itself cannot be met, whatever the disk does: an odd size, an unknown extension.
    #[error("{what}")]
    Request {
        /// The whole sentence: what was asked, and what would be right.
        what: String,
    },
    /// A file or folder could not be created, written or renamed. The unfinished file is gone by then.
    #[error("{}: could not {action}: {source}", path.display())]
    Io {
        /// The output as the user named it (not the `.partial` beside it).
        path: PathBuf,
        /// What was being done, such as `write frame 12`.
        action: String,
        /// The system's reason, such as a full disk.
        source: io::Error,
    },
    /// The H.264 encoder refused a frame.
    #[error("{}: the H.264 encoder failed at frame {frame}: {reason}", path.display())]
    Encoder {
        /// The film as the user named it.
        path: PathBuf,
        /// The frame, counted from 0.
        frame: u64,
        /// The encoder's own words.
        reason: String,
    },
    /// A picture of another size than the settings say was handed over.
    #[error(
        "a frame of {found} bytes was handed over, {wanted} were wanted ({width}x{height} pixels of RGBA)"
    )]
    FrameSize {
        /// Bytes handed over.
        found: usize,
        /// Bytes wanted: width × height × 4.
        wanted: usize,
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
    /// The recording had already ended by an earlier error.
    #[error("{}: the recording has stopped after an earlier error", path.display())]
    Stopped {
        /// The output as the user named it.
        path: PathBuf,
    },
    /// A file that is read back is not what it should be.
    #[error("{}: at byte {offset}: found {found}, wanted {wanted}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// Where, in bytes from the start of the file.
        offset: u64,
        /// What is there.
        found: String,
        /// What should be there.
        wanted: String,
    },
}

impl RecordError {
    /// Whether the request or an input file is at fault (exit status 2) rather than the work (exit status 1).
    pub fn is_request(&self) -> bool {
        matches!(self, Self::Request { .. } | Self::Malformed { .. })
    }

    /// The file or folder that the error is about, where there is one.
    pub fn path(&self) -> Option<&std::path::Path> {
        match self {
            Self::Io { path, .. }
            | Self::Encoder { path, .. }
            | Self::Stopped { path }
            | Self::Malformed { path, .. } => Some(path),
            Self::Request { .. } | Self::FrameSize { .. } => None,
        }
    }

    pub(crate) fn request(what: impl Into<String>) -> Self {
        Self::Request { what: what.into() }
    }

    pub(crate) fn io(path: impl Into<PathBuf>, action: impl Into<String>, source: io::Error) -> Self {
        Self::Io { path: path.into(), action: action.into(), source }
    }
}
