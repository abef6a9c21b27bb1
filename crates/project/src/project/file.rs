//! Reading and writing project files (RON, versioned).

use std::fs::File;
use std::io::Read;
use std::path::Path;

use lovelock_motion::LoopBlend;
use serde::Deserialize;

use super::generic::unknown_fields;
use super::version_1::Version1;
use super::{PROJECT_VERSION, Project, loop_blend, version_2};
use crate::error::{Place, Problem, ProblemKind, ProjectError};
use crate::files::{Access, FileRef, folder_of, write_whole};

/// The extension of project files, without the dot.
pub const PROJECT_EXTENSION: &str = "lovelock";

/// Largest size of a project file. A project is a few kilobytes of text, and up to a few megabytes with much hair that was brushed.
pub(crate) const LARGEST_BYTES: u64 = 64 << 20;

/// The deepest nesting that is read. Projects use four levels.
const DEEPEST: usize = 32;

/// How many letters of a file that is none of ours a message has.
const EXCERPT: usize = 20;

/// Opens the project at `path`. Only files in its folder and below may be read.
///
/// A project with missing files, values out of range or unknown fields opens with the rest; the problems say what is wrong.
/// Loading the scene reports missing files again, together with their replacements, so a caller that does both should show
/// problems with [`Problem::is_failure`] once.
///
/// # Errors
/// As [`parse_project`], and if the file cannot be read.
pub fn load_project(path: &Path) -> Result<(Project, Vec<Problem>), ProjectError> {
    let mut access = Access::for_project(path);
    load_project_with(path, &mut access)
}

/// As [`load_project`], but also allows files that the user has picked. `access` becomes that of the project.
///
/// # Errors
/// As [`load_project`].
pub fn load_project_with(path: &Path, access: &mut Access) -> Result<(Project, Vec<Problem>), ProjectError> {
    let text = read_text(path, "project", LARGEST_BYTES)?;
    let (project, mut problems) = project_of_text(path, &text)?;
    access.set_project(Some(path));
    for (place, file) in project.files() {
        problems.extend(access.read(place, file).err());
    }
    for method in project.user_methods() {
        match access.read(Place::Shadow, &FileRef::new(method.description_file())) {
            Ok(_) => method.allow(),
            Err(problem) => problems.push(problem),
        }
    }
    Ok((project, problems))
}

/// The text of a file that should be a `what`, such as a project, of at most `largest` bytes.
///
/// # Errors
/// A file that cannot be read, is a folder, is larger than that, or is not text.
pub fn read_text(path: &Path, what: &str, largest: u64) -> Result<String, ProjectError> {
    let name = path.display();
    let cannot_read =
        |error: std::io::Error| ProjectError::input(path, format!("{name}: cannot be read: {error}"));
    let file = File::open(path).map_err(cannot_read)?;
    let data = file.metadata().map_err(cannot_read)?;
    if data.is_dir() {
        return Err(ProjectError::input(path, format!("{name}: is a folder; must be a {what} file")));
    }
    let mut bytes = Vec::new();
    file.take(largest.saturating_add(1)).read_to_end(&mut bytes).map_err(cannot_read)?;
    if bytes.len() as u64 > largest {
        let message = format!("{name}: larger than {largest} bytes, the largest size of a {what}");
        return Err(ProjectError::input(path, message));
    }
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        ProjectError::input(path, format!("{name}: byte {at}: not valid UTF-8; must be a {what} (text)"))
    })
}

/// As [`parse_project`], for a file at `path`: relative paths are resolved against its folder.
///
/// # Errors
/// As [`parse_project`].
pub fn project_of_text(path: &Path, text: &str) -> Result<(Project, Vec<Problem>), ProjectError> {
    let (mut project, problems) = parse_project(path, text)?;
    let folder = folder_of(path);
    for file in project.file_refs_mut() {
        *file = file.in_memory(&folder);
    }
    Ok((project, problems))
}

/// Reads the text of a project. `path` is used for messages only. Paths stay as they are written.
///
/// # Errors
/// Text that is not a project, with line and column, or a project of a newer version.
pub fn parse_project(path: &Path, text: &str) -> Result<(Project, Vec<Problem>), ProjectError> {
    parse_text(path, text, "project", &[])
}

/// How project files are read.
pub(crate) fn text_options() -> ron::Options {
    ron::Options::default()
        .with_recursion_limit(DEEPEST)
        .with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME)
}

/// Refuses a text that begins unlike everything this program writes, such as a project; `what` it should be. Parsers would say what they
/// expected instead.
///
/// # Errors
/// How the text begins, and what it must be.
pub fn refuse_foreign(path: &Path, text: &str, what: &str) -> Result<(), ProjectError> {
    match foreign_begin(text) {
        None => Ok(()),
        Some(found) => {
            let message = format!("{}: {found}; must be a Lovelock {what}", path.display());
            Err(ProjectError::input(path, message))
        }
    }
}

