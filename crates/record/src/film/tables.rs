//! The tables of a film that is being written, in a file beside it: with them, the images of an interrupted recording are a film.
//!
//! | bytes | contents |
//! |---|---|
//! | 8 | `LLFILMT1` |
//! | 4 | CRC-32 of what follows, little endian |
//! | 8 | offset of `mdat` in the film, little endian |
//! | 8 | end of the images that the tables describe, little endian |
//! | … | `moov` |

use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use lovelock_base::clock::Stopwatch;

use crate::claim::claim_existing;
use crate::mp4::Tables;
use crate::partial::{free_name, numbered_name, partial_path};
use crate::reader::film_in;
use crate::{FilmInfo, RecordError};

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

/// What an interrupted recording left: a film that is not complete, and its tables if it was long enough.
struct Parts {
    partial: PathBuf,
    tables: PathBuf,
}

impl Parts {
    /// Those under the names that a recording to `film` writes.
    fn written(film: &Path) -> Self {
        Self { partial: partial_path(film), tables: tables_path(film) }
    }

    /// Those under the names that they have while `film` is recorded again.
    fn aside(film: &Path) -> Self {
        let Self { partial, tables } = Self::written(film);
        Self { partial: with_suffix(&partial, "-before"), tables: with_suffix(&tables, "-before") }
    }

    /// The tables if they can be read and `file`, the film, has all the images that they describe.
    fn playable(&self, file: &File) -> io::Result<Option<Tables>> {
        let length = file.metadata()?.len();
        Ok(read(&self.tables)?.filter(|tables| tables.end <= length))
    }

    /// The tables first: a crash must not leave them alone, for the next film of that name.
    fn remove(&self) -> io::Result<()> {
        unless_missing(fs::remove_file(&self.tables))?;
        unless_missing(fs::remove_file(&self.partial))
    }
}

