//! What happens to an existing output file. Files that hold work are replaced only with `--force`; what this program has made and can
//! make again is replaced, and standard error says so.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use lovelock_project::error::ProjectError;
use lovelock_record::{IMAGE_MARK, MANIFEST_NAME};

/// The bytes at both ends of a file in which the mark of this program is looked for.
const SEARCHED: u64 = 4 << 20;

/// What an existing file with an output's name holds.
#[derive(Clone, Copy, Debug)]
pub(super) enum Holds {
    /// Work that cannot be made again by the same command: a project, strokes, a take, hair.
    Work(&'static str),
    /// An output of this program, which has one of these marks in it.
    Made(&'static [&'static [u8]]),
    /// A folder of images.
    Images,
}

impl Holds {
    /// A film, a preview or curves.
    pub(super) const RECORDING: Self = Self::Made(&[b"Lovelock"]);
    /// A single image, or a small one of a hairstyle.
    pub(super) const IMAGE: Self = Self::Made(&[IMAGE_MARK]);
    /// A table of times.
    pub(super) const BENCH: Self = Self::Made(&[b"scene,backend,adapter,shadow,"]);
    /// The list of the scenes of a path tracer.
    pub(super) const SCENES: Self = Self::Made(&[b"\"strands_file\""]);
    /// The page, the table and the numbers of a comparison.
    pub(super) const REPORT: Self =
        Self::Made(&[b"Shadow methods compared", b"name,method,draw,transparency,", b"\"swim_frames\""]);
    /// The page and the data of the papers' figures.
    pub(super) const PAPERS: Self =
        Self::Made(&[b"<title>Figures of the papers</title>", b"\"papers_version\""]);
    /// The database of hair clusters.
    pub(super) const DATABASE: Self = Self::Made(&[&lovelock_satf::file::MAGIC]);
}

/// The message, printed when the work is done, that something was replaced.
#[derive(Debug)]
#[must_use]
pub(super) struct Replaced(Option<String>);

impl Replaced {
    /// Prints it on standard error.
    pub(super) fn tell(&self) {
        if let Some(said) = &self.0 {
            eprintln!("lovelock: {said}");
        }
    }
}

/// Checks that `path` may be written before any work is done.
///
/// # Errors
/// A file that holds work, or that this program has not made, without `force`.
pub(super) fn check(path: &Path, holds: Holds, force: bool) -> Result<Replaced, ProjectError> {
    let name = path.display();
    let is_made = match holds {
        Holds::Images if !path.is_dir() => return Ok(Replaced(None)),
        Holds::Images => {
            if !has_frames(path) {
                return Ok(Replaced(None));
            }
            path.join(MANIFEST_NAME).exists() || path.join("manifest.partial").exists()
        }
        _ if !path.is_file() => return Ok(Replaced(None)),
        Holds::Work(kind) if !force => {
            return Err(ProjectError::input(
                path,
                format!(
                    "{name}: already exists and may hold {kind}; must be another name, or add --force to replace it"
                ),
            ));
        }
        Holds::Work(_) => true,
        Holds::Made(marks) => has_mark(path, marks).unwrap_or(false),
    };
    if !is_made && !force {
        return Err(ProjectError::input(
            path,
            format!(
                "{name}: already exists and was not made by this program; must be another name, or add --force to replace it"
            ),
        ));
    }
    let what = if matches!(holds, Holds::Images) { "images" } else { "file" };
    Ok(Replaced(Some(format!("{name}: replaced the existing {what}"))))
}

/// As [`check`], of files in a folder.
///
/// # Errors
/// As [`check`].
pub(super) fn check_in(
    folder: &Path,
    names: impl IntoIterator<Item = String>,
    holds: Holds,
    force: bool,
) -> Result<Replaced, ProjectError> {
    let mut is_there = false;
    for name in names {
        is_there |= check(&folder.join(name), holds, force)?.0.is_some();
    }
    Ok(Replaced(is_there.then(|| format!("{}: replaced the existing files", folder.display()))))
}

/// Whether a folder holds images that are named as frames, or a sequence.
fn has_frames(folder: &Path) -> bool {
    let Ok(entries) = std::fs::read_dir(folder) else { return false };
    entries.flatten().any(|entry| {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let number =
            name.strip_prefix("frame_").and_then(|name| name.split_once('.')).map(|(number, _)| number);
        name == MANIFEST_NAME || number.is_some_and(|number| number.chars().all(|c| c.is_ascii_digit()))
    })
}

