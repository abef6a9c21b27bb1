//! The database of hair clusters as a file: made, and described.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::Read as _;
use std::path::Path;

use lovelock_base::clock::Stopwatch;
use lovelock_project::error::ProjectError;
use lovelock_project::files::write_whole;
use lovelock_satf::Database;
use lovelock_satf::file::{MAGIC, VERSION, checksum};
use lovelock_satf::layout::{ANGLES, SECTORS, TEXELS};
use serde::Serialize;

/// The largest file that is read as a database, bytes. A database has 2.3 MB.
const MAX_BYTES: u64 = 64 << 20;

/// The result, as `satf build --json` prints it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SatfReport {
    /// The file.
    pub file: String,
    /// Its size.
    pub bytes: u64,
    /// The time to make the database, without writing it.
    pub seconds: f64,
    /// XXH3 of the file, 16 hexadecimal digits.
    pub checksum: String,
}

/// Makes the database on all cores and writes it to `out`, under a temporary name until it is complete. `progress` receives rising
/// fractions up to 1, from several threads.
///
/// # Errors
/// With the name of the file: its folder does not exist, `out` is a folder, or the disk is full.
pub fn build_satf(out: &Path, progress: &(dyn Fn(f32) + Sync)) -> Result<SatfReport, ProjectError> {
    // Checked now, before the work.
    let folder = out.parent().filter(|folder| !folder.as_os_str().is_empty());
    if out.file_name().is_none() || out.is_dir() || folder.is_some_and(|folder| !folder.is_dir()) {
        let message = format!("{}: must be a file in an existing folder", out.display());
        return Err(ProjectError::input(out, message));
    }
    let watch = Stopwatch::start();
    let bytes = Database::build(progress).to_bytes();
    let seconds = watch.secs();
    write_whole(out, &bytes)?;
    Ok(SatfReport {
        file: out.display().to_string(),
        bytes: bytes.len() as u64,
        seconds,
        checksum: format!("{:016x}", checksum(&bytes)),
    })
}

/// Description of a database.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DatabaseInfo {
    /// Its format with the version.
    pub format: String,
    /// Number of sectors.
    pub sectors: usize,
    /// Number of azimuths of view, and of light.
    pub azimuths: usize,
    /// Texels of a record.
    pub texels: usize,
    /// Size of the file.
    pub bytes: u64,
    /// XXH3 of the file, 16 hexadecimal digits.
    pub checksum: String,
    /// Nothing is left out of a database.
    pub dropped: BTreeMap<String, u64>,
    /// Always empty.
    pub notes: Vec<String>,
}

impl DatabaseInfo {
    /// Reads the database at `path`; `None` if the file does not begin like one or cannot be opened.
    ///
    /// # Errors
    /// The database is damaged, or belongs to another version.
    pub(crate) fn of(path: &Path) -> Result<Option<Self>, ProjectError> {
        let mut start = [0; MAGIC.len()];
        let begins = File::open(path).and_then(|mut file| file.read_exact(&mut start)).is_ok();
        if !begins || start != MAGIC {
            return Ok(None);
        }
        let refuse =
            |error: &dyn std::fmt::Display| ProjectError::input(path, format!("{}: {error}", path.display()));
        let length = fs::metadata(path).map_err(|error| refuse(&error))?.len();
        if length > MAX_BYTES {
            let message = format!("found {} MiB; must be at most {} MiB", length >> 20, MAX_BYTES >> 20);
            return Err(refuse(&message));
        }
        let bytes = fs::read(path).map_err(|error| refuse(&error))?;
        Database::from_bytes(&bytes).map_err(|error| refuse(&error))?;
        Ok(Some(Self {
            format: format!("Lovelock hair clusters {VERSION}"),
            sectors: SECTORS,
            azimuths: ANGLES,
            texels: TEXELS,
            bytes: bytes.len() as u64,
            checksum: format!("{:016x}", checksum(&bytes)),
            dropped: BTreeMap::new(),
            notes: Vec::new(),
        }))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    #[test]
    fn two_builds_have_the_same_bytes() {
        let dir = tempfile::tempdir().expect("a folder");
        let [first, second] = ["a.bin", "b ü.bin"].map(|name| dir.path().join(name));
        let told = Mutex::new(Vec::new());
        let report = build_satf(&first, &|done| told.lock().expect("a lock").push(done)).expect("a database");
        let again = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
        let again = again.install(|| build_satf(&second, &|_| ())).expect("a database");
        assert_eq!(fs::read(&first).expect("bytes"), fs::read(&second).expect("bytes"));
        assert_eq!((report.bytes, &report.checksum), (again.bytes, &again.checksum));
        let told = told.into_inner().expect("a lock");
        assert!(told.iter().any(|&done| done >= 1.0) && told.len() > 1, "{told:?}");
        let left = fs::read_dir(dir.path()).expect("a folder").count();
        assert_eq!(left, 2, "nothing but the files");
    }

    #[test]
    fn a_file_that_cannot_be_written_is_refused_with_its_name() {
        let dir = tempfile::tempdir().expect("a folder");
        for name in ["gone/satf.bin", "."] {
            let out = dir.path().join(name);
            let error = build_satf(&out, &|_| panic!("checked first")).expect_err(name);
            assert!(error.to_string().starts_with(&out.display().to_string()), "{error}");
            assert_eq!((error.to_string().lines().count(), error.exit_code()), (1, 2));
        }
        assert_eq!(fs::read_dir(dir.path()).expect("a folder").count(), 0);
    }
}
