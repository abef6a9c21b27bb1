//! The bytes of a hair file, in memory or on disk.

use std::borrow::Cow;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use lovelock_base::watch::Watch;

use super::HairFileError;

/// Bytes that are read from a file before its format is recognised: enough for the comments at the head of a text.
const START: u64 = 4096;

/// Where the bytes of a hair file are.
pub(super) enum Source<'a> {
    /// In memory.
    Memory(&'a [u8]),
    /// In a file of `length` bytes. `start` contains the bytes read so far; `folder` is where files that it refers to lie.
    File { file: File, length: u64, start: Vec<u8>, folder: PathBuf, watch: Watch },
}

impl<'a> Source<'a> {
    /// Opens a file and reads its start.
    pub(super) fn open(name: &str, path: &Path) -> Result<Self, HairFileError> {
        Self::open_watched(name, path, &Watch::default())
    }

    /// As [`Source::open`]. Reading it reports to `watch`, and stops when that says so.
    pub(super) fn open_watched(name: &str, path: &Path, watch: &Watch) -> Result<Self, HairFileError> {
        let open = || {
            let mut file = File::open(path)?;
            let mut start = Vec::new();
            file.by_ref().take(START).read_to_end(&mut start)?;
            let length = file.metadata()?.len();
            let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
            Ok(Self::File {
                file,
                length,
                start,
                folder: folder.unwrap_or(Path::new(".")).to_owned(),
                watch: watch.clone(),
            })
        };
        open().map_err(|source| HairFileError::Io { name: name.to_owned(), source })
    }

    /// The first bytes: up to 4096 of a file, or all of those in memory.
    pub(super) fn start(&self) -> &[u8] {
        match self {
            Self::Memory(data) => data,
            Self::File { start, .. } => start,
        }
    }

    /// All bytes.
    pub(super) fn into_bytes(self, name: &str) -> Result<Cow<'a, [u8]>, HairFileError> {
        match self {
            Self::Memory(data) => Ok(Cow::Borrowed(data)),
            Self::File { file, mut start, length, watch, .. } => {
                let read = Watched { file, length, done: 0, watch }.read_to_end(&mut start);
                read.map_err(|source| HairFileError::Io { name: name.to_owned(), source })?;
                Ok(Cow::Owned(start))
            }
        }
    }

    /// The folder of the file; none for bytes in memory.
    pub(super) fn folder(&self) -> Option<PathBuf> {
        match self {
            Self::Memory(_) => None,
            Self::File { folder, .. } => Some(folder.clone()),
        }
    }

    /// A reader of all bytes that holds a part of them.
    pub(super) fn into_reader(self) -> Box<dyn BufRead + 'a> {
        match self {
            Self::Memory(data) => Box::new(data),
            Self::File { file, start, length, watch, .. } => {
                let file = Watched { file, length, done: 0, watch };
                Box::new(std::io::Cursor::new(start).chain(BufReader::with_capacity(1 << 18, file)))
            }
        }
    }
}

/// A file that reports how much of it was read.
struct Watched {
    file: File,
    length: u64,
    done: u64,
    watch: Watch,
}

impl Read for Watched {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        self.watch.at(self.done as f32 / self.length.max(1) as f32)?;
        let read = self.file.read(out)?;
        self.done += read as u64;
        Ok(read)
    }
}

/// Opens a file that another one in `folder` refers to by `relative`. It must lie in that folder or below, even through
/// links. The error is the reason, for a sentence.
pub(super) fn open_beside(folder: Option<&Path>, relative: &Path) -> Result<File, String> {
    use std::path::Component;
    let folder = folder.ok_or("there is no folder to look in")?;
    if !relative.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir)) {
        return Err("only files in the folder of the file and its subfolders are read".to_owned());
    }
    let path = folder.join(relative);
    let read = |error: std::io::Error| error.to_string();
    let (folder, real) = (folder.canonicalize().map_err(read)?, path.canonicalize().map_err(read)?);
    if !real.starts_with(&folder) {
        return Err("only files in the folder of the file and its subfolders are read".to_owned());
    }
    File::open(&real).map_err(read)
}