/// Whether a file has one of `marks` near its beginning or its end.
fn has_mark(path: &Path, marks: &[&[u8]]) -> std::io::Result<bool> {
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    let mut bytes = Vec::new();
    file.by_ref().take(SEARCHED).read_to_end(&mut bytes)?;
    if length > SEARCHED {
        file.seek(SeekFrom::Start(length.saturating_sub(SEARCHED).max(SEARCHED)))?;
        file.take(SEARCHED).read_to_end(&mut bytes)?;
    }
    Ok(marks.iter().any(|mark| bytes.windows(mark.len()).any(|window| window == *mark)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_kept_and_outputs_of_this_program_are_replaced() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("a");
        let every = [Holds::Work("a take"), Holds::RECORDING, Holds::IMAGE, Holds::Images];
        for holds in every {
            assert!(check(&path, holds, false).is_ok(), "nothing is there: {holds:?}");
        }
        std::fs::write(&path, b"somebody's").expect("a file");
        for holds in [Holds::Work("a take"), Holds::RECORDING, Holds::IMAGE] {
            let error = check(&path, holds, false).expect_err("refused");
            assert_eq!(error.exit_code(), 2);
            assert!(error.to_string().contains("--force"), "{error}");
            assert!(check(&path, holds, true).is_ok());
        }
        std::fs::write(&path, b"....hdlr....Lovelock\0").expect("a file");
        assert!(check(&path, Holds::RECORDING, false).is_ok());
        assert!(check(&path, Holds::Work("a take"), false).is_err(), "whoever made it");
    }

    #[test]
    fn images_of_others_are_kept() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("a.png");
        lovelock_record::write_png(&path, 1, 1, &[1, 2, 3, 255]).expect("an image");
        assert!(check(&path, Holds::IMAGE, false).is_ok());
        // The same image without the text that names the program.
        let bytes = std::fs::read(&path).expect("the image");
        let at = bytes.windows(4).position(|name| name == b"tEXt").expect("the text") - 4;
        let length = u32::from_be_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize;
        std::fs::write(&path, [&bytes[..at], &bytes[at + 12 + length..]].concat()).expect("a file");
        assert!(check(&path, Holds::IMAGE, false).is_err());
        assert!(check(&path, Holds::RECORDING, false).is_err());
    }

    #[test]
    fn one_file_of_others_in_a_folder_is_enough_to_refuse() {
        let dir = tempfile::tempdir().expect("a folder");
        let names = || ["report.html", "report.csv"].map(str::to_owned);
        let found = |force| check_in(dir.path(), names(), Holds::REPORT, force).map(|Replaced(said)| said);
        assert_eq!(found(false).expect("nothing is there"), None);
        let page = "<title>Shadow methods compared: a</title>";
        std::fs::write(dir.path().join("report.html"), page).expect("a file");
        assert!(found(false).expect("our own").is_some());
        std::fs::write(dir.path().join("report.csv"), "date,amount\n").expect("a file");
        assert!(found(false).expect_err("refused").to_string().contains("report.csv"));
        assert!(found(true).is_ok());
    }

    #[test]
    fn the_mark_is_found_at_the_end_of_a_long_file() {
        let dir = tempfile::tempdir().expect("a folder");
        let path = dir.path().join("a.mp4");
        let file = File::create(&path).expect("a file");
        file.set_len(3 * SEARCHED).expect("a long file");
        assert!(check(&path, Holds::RECORDING, false).is_err());
        let mut bytes = vec![0; 100];
        bytes.extend(b"Lovelock");
        let mut file = std::fs::OpenOptions::new().append(true).open(&path).expect("the file");
        std::io::Write::write_all(&mut file, &bytes).expect("written");
        assert!(check(&path, Holds::RECORDING, false).is_ok());
    }

    #[test]
    fn images_of_others_in_a_folder_are_kept() {
        let dir = tempfile::tempdir().expect("a folder");
        std::fs::write(dir.path().join("notes.txt"), b"x").expect("a file");
        assert!(check(dir.path(), Holds::Images, false).is_ok());
        std::fs::write(dir.path().join("frame_0001.png"), b"x").expect("a file");
        assert!(check(dir.path(), Holds::Images, false).is_err());
        std::fs::write(dir.path().join(MANIFEST_NAME), b"{}").expect("a file");
        assert!(check(dir.path(), Holds::Images, false).is_ok());
    }
}