/// What a text begins with that no project, style or stroke recording begins with; `None` if it may be one of them.
fn foreign_begin(text: &str) -> Option<String> {
    let text = text.trim_start_matches('\u{feff}').trim();
    // The whole, a comment or an extension of RON.
    if text.starts_with(['(', '/', '#']) {
        return None;
    }
    let excerpt: String = text.chars().take_while(|c| !c.is_control()).take(EXCERPT).collect();
    Some(match excerpt.trim_end() {
        _ if text.is_empty() => "is empty".to_owned(),
        "" => "begins with a control character".to_owned(),
        excerpt => format!("begins with “{excerpt}”"),
    })
}

/// As [`parse_project`], for text that should be a `what`, with fields besides those of a project.
pub(crate) fn parse_text(
    path: &Path,
    text: &str,
    what: &str,
    more_fields: &[&str],
) -> Result<(Project, Vec<Problem>), ProjectError> {
    #[derive(Deserialize)]
    struct Header {
        version: u32,
    }
    let name = path.display();
    let refuse = |error: ron::error::SpannedError| {
        ProjectError::input(
            path,
            format!("{name}: line {}: {}; must be a {what}", error.span.start, error.code),
        )
    };
    refuse_foreign(path, text, what)?;
    let options = text_options();
    // The version first, because the contents of a newer one may not be readable.
    let header: Header = options.from_str(text).map_err(refuse)?;
    if header.version > PROJECT_VERSION {
        return Err(ProjectError::input(
            path,
            format!(
                "{name}: made by a newer Lovelock ({what} version {}); this one reads up to version {PROJECT_VERSION}",
                header.version
            ),
        ));
    }
    let mut project: Project = options.from_str(text).map_err(refuse)?;
    let is_version_1 = header.version < 2;
    if is_version_1 {
        options.from_str::<Version1>(text).map_err(refuse)?.migrate(&mut project);
    }
    if header.version < 3 {
        version_2::migrate(&mut project);
    }
    if loop_blend::is_at_start(&options, text) {
        project.motion.loop_blend = LoopBlend::Start;
    }
    let mut problems = Vec::new();
    let known = options
        .to_string(&project)
        .and_then(|text| options.from_str::<ron::Value>(&text).map_err(|error| error.code));
    if let (Ok(found), Ok(known)) = (options.from_str::<ron::Value>(text), known) {
        let unknown = unknown_fields(&found, &known).into_iter();
        let known = |field: &String| {
            more_fields.contains(&field.as_str()) || (is_version_1 && Version1::knows(field))
        };
        problems.extend(unknown.filter(|field| !known(field)).map(|field| {
            let message = format!("the field `{field}` is not known to this version and was left out");
            Problem::new(Place::Project, ProblemKind::Ignored, message)
        }));
    }
    let (project, adjusted) = project.sanitised();
    problems.extend(adjusted);
    Ok((project, problems))
}

/// Saves a project: writes beside `path`, flushes to disk, then renames, so that a full disk or a crash leaves the old file
/// intact. Paths inside the project's folder become relative to it.
///
/// # Errors
/// If the folder cannot be written, the disk is full, or a path is not Unicode.
pub fn save_project(path: &Path, project: &Project) -> Result<(), ProjectError> {
    let name = path.display();
    let text = text_of_project(path, project).map_err(|error| {
        ProjectError::output(path, format!("{name}: could not be written as text: {error}"))
    })?;
    write_whole(path, format!("{text}\n").as_bytes())
}

/// The text of a project file at `path`.
///
/// # Errors
/// If a path is not Unicode.
pub fn text_of_project(path: &Path, project: &Project) -> Result<String, ron::Error> {
    let folder = folder_of(path);
    let mut project = project.clone();
    project.version = PROJECT_VERSION;
    for file in project.file_refs_mut() {
        *file = file.for_disk(&folder);
    }
    ron::ser::to_string_pretty(&project, ron::ser::PrettyConfig::new().struct_names(false).depth_limit(4))
}

/// The text of a project with its paths as they are in memory, on one line.
///
/// # Errors
/// If a path is not Unicode.
pub(crate) fn text_in_memory(project: &Project) -> Result<String, ron::Error> {
    let options = text_options();
    if project.version == PROJECT_VERSION {
        return options.to_string(project);
    }
    options.to_string(&Project { version: PROJECT_VERSION, ..project.clone() })
}

/// The project of a text that [`text_in_memory`] wrote, of this version or an earlier one. `path` is used for messages only.
///
/// # Errors
/// As [`parse_project`].
pub(crate) fn project_in_memory(path: &Path, text: &str) -> Result<Project, ProjectError> {
    match text_options().from_str::<Project>(text) {
        // Parsed once: a history has a thousand projects.
        Ok(project) if project.version == PROJECT_VERSION => Ok(project.sanitised().0),
        _ => parse_project(path, text).map(|(project, _)| project),
    }
}
