//! The tables of a film that is being written, in a file beside it: with them, the images of an interrupted recording are a film.
//!
//! | bytes | contents |
//! |---|---|
//! | 8 | `LLFILMT1` |
//! | 4 | CRC-32 of what follows, little endian |
//! | 8 | offset of `mdat` in the film, little endian |
//! | 8 | end of the images that the tables describe, little endian |
//! | … | `moov` |

use std::fs;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use lovelock_base::clock::Stopwatch;

use crate::claim::claim;
use crate::mp4::Tables;
use crate::partial::{free_name, partial_path};
use crate::{FilmInfo, RecordError, read_film};

const MAGIC: &[u8; 8] = b"LLFILMT1";
/// The longest file that is read, bytes: the tables of some days.
const LONGEST: u64 = 1 << 30;
/// Tables are written at most that often, seconds. They grow with the film.
const EVERY_SECS: f64 = 1.0;

/// `NAME.mp4.partial.tables` beside `NAME.mp4`.
fn tables_path(film: &Path) -> PathBuf {
    with_suffix(film, ".partial.tables")
}

/// The name under which tables are written until they are whole.
fn new_tables_path(film: &Path) -> PathBuf {
    with_suffix(film, ".partial.tables-new")
}

fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(suffix);
    path.with_file_name(name)
}

/// What an interrupted recording left, set aside while the same film is recorded again: a recording that is cancelled or fails must
/// not cost what could be kept. Dropped, it is put back.
pub(super) struct Before {
    /// The files of the interrupted recording.
    left: [PathBuf; 2],
}

impl Before {
    /// Sets aside what was left of the film at `film`, if anything was. What another program is writing stays where it is.
    pub(super) fn set_aside(film: &Path) -> Self {
        let left = [partial_path(film), tables_path(film)];
        // A claim would create a file that is missing.
        if left[0].exists() && claim(&left[0]).is_ok() {
            for path in &left {
                let _ = fs::rename(path, before_path(path));
            }
        }
        Self { left }
    }

    /// Removes it: the film is complete.
    pub(super) fn done(self) {
        for path in &self.left {
            let _ = fs::remove_file(before_path(path));
        }
    }
}

impl Drop for Before {
    fn drop(&mut self) {
        put_back(&self.left);
    }
}

fn before_path(path: &Path) -> PathBuf {
    with_suffix(path, "-before")
}

/// Gives what was set aside its names back, unless a newer recording has left something under them.
fn put_back(left: &[PathBuf; 2]) {
    if before_path(&left[0]).exists() && !left[0].exists() {
        for path in left {
            let _ = fs::rename(before_path(path), path);
        }
    }
}

/// The tables of a film that is being written. Their file is removed when it is dropped.
pub(super) struct TablesFile {
    path: PathBuf,
    new: PathBuf,
    since: Option<Stopwatch>,
}

impl TablesFile {
    /// Those of the film at `film`. What an earlier recording left is removed.
    pub(super) fn new(film: &Path) -> Self {
        let path = tables_path(film);
        let _ = fs::remove_file(&path);
        Self { path, new: new_tables_path(film), since: None }
    }

    /// Whether they were not written for a while.
    pub(super) fn is_due(&self) -> bool {
        self.since.is_none_or(|since| since.secs() > EVERY_SECS)
    }

    /// Writes them under another name, then renames them, so that they are whole at every moment.
    pub(super) fn write(&mut self, tables: &Tables) -> io::Result<()> {
        self.since = Some(Stopwatch::start());
        let mut body = tables.mdat_start.to_le_bytes().to_vec();
        body.extend(tables.end.to_le_bytes());
        body.extend(&tables.moov);
        let mut bytes = MAGIC.to_vec();
        bytes.extend(crc32fast::hash(&body).to_le_bytes());
        bytes.extend(body);
        let written = fs::write(&self.new, &bytes).and_then(|()| fs::rename(&self.new, &self.path));
        if written.is_err() {
            let _ = fs::remove_file(&self.new);
        }
        written
    }
}

impl Drop for TablesFile {
    fn drop(&mut self) {
        // The film is complete or removed.
        let _ = fs::remove_file(&self.path);
    }
}

fn read(film: &Path) -> Option<Tables> {
    let path = tables_path(film);
    let mut bytes = Vec::new();
    fs::File::open(path).ok()?.take(LONGEST).read_to_end(&mut bytes).ok()?;
    let (checksum, body) = bytes.strip_prefix(MAGIC)?.split_first_chunk::<4>()?;
    if crc32fast::hash(body) != u32::from_le_bytes(*checksum) {
        return None;
    }
    let (mdat_start, rest) = body.split_first_chunk::<8>()?;
    let (end, moov) = rest.split_first_chunk::<8>()?;
    let (mdat_start, end) = (u64::from_le_bytes(*mdat_start), u64::from_le_bytes(*end));
    (mdat_start.checked_add(16)? <= end).then(|| Tables { mdat_start, end, moov: moov.to_vec() })
}

/// Makes a film of what an interrupted recording to `film` left. It gets that name, or `NAME-1.mp4` and so on if there is such a film.
/// Returns its path and what is in it; `None` if there is not a second of images.
///
/// # Errors
/// If another program writes it, or it cannot be written.
pub fn keep_unfinished_film(film: &Path) -> Result<Option<(PathBuf, FilmInfo)>, RecordError> {
    let partial = partial_path(film);
    put_back(&[partial.clone(), tables_path(film)]);
    let failed = |error| RecordError::io(film, "keep the unfinished film", error);
    let Some(tables) = read(film).filter(|_| partial.exists()) else { return Ok(None) };
    let mut file = claim(&partial).map_err(failed)?;
    if file.metadata().map_err(failed)?.len() < tables.end {
        return Ok(None);
    }
    let mut finish = || {
        file.set_len(tables.end)?;
        file.seek(SeekFrom::Start(tables.mdat_start + 8))?;
        file.write_all(&(tables.end - tables.mdat_start).to_be_bytes())?;
        file.seek(SeekFrom::End(0))?;
        file.write_all(&tables.moov)?;
        file.sync_all()
    };
    finish().map_err(failed)?;
    let info = read_film(&partial)?;
    let kept = free_name(film);
    fs::rename(&partial, &kept).map_err(failed)?;
    remove_tables(film);
    Ok(Some((kept, info)))
}

/// Whether an interrupted recording to `film` left something.
pub(crate) fn is_left(film: &Path) -> bool {
    let partial = partial_path(film);
    partial.exists() || before_path(&partial).exists()
}

/// Removes what an interrupted recording to `film` left.
///
/// # Errors
/// If another program writes it, or it cannot be removed.
pub(crate) fn discard(film: &Path) -> io::Result<()> {
    let partial = partial_path(film);
    if partial.exists() {
        let _lock = claim(&partial)?;
        fs::remove_file(&partial)?;
    }
    for path in [before_path(&partial), before_path(&tables_path(film))] {
        let _ = fs::remove_file(path);
    }
    remove_tables(film);
    Ok(())
}

/// Removes the tables beside a film that got its name before its program was killed.
pub(crate) fn tidy(film: &Path) {
    // Without images the tables are of no use, and belong to no recording that runs.
    if !is_left(film) {
        remove_tables(film);
    }
}

fn remove_tables(film: &Path) {
    for path in [tables_path(film), new_tables_path(film)] {
        let _ = fs::remove_file(path);
    }
}
