//! The report's folder.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use lovelock_project::error::ProjectError;
use lovelock_project::files::write_whole;
use lovelock_record::{PictureSink, SinkSettings};
use lovelock_session::new_folders::NewFolders;
use serde_json::Value;

use super::csv;
use crate::html;
use crate::report::CompareReport;

/// Folder of the images, relative to the report.
const PICTURES: &str = "pictures";
/// Folder of the error maps of every frame.
const SEQUENCES: &str = "frames";

/// The folder of a report. Each file is written under a temporary name and then renamed.
pub(super) struct Folder {
    path: PathBuf,
    /// Written images, and images named by an earlier report.
    pictures: RefCell<BTreeSet<String>>,
    /// Removes new folders if nothing was written.
    _new: NewFolders,
}

impl Folder {
    /// Creates the folder.
    ///
    /// # Errors
    /// If a file has its name, or it cannot be created.
    pub(super) fn new(path: &Path) -> Result<Self, ProjectError> {
        if path.as_os_str().is_empty() {
            return Err(ProjectError::option("-o: no name for the report's folder"));
        }
        if path.exists() && !path.is_dir() {
            let message = format!("{}: found a file; must be the report's folder", path.display());
            return Err(ProjectError::input(path, message));
        }
        let new = NewFolders::missing_on(&path.join(PICTURES));
        std::fs::create_dir_all(path.join(PICTURES)).map_err(|error| {
            ProjectError::output(path, format!("{}: the folder cannot be made: {error}", path.display()))
        })?;
        let pictures = RefCell::new(named_before(&path.join("report.json")));
        Ok(Self { path: path.to_owned(), pictures, _new: new })
    }

    /// Writes an image and returns its name relative to the report.
    ///
    /// # Errors
    /// If the disk is full or the folder is not writable.
    pub(super) fn picture(
        &self,
        name: &str,
        (width, height, rgba): (u32, u32, &[u8]),
    ) -> Result<String, ProjectError> {
        let file = format!("{PICTURES}/{name}.png");
        let path = self.path.join(&file);
        lovelock_record::write_png(&path, width, height, rgba)
            .map_err(|error| ProjectError::output(&path, error))?;
        self.pictures.borrow_mut().insert(file.clone());
        Ok(file)
    }

    /// The name of the error map of a frame in the folder of a method, and the folder's.
    pub(super) fn frame_name(method: &str, frame: u64) -> (String, String) {
        let folder = format!("{SEQUENCES}/{method}");
        (format!("{folder}/error.{frame:04}.png"), folder)
    }

    /// Writes the error map of a frame; returns the name of the folder with all frames, relative to the report.
    ///
    /// # Errors
    /// As [`Folder::picture`].
    pub(super) fn frame(
        &self,
        (method, frame): (&str, u64),
        (width, height, rgba): (u32, u32, &[u8]),
    ) -> Result<String, ProjectError> {
        let (file, folder) = Self::frame_name(method, frame);
        let path = self.path.join(file);
        std::fs::create_dir_all(self.path.join(&folder))
            .map_err(|error| ProjectError::output(&path, format!("{}: {error}", path.display())))?;
        lovelock_record::write_png(&path, width, height, rgba)
            .map_err(|error| ProjectError::output(&path, error))?;
        Ok(folder)
    }

    /// Begins a film.
    ///
    /// # Errors
    /// As [`Folder::picture`].
    pub(super) fn film(&self, name: &str, settings: SinkSettings) -> Result<PictureSink, ProjectError> {
        let path = self.path.join(name);
        let film =
            PictureSink::for_path(&path, settings).map_err(|error| ProjectError::output(&path, error))?;
        // The comparison is made again as a whole.
        Ok(film.leaving_nothing())
    }

