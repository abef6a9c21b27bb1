//! What the window begins with: the file of the command line, and what is shown of it.

use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use lovelock_base::watch::Watch;
use lovelock_base::words::counted;
use lovelock_jobs::info::FileKind;
use lovelock_project::Project;
use lovelock_project::error::{Place, Problem, ProblemKind, ProjectError};
use lovelock_project::files::Access;
use lovelock_project::grants::Grants;
use lovelock_project::project::{Assignment, load_project_with};
use lovelock_project::styles::StyleParts;

use super::files::{place_of, set_part};
use super::opening::{Found, Played};
use super::page::Page;
use super::{Window, display, methods};

/// What the window shows when it opens.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Shows {
    /// The panes of a comparison.
    pub(crate) panes: bool,
    /// The mask of a layer, by its place in the list from 1.
    pub(crate) mask: Option<u32>,
    /// A shadow method of the user's own.
    pub(crate) method: Option<lovelock_render::UserMethod>,
}

/// Opens the window with the file at `path`, if there is one.
pub(crate) fn open(
    path: Option<&Path>,
    set: &[Assignment],
    shows: Shows,
    screenshot: Option<(PathBuf, f64)>,
) -> Result<(), ProjectError> {
    // A screenshot has nobody who waits, and the layer of a mask must be known.
    let at_once = screenshot.is_some() || shows.mask.is_some();
    let (mut opened, refused) = open_or_refuse(path, set, at_once)?;
    if let Some(method) = shows.method {
        methods::show(&mut opened.project, method, shows.panes);
    }
    let layers = &opened.project.hair.stack.layers;
    let shown = shows.mask.map(|place| {
        let layer = layers.get(place as usize - 1);
        layer.map(|layer| layer.id).ok_or_else(|| {
            let found = counted(layers.len(), "layer", "layers");
            ProjectError::option(format!(
                "--mask {place}: found {found}; must be the position of a layer, from 1"
            ))
        })
    });
    let shown = shown.transpose()?;
    let is_bare = path.is_none() && set.is_empty() && !shows.panes && shown.is_none() && screenshot.is_none();
    let has_opened = Rc::new(Cell::new(false));
    let opens = Rc::clone(&has_opened);
    let ended = display::run(move |creation| {
        let mut window = Window::new(creation, opened, screenshot)?;
        opens.set(true);
        window.panels.layers.reveal(shown);
        if shows.panes {
            window.layout.page = Page::Compare;
        } else if window.layout.page == Page::Wall {
            // Nine simulations are not what a program should start with.
            window.layout.page = Page::Image;
        }
        // What the command line names is what the user wants to see; and what was lost comes first.
        if is_bare && window.layout.starts_with_page && !window.safety.is_asking() {
            window.start.open(&creation.egui_ctx, &window.layout);
        }
        Ok(window)
    });
    match refused {
        // Without a display the file is what is wrong with the command.
        Some(refused) if ended.is_err() && !has_opened.get() => Err(refused),
        _ => ended,
    }
}

/// A project to start with.
#[derive(Debug, Default)]
pub(super) struct Opened {
    pub(super) project: Project,
    pub(super) project_path: Option<PathBuf>,
    pub(super) picked: Vec<PathBuf>,
    pub(super) problems: Vec<Problem>,
    /// The file that it was started with as a part of the project, and the project without it.
    pub(super) part: Option<(Place, PathBuf, Project)>,
    /// Strokes that are played on the hair of the project once the window is there.
    pub(super) strokes: Option<PathBuf>,
    /// Why the file of the command line could not be opened.
    pub(super) refused: Option<String>,
}

/// As [`open_for_start`]. A file that cannot be opened is told in the window, with a new project in which the settings are changed: nobody
/// reads what a program prints that a desktop has started. The error is for the case that no window opens.
fn open_or_refuse(
    path: Option<&Path>,
    set: &[Assignment],
    at_once: bool,
) -> Result<(Opened, Option<ProjectError>), ProjectError> {
    match open_for_start(path, set, at_once) {
        Ok(opened) => Ok((opened, None)),
        // Desktops give no options.
        Err(error) if at_once || matches!(error, ProjectError::Request { file: None, .. }) => Err(error),
        Err(error) => {
            let (project, refused) = (new_project(set)?, Some(error.to_string()));
            Ok((Opened { project, refused, ..Opened::default() }, Some(error)))
        }
    }
}

/// The default project with other settings.
fn new_project(set: &[Assignment]) -> Result<Project, ProjectError> {
    let mut project = Project::default();
    project.assign(set)?;
    Ok(project)
}

/// Opens the file that is named on the command line, or the default project, and changes settings of it. Strokes are played `at_once`, or once
/// the window is there.
fn open_for_start(path: Option<&Path>, set: &[Assignment], at_once: bool) -> Result<Opened, ProjectError> {
    let Some(path) = path else { return Ok(Opened { project: new_project(set)?, ..Opened::default() }) };
    // The ending first: to find the kind, large files are read as a whole.
    if FileKind::by_extension(path) == Some(FileKind::Strokes) && FileKind::of(path)? == FileKind::Strokes {
        let mut opened = Opened { project: new_project(set)?, ..Opened::default() };
        if at_once {
            let played = Played::of(path, &opened.project, &Watch::default())?;
            (opened.project, opened.problems) = (played.project, played.problems);
        } else {
            opened.strokes = Some(std::path::absolute(path).unwrap_or_else(|_| path.to_owned()));
        }
        return Ok(opened);
    }
    let (mut opened, place) = open_file(path)?;
    opened.project.assign(set)?;
    opened.part =
        place.map(|place| new_project(set).map(|before| (place, path.to_owned(), before))).transpose()?;
    Ok(opened)
}

