//! Errors of writing images and reading them back.

use std::io;
use std::path::PathBuf;

/// Why a recording could not be started, continued, finished or read back.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The request is invalid, such as an odd size or an unknown extension.
    #[error("{what}")]
    Request {
        /// The whole sentence: what was found and what is valid.
        what: String,
    },
    /// A file or folder could not be created, written or renamed. What can be kept of an unfinished one is left.
    #[error("{}: could not {action}: {source}", path.display())]
    Io {
        /// The output as the user named it (not the `.partial` beside it).
        path: PathBuf,
        /// The action that failed, such as `write frame 12`.
        action: String,
        /// The operating system's reason, such as a full disk.
        source: io::Error,
    },
    /// The H.264 encoder refused a frame.
    #[error("{}: the H.264 encoder failed at frame {frame}: {reason}", path.display())]
    Encoder {
        /// The film as the user named it.
        path: PathBuf,
        /// The frame, counted from 0.
        frame: u64,
        /// The encoder's message.
        reason: String,
    },
    /// The size of an image differs from the size in the settings.
    #[error("a frame has {found} bytes; must be {wanted} ({width}x{height} pixels of RGBA)")]
    FrameSize {
        /// Bytes of the image.
        found: usize,
        /// Bytes expected: width × height × 4.
        wanted: usize,
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
    /// An earlier error has already ended the recording.
    #[error("{}: the recording has stopped after an earlier error", path.display())]
    Stopped {
        /// The output as the user named it.
        path: PathBuf,
    },
    /// A file that is read back is invalid.
    #[error("{}: at byte {offset}: found {found}; must be {wanted}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// Position in bytes from the start of the file.
        offset: u64,
        /// What the file contains there.
        found: String,
        /// What was expected.
        wanted: String,
    },
}

impl RecordError {
    /// Whether the request or an input file is at fault (exit status 2) rather than the work (exit status 1).
    pub fn is_request(&self) -> bool {
        matches!(self, Self::Request { .. } | Self::Malformed { .. })
    }

    /// The file or folder that the error is about, if there is one.
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
