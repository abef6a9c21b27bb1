//! Files that are written as `NAME.partial` and renamed when they are complete.

use crate::claim::claim;
use std::fs::{self, File};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// What an unfinished file is written to: a file, except in tests of full disks.
pub(crate) trait Medium: Write + Seek + Send {
    /// Waits until everything written is on the disk.
    fn sync(&mut self) -> io::Result<()>;
}

impl Medium for File {
    fn sync(&mut self) -> io::Result<()> {
        self.sync_all()
    }
}

/// Opens the medium of an unfinished file by its path.
pub(crate) type Opener = dyn Fn(&Path) -> io::Result<Box<dyn Medium>> + Send + Sync;

/// The opener of every real recording: an empty file, locked against other recordings.
pub(crate) fn open_file(partial: &Path) -> io::Result<Box<dyn Medium>> {
    let file = claim(partial)?;
    // A crash may have left data in the file.
    file.set_len(0)?;
    Ok(Box::new(file))
}

/// An unfinished file. If it is dropped before [`PartialFile::commit`], the file is removed, unless it shall stay.
pub(crate) struct PartialFile {
    target: PathBuf,
    partial: PathBuf,
    medium: Option<BufWriter<Box<dyn Medium>>>,
    stays: bool,
}

impl PartialFile {
    pub(crate) fn create(target: &Path, opener: &Opener) -> io::Result<Self> {
        let partial = partial_path(target);
        let medium = BufWriter::with_capacity(1 << 16, opener(&partial)?);
        Ok(Self { target: target.to_owned(), partial, medium: Some(medium), stays: false })
    }

    /// Says whether the file stays if it is dropped, because what is in it can be used.
    pub(crate) fn set_stays(&mut self, stays: bool) {
        self.stays = stays;
    }

    /// Renames the file to its final name. With `durable` it waits for the disk first, so that after a power failure a file with
    /// the final name is never incomplete.
    pub(crate) fn commit(mut self, durable: bool) -> io::Result<()> {
        let medium = self.medium()?;
        medium.flush()?;
        if durable {
            medium.get_mut().sync()?;
        }
        // Renamed while it is still open and locked, so that no other recording can claim it in between.
        fs::rename(&self.partial, &self.target)?;
        self.close();
        if durable && let Some(folder) = self.target.parent() {
            // The rename is stored in the folder. Not every system can open a folder; the file's data is safe without it.
            let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
            let _ = File::open(folder).and_then(|folder| folder.sync_all());
        }
        Ok(())
    }

    fn medium(&mut self) -> io::Result<&mut BufWriter<Box<dyn Medium>>> {
        self.medium.as_mut().ok_or_else(|| io::Error::other("the file is closed"))
    }

    /// Closes without flushing: `commit` has flushed already, and writing to a full disk again would fail again.
    fn close(&mut self) {
        if let Some(medium) = self.medium.take() {
            drop(medium.into_parts());
        }
    }
}

impl Write for PartialFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.medium()?.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.medium()?.flush()
    }
}

impl Seek for PartialFile {
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        self.medium()?.seek(position)
    }
}

impl Drop for PartialFile {
    fn drop(&mut self) {
        // After a commit the partial name no longer exists, or belongs to another recording. Errors of the removal cannot be
        // reported from here.
        if self.medium.is_some() {
            if !self.stays {
                let _ = fs::remove_file(&self.partial);
            }
            self.close();
        }
    }
}

/// `NAME.partial` beside `NAME`.
pub(crate) fn partial_path(target: &Path) -> PathBuf {
    let mut name = target.file_name().unwrap_or_default().to_owned();
    name.push(".partial");
    target.with_file_name(name)
}

/// `target` if there is no such file, otherwise its [`numbered_name`].
pub(crate) fn free_name(target: &Path) -> PathBuf {
    if target.exists() { numbered_name(target) } else { target.to_owned() }
}

