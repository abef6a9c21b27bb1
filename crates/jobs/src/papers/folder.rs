//! The folder of the gallery.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_project::files::write_whole;
use lovelock_project::project::save_project;
use lovelock_session::new_folders::NewFolders;

use super::page;
use super::report::PapersReport;

/// Folders of the images and of the projects that draw them, relative to the page.
const PICTURES: &str = "pictures";
const PROJECTS: &str = "projects";

/// A larger file is not a report of this program.
const LARGEST_REPORT: u64 = 64 << 20;

/// The folder, whose files are written under temporary names and then renamed.
pub(super) struct Folder {
    path: PathBuf,
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
            return Err(ProjectError::option("-o: no name for the folder of the gallery"));
        }
        if path.exists() && !path.is_dir() {
            let message = format!("{}: found a file; must be the folder of the gallery", path.display());
            return Err(ProjectError::input(path, message));
        }
        let new = NewFolders::missing_on(&path.join(PICTURES));
        for folder in [PICTURES, PROJECTS] {
            std::fs::create_dir_all(path.join(folder)).map_err(|error| {
                ProjectError::output(path, format!("{}: the folder cannot be made: {error}", path.display()))
            })?;
        }
        Ok(Self { path: path.to_owned(), _new: new })
    }

    /// The report of an earlier run of this version; that of another version shows other methods, and its figures are not kept.
    pub(super) fn earlier(&self, version: &str) -> PapersReport {
        let file = self.path.join("papers.json");
        let fits = std::fs::metadata(&file).is_ok_and(|file| file.is_file() && file.len() <= LARGEST_REPORT);
        let text = if fits { std::fs::read(&file).ok() } else { None };
        let read = text.and_then(|text| serde_json::from_slice::<PapersReport>(&text).ok());
        read.filter(|report| report.papers_version == version).unwrap_or_default()
    }

    /// Writes an image and returns its name relative to the page.
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
        Ok(file)
    }

    /// Saves a project and returns its name relative to the page.
    ///
    /// # Errors
    /// As [`Folder::picture`].
    pub(super) fn project(&self, name: &str, project: &Project) -> Result<String, ProjectError> {
        let file = format!("{PROJECTS}/{name}.lovelock");
        save_project(&self.path.join(&file), project)?;
        Ok(file)
    }

    /// The path of a file that a project reads, in the folder of projects.
    pub(super) fn beside_projects(&self, name: &str) -> PathBuf {
        self.path.join(PROJECTS).join(name)
    }

    /// Writes the data and the page.
    ///
    /// # Errors
    /// As [`Folder::picture`].
    pub(super) fn report(&self, report: &PapersReport) -> Result<(), ProjectError> {
        let json = serde_json::to_string_pretty(report).map_err(ProjectError::work)?;
        write_whole(&self.path.join("papers.json"), format!("{json}\n").as_bytes())?;
        write_whole(&self.path.join("papers.html"), page::page(report).as_bytes())
    }

    /// Removes images and projects that an earlier report names and this one does not. All other files stay, and failures are
    /// ignored because leftover files are harmless.
    pub(super) fn tidy(&self, earlier: &PapersReport, now: &PapersReport) {
        for file in files(earlier).difference(&files(now)) {
            let _ = std::fs::remove_file(self.path.join(file));
        }
    }
}

/// Images and projects of a report: plain files in their folders, never files elsewhere.
fn files(report: &PapersReport) -> BTreeSet<String> {
    let pictures = report.figures.iter().flat_map(|figure| &figure.pictures);
    let named = pictures.flat_map(|picture| [Some(picture.file.clone()), picture.project.clone()]);
    named.flatten().filter(|file| is_ours(file)).collect()
}

fn is_ours(file: &str) -> bool {
    let plain = |name: &str, end: &str| name.ends_with(end) && !name.contains(['/', '\\', ':']);
    let inside = |folder: &str| file.strip_prefix(folder).and_then(|rest| rest.strip_prefix('/'));
    inside(PICTURES).is_some_and(|name| plain(name, ".png"))
        || inside(PROJECTS).is_some_and(|name| plain(name, ".lovelock"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::papers::{FigureReport, PictureReport};

    fn report(files: &[&str]) -> PapersReport {
        let pictures =
            files.iter().map(|file| PictureReport { file: (*file).to_owned(), ..PictureReport::default() });
        PapersReport {
            papers_version: "1".to_owned(),
            figures: vec![FigureReport { pictures: pictures.collect(), ..FigureReport::default() }],
            ..PapersReport::default()
        }
    }

    #[test]
    fn only_own_files_that_are_no_longer_named_are_removed() {
        let dir = tempfile::tempdir().expect("a folder");
        let folder = Folder::new(dir.path()).expect("a folder");
        let names = [
            "pictures/old.png",
            "pictures/kept.png",
            "projects/old.lovelock",
            "pictures/mine.png",
            "out.png",
        ];
        for name in names {
            std::fs::write(dir.path().join(name), b"x").expect("a file");
        }
        let all = [
            "pictures/old.png",
            "pictures/kept.png",
            "projects/old.lovelock",
            "pictures/../out.png",
            "out.png",
        ];
        folder.tidy(&report(&all), &report(&["pictures/kept.png"]));
        let there = names.map(|name| dir.path().join(name).exists());
        assert_eq!(there, [false, true, false, true, true]);
    }

    #[test]
    fn figures_of_another_version_are_not_kept() {
        let dir = tempfile::tempdir().expect("a folder");
        let folder = Folder::new(dir.path()).expect("a folder");
        assert_eq!(folder.earlier("1"), PapersReport::default(), "there is none");
        folder.report(&report(&["pictures/a.png"])).expect("written");
        assert_eq!(folder.earlier("1"), report(&["pictures/a.png"]));
        assert_eq!(folder.earlier("2"), PapersReport::default());
        std::fs::write(dir.path().join("papers.json"), b"{}").expect("a file");
        assert_eq!(folder.earlier("1"), PapersReport::default(), "somebody's");
        let file = dir.path().join("a file");
        std::fs::write(&file, b"x").expect("a file");
        assert!(Folder::new(&file).is_err() && Folder::new(Path::new("")).is_err());
    }
}
