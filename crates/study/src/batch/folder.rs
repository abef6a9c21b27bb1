//! The report's folder.

use std::cell::RefCell;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use lovelock_project::error::StudioError;
use lovelock_project::files::write_whole;
use lovelock_session::new_folders::NewFolders;
use serde_json::Value;

use super::csv;
use crate::html;
use crate::report::CompareReport;

/// Where pictures lie, relative to the report.
const PICTURES: &str = "pictures";

/// The folder that a report is written to: each file beside its name first, then renamed.
pub(super) struct Folder {
    path: PathBuf,
    /// Pictures that were written, and those that a report of before names.
    pictures: RefCell<BTreeSet<String>>,
    /// Gone again where nothing was written.
    _new: NewFolders,
}

impl Folder {
    /// Makes the folder.
    ///
    /// # Errors
    /// Something else has its name, or it cannot be made.
    pub(super) fn new(path: &Path) -> Result<Self, StudioError> {
        if path.as_os_str().is_empty() {
            return Err(StudioError::option("-o: no name for the report's folder"));
        }
        if path.exists() && !path.is_dir() {
            let message =
                format!("{}: a file of this name is in the way of the report's folder", path.display());
            return Err(StudioError::input(path, message));
        }
        let new = NewFolders::missing_on(&path.join(PICTURES));
        std::fs::create_dir_all(path.join(PICTURES)).map_err(|error| {
            StudioError::output(path, format!("{}: the folder cannot be made: {error}", path.display()))
        })?;
        let pictures = RefCell::new(named_before(&path.join("report.json")));
        Ok(Self { path: path.to_owned(), pictures, _new: new })
    }

    /// Writes a picture and returns its name, relative to the report.
    ///
    /// # Errors
    /// The disk is full, or the folder may not be written.
    pub(super) fn picture(
        &self,
        name: &str,
        (width, height, rgba): (u32, u32, &[u8]),
    ) -> Result<String, StudioError> {
        let file = format!("{PICTURES}/{name}.png");
        let path = self.path.join(&file);
        lovelock_record::write_png(&path, width, height, rgba)
            .map_err(|error| StudioError::output(&path, error))?;
        self.pictures.borrow_mut().insert(file.clone());
        Ok(file)
    }

    /// Takes away pictures of this run and of the one before that the report does not name. What else lies in the folder stays,
    /// and so does what cannot be taken away: it harms nobody.
    pub(super) fn tidy(&self, report: &CompareReport) {
        let mut named = BTreeSet::new();
        collect(&serde_json::to_value(report).unwrap_or_default(), &mut named);
        for file in self.pictures.borrow().difference(&named) {
            let _ = std::fs::remove_file(self.path.join(file));
        }
    }

    /// Writes the report as it is now.
    ///
    /// # Errors
    /// As [`Folder::picture`].
    pub(super) fn report(&self, report: &CompareReport) -> Result<(), StudioError> {
        let json = serde_json::to_string_pretty(report).map_err(StudioError::work)?;
        write_whole(&self.path.join("report.json"), format!("{json}\n").as_bytes())?;
        write_whole(&self.path.join("report.csv"), csv::csv(report).as_bytes())?;
        write_whole(&self.path.join("report.html"), html::page(report).as_bytes())
    }
}

/// A report of before that is larger is none of ours.
const LARGEST_REPORT: u64 = 256 << 20;

/// Pictures that a report of before names; none where there is no such report.
fn named_before(report: &Path) -> BTreeSet<String> {
    let mut named = BTreeSet::new();
    let fits = std::fs::metadata(report).is_ok_and(|file| file.is_file() && file.len() <= LARGEST_REPORT);
    let text = if fits { std::fs::read(report).ok() } else { None };
    // Only what is a report: another program's file gives no leave to delete.
    let read = text.and_then(|text| serde_json::from_slice::<CompareReport>(&text).ok());
    collect(&serde_json::to_value(read).unwrap_or_default(), &mut named);
    named
}

/// Collects what names a picture of a report: a plain file in the folder of pictures, never one elsewhere.
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
    fn pictures_of_before_go_and_nothing_else_does() {
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
