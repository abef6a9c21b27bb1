//! What interrupted recordings leave, and what can be made of it.

use std::cmp::Reverse;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::claim::claim;
use crate::film::tables;
use crate::partial::{free_name, partial_path};
use crate::sequence;
use crate::take::{cut_takes, part_path};
use crate::{OutputKind, RecordError, TAKE_EXTENSION, TakeError, TakeReader};

/// What was recorded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UnfinishedKind {
    /// A film: it can be kept up to its last second, and recorded again.
    Film,
    /// A sequence of images: it can be kept, and continued.
    Sequence,
    /// A take: it can be kept. It cannot be continued: what the user did while it was recorded is gone.
    Take,
}

impl UnfinishedKind {
    /// The kind of the recording to `out`; `None` if such a recording leaves nothing.
    pub fn of(out: &Path) -> Option<Self> {
        if out.extension().is_some_and(|found| found.eq_ignore_ascii_case(TAKE_EXTENSION)) {
            return Some(Self::Take);
        }
        match OutputKind::of(out) {
            Ok(OutputKind::Film) => Some(Self::Film),
            Ok(OutputKind::Sequence) => Some(Self::Sequence),
            Ok(OutputKind::Preview) | Err(_) => None,
        }
    }

    /// The name in sentences.
    pub fn label(self) -> &'static str {
        match self {
            Self::Film => "film",
            Self::Sequence => "sequence",
            Self::Take => "take",
        }
    }
}

/// What was kept of an interrupted recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Kept {
    /// The file or the folder.
    pub path: PathBuf,
    /// Number of frames.
    pub frames: u64,
}

/// Whether an interrupted recording to `out` left something.
pub fn is_unfinished(out: &Path) -> bool {
    match UnfinishedKind::of(out) {
        Some(UnfinishedKind::Film) => tables::is_left(out),
        Some(UnfinishedKind::Sequence) => sequence::is_left(out),
        Some(UnfinishedKind::Take) => is_left(&part_path(out)),
        None => false,
    }
}

/// Whether a recording to `out` that began at `since`, and has ended, left something of its own: it failed, as on a full disk.
pub fn has_left(out: &Path, since: SystemTime) -> bool {
    let written = match UnfinishedKind::of(out) {
        Some(UnfinishedKind::Film) => partial_path(out),
        Some(UnfinishedKind::Sequence) => sequence::journal_path(out),
        // One that was left before has another name by now.
        Some(UnfinishedKind::Take) | None => return is_unfinished(out),
    };
    let modified = || fs::metadata(&written).and_then(|data| data.modified());
    is_left(&written) && modified().is_ok_and(|modified| modified >= since)
}

/// Whether a film is set aside that was left of `out` before it was recorded again. If that was interrupted too, the one that is aside can be
/// kept or discarded after the newer one, under the same name.
pub fn has_older(out: &Path) -> bool {
    UnfinishedKind::of(out) == Some(UnfinishedKind::Film) && tables::has_older(out)
}

/// The recordings that interrupted recordings to `out` left, the newest first, each to be kept or discarded by its name: `out` itself, and
/// takes whose unfinished files were renamed when `out` was recorded again.
pub fn unfinished_outs(out: &Path) -> Vec<PathBuf> {
    let is_take = UnfinishedKind::of(out) == Some(UnfinishedKind::Take);
    let mut cuts = if is_take { cut_takes(out) } else { Vec::new() };
    cuts.sort();
    cuts.sort_by_cached_key(|cut| {
        Reverse(fs::metadata(part_path(cut)).and_then(|data| data.modified()).ok())
    });
    std::iter::once(out.to_owned()).chain(cuts).filter(|out| is_unfinished(out)).collect()
}

