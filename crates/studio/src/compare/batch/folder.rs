//! The report's folder.

use std::path::{Path, PathBuf};

use super::csv;
use crate::compare::html;
use crate::headless::NewFolders;
use crate::{CompareReport, StudioError, write_whole};

/// Where pictures lie, relative to the report.
const PICTURES: &str = "pictures";

/// The folder that a report is written to: each file beside its name first, then renamed.
pub(super) struct Folder {
    path: PathBuf,
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
        Ok(Self { path: path.to_owned(), _new: new })
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
        Ok(file)
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
