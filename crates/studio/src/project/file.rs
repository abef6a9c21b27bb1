//! Projects on disk: RON, versioned, written beside their name and renamed.

use std::fs::File;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::generic::unknown_fields;
use super::path::folder_of;
use super::{Access, PROJECT_VERSION, Project};
use crate::{Place, Problem, ProblemKind, StudioError};

/// The ending of project files, without the dot.
pub const PROJECT_EXTENSION: &str = "lovelock";

/// A project is text of some kilobytes; anything longer is another file.
const LARGEST_BYTES: u64 = 4 << 20;

/// How deep a project may nest: four levels are used.
const DEEPEST: usize = 32;

/// Opens the project at `path`. Files in its folder and below may be reached, others not.
///
/// A project with missing files, values out of range or fields that this version does not know opens with what
/// is there; the problems say what is not. Making the scene finds the missing files again, with what takes their
/// place: whoever does both shows those of [`Problem::is_failure`] once.
///
/// # Errors
/// As [`parse_project`], and where the file cannot be read.
pub fn load_project(path: &Path) -> Result<(Project, Vec<Problem>), StudioError> {
    let mut access = Access::for_project(path);
    load_project_with(path, &mut access)
}

/// As [`load_project`], and lets the project reach what the user has picked; `access` becomes the project's.
///
/// # Errors
/// As [`load_project`].
pub fn load_project_with(path: &Path, access: &mut Access) -> Result<(Project, Vec<Problem>), StudioError> {
    let name = path.display();
    let cannot_read =
        |error: std::io::Error| StudioError::input(path, format!("{name}: cannot be read: {error}"));
    let file = File::open(path).map_err(cannot_read)?;
    let data = file.metadata().map_err(cannot_read)?;
    if data.is_dir() {
        return Err(StudioError::input(path, format!("{name}: is a folder; wanted a project file")));
    }
    let mut bytes = Vec::new();
    file.take(LARGEST_BYTES + 1).read_to_end(&mut bytes).map_err(cannot_read)?;
    if bytes.len() as u64 > LARGEST_BYTES {
        let message = format!("{name}: longer than {LARGEST_BYTES} bytes, which no project is");
        return Err(StudioError::input(path, message));
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        StudioError::input(
            path,
            format!("{name}: byte {at}: found a byte that is no UTF-8, wanted a project (text)"),
        )
    })?;
    let (project, mut problems) = project_of_text(path, &text)?;
    access.set_project(Some(path));
    for (place, file) in project.files() {
        problems.extend(access.read(place, file).err());
    }
    Ok((project, problems))
}

/// As [`parse_project`], of a file at `path`: paths become those of files below its folder.
pub(crate) fn project_of_text(path: &Path, text: &str) -> Result<(Project, Vec<Problem>), StudioError> {
    let (mut project, problems) = parse_project(path, text)?;
    let folder = folder_of(path);
    for file in project.file_refs_mut() {
        *file = file.in_memory(&folder);
    }
    Ok((project, problems))
}

/// Reads the text of a project; `path` is for messages alone. Paths stay as they are written.
///
/// # Errors
/// Text that is no project, with line and column, and a project of a newer version.
pub fn parse_project(path: &Path, text: &str) -> Result<(Project, Vec<Problem>), StudioError> {
    #[derive(Deserialize)]
    struct Header {
        version: u32,
    }
    let name = path.display();
    let refuse = |error: ron::error::SpannedError| {
        StudioError::input(
            path,
            format!("{name}: line {}: {}; wanted a project", error.span.start, error.code),
        )
    };
    let options = ron::Options::default()
        .with_recursion_limit(DEEPEST)
        .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    // The version first: what a newer one holds need not make sense to this one.
    let header: Header = options.from_str(text).map_err(refuse)?;
    if header.version > PROJECT_VERSION {
        return Err(StudioError::input(
            path,
            format!(
                "{name}: made by a newer Lovelock (project version {}); this one reads up to version {PROJECT_VERSION}",
                header.version
            ),
        ));
    }
    let project: Project = options.from_str(text).map_err(refuse)?;
    let mut problems = Vec::new();
    let known = options
        .to_string(&project)
        .and_then(|text| options.from_str::<ron::Value>(&text).map_err(|error| error.code));
    if let (Ok(found), Ok(known)) = (options.from_str::<ron::Value>(text), known) {
        problems.extend(unknown_fields(&found, &known).into_iter().map(|field| {
            let message = format!("the field `{field}` is not known to this version and was left out");
            Problem::new(Place::Project, ProblemKind::Ignored, message)
        }));
    }
    let (project, adjusted) = project.sanitised();
    problems.extend(adjusted);
    Ok((project, problems))
}

/// Saves a project: writes beside `path`, flushes to the disk, then renames, so that a full disk or a crash
/// leaves the file that was there. Paths inside the project's folder become relative to it.
///
/// # Errors
/// Where the folder cannot be written, the disk is full, or a path is not Unicode.
pub fn save_project(path: &Path, project: &Project) -> Result<(), StudioError> {
    let name = path.display();
    let text = text_of_project(path, project).map_err(|error| {
        StudioError::output(path, format!("{name}: could not be written as text: {error}"))
    })?;
    write_whole(path, format!("{text}\n").as_bytes())
}

/// A project as the file at `path` holds it.
pub(crate) fn text_of_project(path: &Path, project: &Project) -> Result<String, ron::Error> {
    let folder = folder_of(path);
    let mut project = project.clone();
    project.version = PROJECT_VERSION;
    for file in project.file_refs_mut() {
        *file = file.for_disk(&folder);
    }
    ron::ser::to_string_pretty(&project, ron::ser::PrettyConfig::new().struct_names(false).depth_limit(4))
}

/// Writes a file beside `path`, flushes it to the disk, then renames it: never a part of it under the final name.
///
/// # Errors
/// Where the folder cannot be written or the disk is full.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), StudioError> {
    let partial = partial_name(path);
    let written = File::create(&partial).and_then(|mut file| {
        file.write_all(bytes)?;
        file.sync_all()
    });
    written.and_then(|()| std::fs::rename(&partial, path)).map_err(|error| {
        // The error that matters is the first one.
        let _ = std::fs::remove_file(&partial);
        StudioError::output(path, format!("{}: could not be saved: {error}", path.display()))
    })
}

/// `NAME.partial` beside `NAME`.
fn partial_name(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".partial");
    path.with_file_name(name)
}