/// Whether enough seems to be there for [`keep_unfinished`]. Changes nothing.
///
/// # Errors
/// If what is there cannot be read.
pub fn can_be_kept(out: &Path) -> Result<bool, RecordError> {
    match UnfinishedKind::of(out) {
        Some(UnfinishedKind::Film) => {
            tables::plays(out).map_err(|error| RecordError::io(out, "read the unfinished film", error))
        }
        Some(UnfinishedKind::Sequence) => Ok(true),
        Some(UnfinishedKind::Take) => Ok(frames_of_take(&part_path(out))? > 0),
        None => Ok(false),
    }
}

/// Number of frames of an unfinished take; 0 where none can be read, as where its recording had ended before its first second was written.
fn frames_of_take(part: &Path) -> Result<u64, RecordError> {
    match TakeReader::open(part) {
        Ok(take) => Ok(take.frames()),
        Err(TakeError::NotATake { .. } | TakeError::Malformed { .. } | TakeError::Empty { .. }) => Ok(0),
        Err(TakeError::Io { source, .. }) if source.kind() == io::ErrorKind::NotFound => Ok(0),
        Err(TakeError::Io { path, action, source }) => Err(RecordError::Io { path, action, source }),
        Err(error) => Err(RecordError::request(error.to_string())),
    }
}

/// Makes a film, sequence or take of what an interrupted recording to `out` left. A file of that name stays: then the kept one gets a number.
/// Returns `None` if too little is there.
///
/// # Errors
/// If another program writes it, or it cannot be read or written.
pub fn keep_unfinished(out: &Path) -> Result<Option<Kept>, RecordError> {
    match UnfinishedKind::of(out) {
        Some(UnfinishedKind::Film) => {
            let kept = tables::keep_unfinished_film(out)?;
            Ok(kept.map(|(path, info)| Kept { path, frames: info.frames }))
        }
        Some(UnfinishedKind::Sequence) => {
            let frames = sequence::keep_unfinished(out)?;
            Ok((frames > 0).then(|| Kept { path: out.to_owned(), frames }))
        }
        Some(UnfinishedKind::Take) => {
            let part = part_path(out);
            let failed = |error| RecordError::io(out, "keep the unfinished take", error);
            if !part.exists() {
                return Ok(None);
            }
            // Read before it is locked: some systems let nobody else read a locked file. A take that is cut plays like any other.
            let frames = frames_of_take(&part);
            let _lock = claim(&part).map_err(failed)?;
            let frames = frames?;
            if frames == 0 {
                return Ok(None);
            }
            let path = free_name(out);
            fs::rename(&part, &path).map_err(failed)?;
            Ok(Some(Kept { path, frames }))
        }
        None => Ok(None),
    }
}

/// Removes what an interrupted recording to `out` left. Images that a manifest lists, or listed before it, stay, and so does an
/// older film.
///
/// # Errors
/// If another program writes it, or it cannot be removed.
pub fn discard_unfinished(out: &Path) -> io::Result<()> {
    match UnfinishedKind::of(out) {
        Some(UnfinishedKind::Film) => tables::discard(out),
        Some(UnfinishedKind::Sequence) => sequence::discard_unfinished(out),
        Some(UnfinishedKind::Take) => discard_take(&part_path(out)),
        None => Ok(()),
    }
}

/// Removes what a recording to `out` that got its name could not remove any more, because its program was killed at that moment. What
/// [`is_unfinished`] finds stays.
pub fn tidy_finished(out: &Path) {
    if UnfinishedKind::of(out) == Some(UnfinishedKind::Film) {
        tables::tidy(out);
    }
}

/// Whether a recording left the unfinished file. One that is being recorded is not left.
fn is_left(file: &Path) -> bool {
    // A claim would create a file that is missing.
    file.exists() && !claim(file).is_err_and(|error| error.kind() == io::ErrorKind::ResourceBusy)
}

fn discard_take(part: &Path) -> io::Result<()> {
    if !part.exists() {
        return Ok(());
    }
    // A sentence that names the file, as other errors here do.
    let named = |error: io::Error| io::Error::new(error.kind(), format!("{}: {error}", part.display()));
    let _lock = claim(part).map_err(named)?;
    fs::remove_file(part)
}

#[cfg(test)]
mod tests;