/// The first of `NAME-1.EXTENSION` and so on that neither exists nor is being written.
pub(crate) fn numbered_name(target: &Path) -> PathBuf {
    let stem = target.file_stem().unwrap_or_default();
    let numbered = |number: u32| {
        let mut name = stem.to_owned();
        name.push(format!("-{number}"));
        target.extension().inspect(|extension| {
            name.push(".");
            name.push(extension);
        });
        target.with_file_name(name)
    };
    let free = |path: &PathBuf| !path.exists() && !partial_path(path).exists();
    (1..u32::MAX).map(numbered).find(free).unwrap_or_else(|| target.to_owned())
}

/// Creates the folder of `target` if it is missing.
pub(crate) fn create_parent(target: &Path) -> io::Result<()> {
    match target.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => fs::create_dir_all(folder),
        _ => Ok(()),
    }
}

/// Media that fail, for tests of errors.
#[cfg(test)]
pub(crate) mod failing {
    use super::{Medium, open_file};
    use std::io::{self, Seek, SeekFrom, Write};
    use std::path::Path;

    /// A disk with room for only a given number of bytes.
    pub(crate) struct SmallDisk {
        inner: Box<dyn Medium>,
        room: u64,
    }

    impl Write for SmallDisk {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let fits = bytes.len().min(usize::try_from(self.room).unwrap_or(usize::MAX));
            if fits == 0 && !bytes.is_empty() {
                return Err(io::ErrorKind::StorageFull.into());
            }
            self.room -= fits as u64;
            self.inner.write(&bytes[..fits])
        }

        fn flush(&mut self) -> io::Result<()> {
            self.inner.flush()
        }
    }

    impl Seek for SmallDisk {
        fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
            self.inner.seek(position)
        }
    }

    impl Medium for SmallDisk {
        fn sync(&mut self) -> io::Result<()> {
            self.inner.sync()
        }
    }

    /// An opener of files on a [`SmallDisk`] with `room` bytes.
    pub(crate) fn small_disk(room: u64) -> impl Fn(&Path) -> io::Result<Box<dyn Medium>> + Send + Sync {
        move |path| Ok(Box::new(SmallDisk { inner: open_file(path)?, room }) as Box<dyn Medium>)
    }

    /// An opener that writes to `/dev/full`, the device that is always full.
    #[cfg(target_os = "linux")]
    pub(crate) fn full_device(_: &Path) -> io::Result<Box<dyn Medium>> {
        Ok(Box::new(std::fs::OpenOptions::new().write(true).open("/dev/full")?))
    }
}

#[cfg(test)]
mod tests {
    use super::failing::small_disk;
    use super::{PartialFile, open_file, partial_path};
    use std::fs;
    use std::io::Write;
    use std::path::Path;

    #[test]
    fn the_name_appears_only_when_the_file_is_complete() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("a file ü.bin");
        let mut file = PartialFile::create(&target, &open_file).unwrap();
        file.write_all(b"whole").unwrap();
        assert!(!target.exists());
        assert!(partial_path(&target).exists());
        file.commit(true).unwrap();
        assert_eq!(fs::read(&target).unwrap(), b"whole");
        assert!(!partial_path(&target).exists());
    }

    #[test]
    fn dropping_leaves_the_old_file_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("film.mp4");
        fs::write(&target, b"old").unwrap();
        fs::write(partial_path(&target), b"left by a crash").unwrap();
        let mut file = PartialFile::create(&target, &open_file).unwrap();
        file.write_all(b"new").unwrap();
        drop(file);
        assert_eq!(fs::read(&target).unwrap(), b"old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_full_disk_at_commit_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("film.mp4");
        let mut file = PartialFile::create(&target, &small_disk(3)).unwrap();
        file.write_all(b"four").unwrap(); // Buffered: nothing has reached the disk yet.
        assert!(file.commit(true).is_err());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn the_partial_name_keeps_the_whole_name() {
        assert_eq!(partial_path(Path::new("out/dance.mp4")), Path::new("out/dance.mp4.partial"));
    }
}
