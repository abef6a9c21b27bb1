//! What can go wrong with a take.

use std::io;
use std::path::{Path, PathBuf};

/// Why a take could not be written, opened or played.
#[derive(Debug, thiserror::Error)]
pub enum TakeError {
    /// What was handed over cannot be kept in a take, whatever the disk does.
    #[error("{}: {what}", path.display())]
    Request {
        /// The take as the user named it.
        path: PathBuf,
        /// What was handed over, and what would be right.
        what: String,
    },
    /// Another writer is working on this take.
    #[error("{}: is being recorded already; wanted a take that no one is writing", path.display())]
    Busy {
        /// The unfinished file that is locked.
        path: PathBuf,
    },
    /// A file could not be created, read, locked or renamed.
    #[error("{}: could not {action}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What was being done.
        action: String,
        /// The system's reason.
        source: io::Error,
    },
    /// The disk refused frames: it is full, or gone. What was written before is kept.
    #[error("{}: could not {action}: {source}; {}", path.display(), kept_words(*kept))]
    Write {
        /// The unfinished file, which stays.
        path: PathBuf,
        /// What was being done, such as `write frames 120 to 179`.
        action: String,
        /// Frames that are in the file and can be played, from frame 0.
        kept: u64,
        /// The system's reason.
        source: io::Error,
    },
    /// The recording had already ended by an earlier error.
    #[error("{}: the take has stopped after an earlier error; {}", path.display(), kept_words(*kept))]
    Stopped {
        /// The unfinished file, which stays.
        path: PathBuf,
        /// Frames that are in the file, from frame 0.
        kept: u64,
    },
    /// The file is something else.
    #[error("{}: is no take: found {found}, wanted {wanted}", path.display())]
    NotATake {
        /// The file.
        path: PathBuf,
        /// What it starts with.
        found: String,
        /// What a take starts with.
        wanted: String,
    },
    /// The take was written by a later version of this program.
    #[error(
        "{}: is a take of version {found}, and this program reads takes up to version {newest}",
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
    /// The take has a start and nothing after it: the recording ended before its first second was written.
    #[error("{}: holds no frame ({why}); wanted one frame or more", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
        /// Why it holds none.
        why: String,
    },
    /// A place in the file is not what it should be.
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
    /// The frame was recorded, but its part of the file is damaged.
    #[error("{}: frame {frame} is lost: frames {first} to {last} are damaged: {why}", path.display())]
    Lost {
        /// The file.
        path: PathBuf,
        /// The frame asked for.
        frame: u64,
        /// First frame that is lost with it.
        first: u64,
        /// Last frame that is lost with it.
        last: u64,
        /// What was found.
        why: String,
    },
    /// No such frame was recorded.
    #[error("{}: has no frame {frame}; it has frames 0 to {}", path.display(), frames.saturating_sub(1))]
    NoSuchFrame {
        /// The file.
        path: PathBuf,
        /// The frame asked for.
        frame: u64,
        /// Frames in the take.
        frames: u64,
    },
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

fn kept_words(kept: u64) -> String {
    match kept {
        0 => "no frame is kept".to_owned(),
        1 => "frame 0 is kept in it".to_owned(),
        _ => format!("frames 0 to {} are kept in it", kept - 1),
    }
}