/// A file that is missing is as good as moved or removed.
fn unless_missing(done: io::Result<()>) -> io::Result<()> {
    match done {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// Locks the newest film that interrupted recordings to `film` left; `None` if there is none. One that was set aside gets its names back if
/// there is no newer one, and a move that a crash has cut is completed.
fn claim_left(film: &Path) -> io::Result<Option<File>> {
    let (written, aside) = (Parts::written(film), Parts::aside(film));
    if let Some(file) = claim_existing(&written.partial)? {
        if !aside.partial.exists() {
            // The crash came between the renames of the two files, or after the older film was kept.
            if written.tables.exists() {
                unless_missing(fs::remove_file(&aside.tables))?;
            } else {
                unless_missing(fs::rename(&aside.tables, &written.tables))?;
            }
        }
        return Ok(Some(file));
    }
    let Some(file) = claim_existing(&aside.partial)? else { return Ok(None) };
    // Tables without a film are those of one that was cancelled.
    unless_missing(fs::remove_file(&written.tables))?;
    fs::rename(&aside.partial, &written.partial)?;
    unless_missing(fs::rename(&aside.tables, &written.tables))?;
    Ok(Some(file))
}

/// What an interrupted recording left, set aside while the same film is recorded again: a recording that is cancelled or fails must
/// not cost what could be kept. Dropped, it is put back, unless that recording left something itself.
pub(super) struct Before {
    film: PathBuf,
    /// Locked, so that no other program puts it back meanwhile.
    held: Option<File>,
}

impl Before {
    /// Sets aside what was left of `film`, if anything was. An older film that is aside already stays if it is worth more, and is kept
    /// under a number if both play.
    ///
    /// # Errors
    /// If another program writes it, or it cannot be moved: then it must not be written over.
    pub(super) fn set_aside(film: &Path) -> io::Result<Self> {
        let before = |held| Self { film: film.to_owned(), held };
        let (written, aside) = (Parts::written(film), Parts::aside(film));
        let Some(newer) = claim_left(film)? else { return Ok(before(None)) };
        if let Some(mut older) = claim_existing(&aside.partial)? {
            if written.playable(&newer)?.is_none() {
                return Ok(before(Some(older)));
            }
            if let Some(tables) = aside.playable(&older)? {
                complete(&mut older, &tables)?;
                fs::rename(&aside.partial, numbered_name(film))?;
            }
            aside.remove()?;
        }
        unless_missing(fs::rename(&written.tables, &aside.tables))?;
        fs::rename(&written.partial, &aside.partial)?;
        Ok(before(Some(newer)))
    }

    /// Removes it: the film is complete.
    pub(super) fn done(self) {
        // What cannot be removed is offered again.
        let _ = Parts::aside(&self.film).remove();
    }
}

impl Drop for Before {
    fn drop(&mut self) {
        drop(self.held.take());
        // What cannot be put back now is put back when it is kept, discarded or recorded again.
        let _ = claim_left(&self.film);
    }
}

/// The tables of a film that is being written. Their file is removed when it is dropped, unless the images stay.
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
        // The name without its ending is that of the images.
        if !self.path.with_extension("").exists() {
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// The tables in a file; `None` if it is missing or they are damaged.
fn read(path: &Path) -> io::Result<Option<Tables>> {
    let mut bytes = Vec::new();
    match File::open(path) {
        Ok(file) => file.take(LONGEST).read_to_end(&mut bytes)?,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(error),
    };
    Ok(tables_in(&bytes))
}

fn tables_in(bytes: &[u8]) -> Option<Tables> {
    let (checksum, body) = bytes.strip_prefix(MAGIC)?.split_first_chunk::<4>()?;
    if crc32fast::hash(body) != u32::from_le_bytes(*checksum) {
        return None;
    }
    let (mdat_start, rest) = body.split_first_chunk::<8>()?;
    let (end, moov) = rest.split_first_chunk::<8>()?;
    let (mdat_start, end) = (u64::from_le_bytes(*mdat_start), u64::from_le_bytes(*end));
    (mdat_start.checked_add(16)? <= end).then(|| Tables { mdat_start, end, moov: moov.to_vec() })
}

/// Completes the film in a file with its tables. After a failure it can be tried again.
fn complete(file: &mut File, tables: &Tables) -> io::Result<()> {
    file.set_len(tables.end)?;
    file.seek(SeekFrom::Start(tables.mdat_start + 8))?;
    file.write_all(&(tables.end - tables.mdat_start).to_be_bytes())?;
    file.seek(SeekFrom::End(0))?;
    file.write_all(&tables.moov)?;
    file.sync_all()
}

/// Makes a film of what an interrupted recording to `film` left. It gets that name, or `NAME-1.mp4` and so on if there is such a film.
/// Returns its path and what is in it; `None` if there is not a second of images.
///
/// # Errors
/// If another program writes it, or it cannot be written.
pub fn keep_unfinished_film(film: &Path) -> Result<Option<(PathBuf, FilmInfo)>, RecordError> {
    let failed = |error| RecordError::io(film, "keep the unfinished film", error);
    let written = Parts::written(film);
    let Some(mut file) = claim_left(film).map_err(failed)? else { return Ok(None) };
    let Some(tables) = written.playable(&file).map_err(failed)? else { return Ok(None) };
    complete(&mut file, &tables).map_err(failed)?;
    let info = film_in(&written.partial, &mut file)?;
    let kept = free_name(film);
    fs::rename(&written.partial, &kept).map_err(failed)?;
    remove_tables(film);
    Ok(Some((kept, info)))
}

/// Whether an interrupted recording to `film` left something.
pub(crate) fn is_left(film: &Path) -> bool {
    partial_path(film).exists() || has_older(film)
}

/// Whether an interrupted recording to `film` left images that play. Changes nothing.
///
/// # Errors
/// If what it left cannot be read.
pub(crate) fn plays(film: &Path) -> io::Result<bool> {
    let written = Parts::written(film);
    // An older one is kept only where there is no newer one.
    let parts = if written.partial.exists() { written } else { Parts::aside(film) };
    match File::open(&parts.partial) {
        Ok(file) => Ok(parts.playable(&file)?.is_some()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}

/// Whether something is set aside that was left of `film` before it was recorded again.
pub(crate) fn has_older(film: &Path) -> bool {
    Parts::aside(film).partial.exists()
}

/// Removes what the newest of the interrupted recordings to `film` left. An older one stays.
///
/// # Errors
/// If another program writes it, or it cannot be removed.
pub(crate) fn discard(film: &Path) -> io::Result<()> {
    match claim_left(film)? {
        Some(_lock) => {
            remove_tables(film);
            Parts::written(film).remove()
        }
        None => Ok(()),
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_set_aside_is_locked_until_it_is_put_back() {
        let folder = tempfile::tempdir().unwrap();
        let film = folder.path().join("dance.mp4");
        let (written, aside) = (Parts::written(&film), Parts::aside(&film));
        fs::write(&written.partial, b"images").unwrap();
        fs::write(&written.tables, b"tables").unwrap();
        let before = Before::set_aside(&film).unwrap();
        assert!(!written.partial.exists() && aside.partial.exists() && aside.tables.exists());
        let is_busy = |error: io::Error| error.kind() == io::ErrorKind::ResourceBusy;
        assert!(Before::set_aside(&film).is_err_and(is_busy), "a second program starts the same film");
        assert!(discard(&film).is_err_and(is_busy));
        drop(before);
        assert_eq!(fs::read(&written.partial).unwrap(), b"images");
        assert_eq!(fs::read(&written.tables).unwrap(), b"tables");
        // Control: one after the other.
        Before::set_aside(&film).unwrap().done();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn moves_that_a_crash_has_cut_are_completed() {
        let folder = tempfile::tempdir().unwrap();
        let film = folder.path().join("dance.mp4");
        let (written, aside) = (Parts::written(&film), Parts::aside(&film));
        let left = || (fs::read(&written.partial).unwrap(), fs::read(&written.tables).unwrap());
        let own = (b"images".to_vec(), b"tables".to_vec());
        // Each is what lies in the folder: images, tables, and both of those aside.
        for files in [
            // Moved aside or back in part.
            [Some("images"), None, None, Some("tables")],
            // The tables of a newer film, which was removed.
            [None, Some("newer"), Some("images"), Some("tables")],
            // The older film was kept, and its tables were not removed yet.
            [Some("images"), Some("tables"), None, Some("older")],
            // Control: none was moved.
            [Some("images"), Some("tables"), None, None],
        ] {
            let paths = [&written.partial, &written.tables, &aside.partial, &aside.tables];
            for (path, contents) in paths.iter().zip(files) {
                if let Some(contents) = contents {
                    fs::write(path, contents).unwrap();
                }
            }
            assert!(claim_left(&film).unwrap().is_some());
            assert_eq!(left(), own, "{files:?}");
            discard(&film).unwrap();
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "{files:?}");
        }
    }
}