    /// The whole path of a file of the report.
    pub(super) fn path_of(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Removes images of this and the previous run that the report does not name. All other files stay, and failures are ignored
    /// because leftover images are harmless.
    pub(super) fn tidy(&self, report: &CompareReport) {
        let mut named = BTreeSet::new();
        collect(&serde_json::to_value(report).unwrap_or_default(), &mut named);
        for file in self.pictures.borrow().difference(&named) {
            let _ = std::fs::remove_file(self.path.join(file));
        }
    }

    /// Writes the current report.
    ///
    /// # Errors
    /// As [`Folder::picture`].
    pub(super) fn report(&self, report: &CompareReport) -> Result<(), ProjectError> {
        let json = serde_json::to_string_pretty(report).map_err(ProjectError::work)?;
        write_whole(&self.path.join("report.json"), format!("{json}\n").as_bytes())?;
        write_whole(&self.path.join("report.csv"), csv::csv(report).as_bytes())?;
        write_whole(&self.path.join("report.html"), html::page(report).as_bytes())
    }
}

/// A larger file is not a report of this program.
const LARGEST_REPORT: u64 = 256 << 20;

/// Images named by an earlier report, if there is one.
fn named_before(report: &Path) -> BTreeSet<String> {
    let mut named = BTreeSet::new();
    let fits = std::fs::metadata(report).is_ok_and(|file| file.is_file() && file.len() <= LARGEST_REPORT);
    let text = if fits { std::fs::read(report).ok() } else { None };
    // Only for valid reports: files of other programs must not cause deletions.
    let read = text.and_then(|text| serde_json::from_slice::<CompareReport>(&text).ok());
    collect(&serde_json::to_value(read).unwrap_or_default(), &mut named);
    named
}

/// Collects names of images in a report: plain files in the image folder, never files elsewhere.
fn collect(value: &Value, named: &mut BTreeSet<String>) {
    match value {
        Value::String(text) => {
            let plain = |name: &str| {
                Path::new(name).extension().is_some_and(|end| end == "png")
                    && !name.contains(['/', '\\', ':'])
            };
            let name = text.strip_prefix(PICTURES).and_then(|rest| rest.strip_prefix('/'));
            if name.is_some_and(plain) {
                named.insert(text.clone());
            }
        }
        Value::Array(all) => all.iter().for_each(|value| collect(value, named)),
        Value::Object(all) => all.values().for_each(|value| collect(value, named)),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_earlier_images_are_removed() {
        let dir = tempfile::tempdir().expect("a folder");
        let at = |name: &str| dir.path().join(name);
        std::fs::create_dir(at("pictures")).expect("a folder");
        for file in
            ["pictures/old.png", "pictures/both.png", "pictures/mine.png", "pictures/notes.txt", "out.png"]
        {
            std::fs::write(at(file), b"x").expect("a file");
        }
        let mut before = CompareReport::default();
        before.reference.picture = Some("pictures/old.png".to_owned());
        before.reference.transmittance = Some("pictures/both.png".to_owned());
        before.notes =
            ["pictures/../out.png", "out.png", "pictures/notes.txt", "pictures/"].map(str::to_owned).into();
        let json = serde_json::to_vec(&before).expect("JSON");
        std::fs::write(at("report.json"), json).expect("a report");
        let folder = Folder::new(dir.path()).expect("a folder");
        let pixel: &[u8] = &[0, 0, 0, 255];
        folder.picture("unfinished", (1, 1, pixel)).expect("a picture");
        let now = folder.picture("now", (1, 1, pixel)).expect("a picture");
        let mut report = CompareReport::default();
        report.reference.picture = Some(now);
        report.reference.transmittance = Some("pictures/both.png".to_owned());
        folder.tidy(&report);
        for (file, stays) in [
            ("pictures/old.png", false),
            ("pictures/unfinished.png", false),
            ("pictures/both.png", true),
            ("pictures/mine.png", true),
            ("pictures/now.png", true),
            ("pictures/notes.txt", true),
            ("out.png", true),
        ] {
            assert_eq!(at(file).exists(), stays, "{file}");
        }
    }

    #[test]
    fn what_is_no_report_names_nothing() {
        let dir = tempfile::tempdir().expect("a folder");
        let file = dir.path().join("report.json");
        assert!(named_before(&file).is_empty());
        std::fs::write(&file, r#"{"file": "pictures/a.png"}"#).expect("a file");
        assert!(named_before(&file).is_empty());
    }
}
