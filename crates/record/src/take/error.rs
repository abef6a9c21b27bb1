//! Errors of takes.

use std::io;
use std::path::{Path, PathBuf};

/// Why a take could not be written, opened or played.
#[derive(Debug, thiserror::Error)]
pub enum TakeError {
    /// The request is invalid, such as a frame that a take cannot store.
    #[error("{}: {what}", path.display())]
    Request {
        /// The take as the user named it.
        path: PathBuf,
        /// What was found and what is valid.
        what: String,
    },
    /// Another recording is writing this take.
    #[error("{}: another recording is writing this take", path.display())]
    Busy {
        /// The unfinished file that is locked.
        path: PathBuf,
    },
    /// A file could not be created, read, locked or renamed.
    #[error("{}: could not {action}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The action that failed.
        action: String,
        /// The operating system's reason.
        source: io::Error,
    },
    /// Frames could not be written, because the disk is full or missing. Frames written before are kept.
    #[error("{}: could not {action}: {source}; {}", path.display(), kept_frames(*kept))]
    Write {
        /// The unfinished file, which stays.
        path: PathBuf,
        /// The action that failed, such as `write frames 120 to 179`.
        action: String,
        /// Number of frames in the file that can be played, from frame 0.
        kept: u64,
        /// The operating system's reason.
        source: io::Error,
    },
    /// An earlier error has already ended the recording.
    #[error("{}: the take has stopped after an earlier error; {}", path.display(), kept_frames(*kept))]
    Stopped {
        /// The unfinished file, which stays.
        path: PathBuf,
        /// Number of frames in the file, from frame 0.
        kept: u64,
    },
    /// The file is not a take.
    #[error("{}: {why}", path.display())]
    NotATake {
        /// The file.
        path: PathBuf,
        /// Why it is none.
        why: String,
    },
    /// The take was written by a newer version of this program.
    #[error(
        "{}: is a take of version {found}; this program reads takes up to version {newest}",
        path.display()
    )]
    Newer {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
        /// The newest version that can be read.
        newest: u32,
    },
    /// The take has a header but no frames: the recording ended before its first second was written.
    #[error("{}: contains no frames ({why})", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
        /// Why it contains none.
        why: String,
    },
    /// A part of the file is invalid.
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
    /// The frame was recorded, but the part of the file with it is damaged.
    #[error("{}: frame {frame} is lost: frames {first} to {last} are damaged: {why}", path.display())]
    Lost {
        /// The file.
        path: PathBuf,
        /// The requested frame.
        frame: u64,
        /// First frame that is lost with it.
        first: u64,
        /// Last frame that is lost with it.
        last: u64,
        /// The damage that was found.
        why: String,
    },
    /// The frame was not recorded.
    #[error("{}: has no frame {frame}; it has frames 0 to {}", path.display(), frames.saturating_sub(1))]
    NoSuchFrame {
        /// The file.
        path: PathBuf,
        /// The requested frame.
        frame: u64,
        /// Number of frames in the take.
        frames: u64,
    },
}

impl lovelock_base::Failure for TakeError {
    fn is_request(&self) -> bool {
        Self::is_request(self)
    }

    fn file(&self) -> Option<&Path> {
        Some(self.path())
    }
}

impl TakeError {
    /// Whether the request or an input file is at fault (exit status 2) rather than the work (exit status 1).
    pub fn is_request(&self) -> bool {
        !matches!(self, Self::Io { .. } | Self::Write { .. } | Self::Stopped { .. })
    }

    /// The file that the error is about.
    pub fn path(&self) -> &Path {
        match self {
            Self::Request { path, .. }
            | Self::Busy { path }
            | Self::Io { path, .. }
            | Self::Write { path, .. }
            | Self::Stopped { path, .. }
            | Self::NotATake { path, .. }
            | Self::Newer { path, .. }
            | Self::Empty { path, .. }
            | Self::Malformed { path, .. }
            | Self::Lost { path, .. }
            | Self::NoSuchFrame { path, .. } => path,
        }
    }

    pub(super) fn request(path: &Path, what: impl Into<String>) -> Self {
        Self::Request { path: path.to_owned(), what: what.into() }
    }

    pub(super) fn io(path: &Path, action: impl Into<String>, source: io::Error) -> Self {
        Self::Io { path: path.to_owned(), action: action.into(), source }
    }
}

fn kept_frames(kept: u64) -> String {
    match kept {
        0 => "no frames were kept".to_owned(),
        1 => "frame 0 was kept".to_owned(),
        _ => format!("frames 0 to {} were kept", kept - 1),
    }
}