/// Opens a file that holds no strokes; also returns the part of the project that it becomes, if it is one.
fn open_file(path: &Path) -> Result<(Opened, Option<Place>), ProjectError> {
    let mut place = None;
    let mut opened = Opened { picked: vec![path.to_owned()], ..Opened::default() };
    match Found::of(path, &opened.project.hair, None, &Watch::default())? {
        Found::Curves(curves) => opened.project = curves.played_in(&opened.project),
        Found::Part(kind, unused) => {
            let unused = unused.map(|why| Problem::new(Place::Hair, ProblemKind::Ignored, why));
            opened.problems.extend(unused);
            set_part(&mut opened.project, kind, path);
            place = Some(place_of(kind));
        }
        Found::Document(FileKind::Style) => {
            let listed = lovelock_jobs::presets::style_in(path)?;
            opened.picked.extend(listed.style.hair.file.as_ref().map(|file| file.path.clone()));
            opened.project.apply_style(&listed.style, StyleParts::ALL);
        }
        Found::Document(FileKind::Strokes) | Found::Strokes(_) => {
            let message = format!("{}: found strokes; must be a project or a part of one", path.display());
            return Err(ProjectError::input(path, message));
        }
        Found::Document(_) => {
            let mut access = Access::for_project(path);
            Grants::of_user().allow(path, &mut access);
            (opened.project, opened.problems) = load_project_with(path, &mut access)?;
            // Recent projects and the journal name it from any folder.
            opened.project_path = Some(std::path::absolute(path).unwrap_or_else(|_| path.to_owned()));
        }
        Found::Take(project, problems) => (opened.project, opened.problems) = (*project, problems),
    }
    Ok((opened, place))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strokes_wait_for_the_window_and_come_after_the_settings_of_the_command_line() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("combed ü.lovelockstrokes");
        std::fs::write(&path, "(version: 1, strokes: [])").expect("a file");
        let set = [("hair.groom.wisps", "16"), ("timeline.preroll_secs", "0.1")]
            .map(|(name, value)| Assignment { name: name.to_owned(), value: value.to_owned() });
        let waits = open_for_start(Some(&path), &set, false).expect("a project");
        let mut wanted = Project::default();
        wanted.assign(&set).expect("settings");
        assert_eq!((waits.strokes.as_ref(), &waits.project), (Some(&path), &wanted));
        let played = open_for_start(Some(&path), &set, true).expect("a project");
        assert!(played.strokes.is_none() && played.project_path.is_none() && played.picked.is_empty());
        assert_eq!(played.project.hair.stack.layers.len(), wanted.hair.stack.layers.len() + 1);
        assert_eq!(played.project.hair.groom.wisps, 16);
        // Control: they are not read as a project.
        let refused = open_file(&path).expect_err("strokes").to_string();
        assert!(refused.contains("combed ü.lovelockstrokes: found strokes"), "{refused}");
        for at_once in [false, true] {
            let gone = open_for_start(Some(&folder.path().join("gone.lovelockstrokes")), &[], at_once);
            assert!(gone.is_err_and(|error| error.to_string().contains("gone.lovelockstrokes")));
        }
    }

    #[test]
    fn a_file_that_cannot_be_opened_is_told_beside_a_new_project() {
        let folder = tempfile::tempdir().expect("a folder");
        let (gone, broken) = (folder.path().join("gone.lovelock"), folder.path().join("broken.take"));
        std::fs::write(&broken, b"no take").expect("a file");
        let assign =
            |name: &str, value: &str| [Assignment { name: name.to_owned(), value: value.to_owned() }];
        let (wrong, right) = (assign("sparkle", "1"), assign("hair.groom.wisps", "16"));
        for (path, name) in [(&gone, "gone.lovelock"), (&broken, "broken.take")] {
            let (opened, error) = open_or_refuse(Some(path), &right, false).expect("a new project");
            assert_eq!(opened.project, new_project(&right).expect("a project"));
            assert_eq!(opened.project.hair.groom.wisps, 16);
            let said = error.expect("an error").to_string();
            assert!(said.contains(name) && opened.refused.as_ref() == Some(&said), "{said}");
            assert!(open_or_refuse(Some(path), &[], true).is_err(), "a picture of it is waited for");
            let told = open_or_refuse(Some(path), &wrong, false).expect_err("a wrong option").to_string();
            assert!(told.contains("sparkle"), "{told}");
        }
        // Controls: a wrong option, and a file that can be opened.
        assert!(open_or_refuse(None, &wrong, false).is_err());
        lovelock_project::project::save_project(&gone, &Project::default()).expect("saved");
        let (opened, error) = open_or_refuse(Some(&gone), &[], false).expect("a project");
        assert!(error.is_none() && opened.refused.is_none() && opened.project_path.is_some());
        assert!(open_or_refuse(Some(&gone), &wrong, false).is_err());
    }
}
