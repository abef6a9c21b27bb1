//! `lovelock info`: describes the contents of a file.

mod character_text;
mod kind;
mod lines;
mod sound;
mod strokes;
mod style;
mod surroundings;
mod take;
mod text;

pub use kind::FileKind;
pub use sound::SoundInfo;
pub use strokes::StrokesInfo;
pub use style::StyleInfo;
pub use surroundings::SurroundingsInfo;
pub use take::{RegrownInfo, TakeInfo};

use std::collections::BTreeMap;
use std::path::Path;

use lovelock_groom::{CurveMotion, HairInfo, ImportSettings, hair_info, load_hair};
use lovelock_motion::{CharacterInfo, MotionInfo, load_character, load_motion};
use lovelock_project::error::ProjectError;
use lovelock_project::project::{HairSource, MotionSource, PROJECT_VERSION, load_project};
use serde::Serialize;

use crate::satf::DatabaseInfo;

/// Contents of a file, as `info --json` prints them; displays as text for people.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Info {
    /// The file name as given.
    pub file: String,
    /// Its kind and details.
    #[serde(flatten)]
    pub content: Content,
}

/// Kind and details of a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Content {
    /// A hairstyle.
    Hair(HairInfo),
    /// A body, with or without clips.
    Character(CharacterInfo),
    /// A motion.
    Motion(MotionInfo),
    /// A project.
    Project(ProjectInfo),
    /// A hairstyle as a document of its own.
    Style(StyleInfo),
    /// A recorded simulation.
    Take(TakeInfo),
    /// Recorded strokes of brushes.
    Strokes(StrokesInfo),
    /// A picture of the surroundings.
    Surroundings(SurroundingsInfo),
    /// A sound.
    Sound(SoundInfo),
    /// A database of hair clusters.
    HairClusters(DatabaseInfo),
}

/// Description of a project file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProjectInfo {
    /// Its format.
    pub format: String,
    /// Unknown fields with counts.
    pub dropped: BTreeMap<String, u64>,
    /// Problems: missing files, values out of range, unknown fields.
    pub notes: Vec<String>,
    /// The body: `dancer`, or a file.
    pub body: String,
    /// The motion: a clip's name, a file, or `rest`.
    pub motion: String,
    /// The hairstyle: a style's id, or a file.
    pub hair: String,
    /// The picture of the surroundings, or `null`.
    pub surroundings: Option<String>,
    /// The sound of the dance, or `null`.
    pub sound: Option<String>,
    /// Id of the shadow method.
    pub shadow: String,
    /// Number of lights.
    pub lights: usize,
    /// Width of a recording, pixels.
    pub width: u32,
    /// Height of a recording, pixels.
    pub height: u32,
    /// Frames per second of a recording.
    pub fps: f64,
    /// Files that it refers to and uses.
    pub files: Vec<String>,
}

/// Describes a hair, character, motion, project, style or take file, recorded strokes, a picture of the surroundings, a sound, or a database
/// of hair clusters.
///
/// # Errors
/// Exit status 2 with one line if the file is missing, broken, or of an unknown kind.
pub fn info(path: &Path) -> Result<Info, ProjectError> {
    info_as(path, &ImportSettings::default())
}

/// As [`info`], with hair in the unit and axes of `import`.
///
/// # Errors
/// As [`info`], and for a unit or an axis of a file that is not hair.
pub fn info_as(path: &Path, import: &ImportSettings) -> Result<Info, ProjectError> {
    let refuse = |error: &dyn std::fmt::Display| ProjectError::input(path, error);
    if let Some(database) = DatabaseInfo::of(path)? {
        let file = path.display().to_string();
        return Ok(Info { file, content: Content::HairClusters(database) });
    }
    let kind = FileKind::of(path)?;
    if kind != FileKind::Hair && *import != ImportSettings::default() {
        let (name, found) = (path.display(), kind.label());
        return Err(ProjectError::option(format!(
            "--unit, --up: found the {found} file {name}; must be hair"
        )));
    }
    let content = match kind {
        FileKind::Hair => {
            let mut file = load_hair(path).map_err(|error| refuse(&error))?;
            match CurveMotion::of(path) {
                CurveMotion::Moving(times) => {
                    file.notes.push(format!("The curves move: {times} times, which play like a take."));
                }
                motion => file.notes.extend(motion.problem()),
            }
            Content::Hair(hair_info(&file, import))
        }
        FileKind::Character => {
            Content::Character(load_character(path).map_err(|error| refuse(&error))?.info())
        }
        FileKind::Motion => Content::Motion(load_motion(path).map_err(|error| refuse(&error))?.info()),
        FileKind::Project => Content::Project(project_info(path)?),
        FileKind::Style => Content::Style(StyleInfo::of(path)?),
        FileKind::Take => Content::Take(TakeInfo::of(path)?),
        FileKind::Strokes => Content::Strokes(StrokesInfo::of(path)?),
        FileKind::Surroundings => Content::Surroundings(SurroundingsInfo::of(path)?),
        FileKind::Sound => Content::Sound(SoundInfo::of(path)?),
    };
    Ok(Info { file: path.display().to_string(), content })
}

fn project_info(path: &Path) -> Result<ProjectInfo, ProjectError> {
    let (project, problems) = load_project(path)?;
    let name = |file: &Option<lovelock_project::files::FileRef>| {
        file.as_ref()
            .map_or_else(|| "a file that is not set".to_owned(), |file| file.path.display().to_string())
    };
    let ignored =
        problems.iter().filter(|p| p.kind == lovelock_project::error::ProblemKind::Ignored).count() as u64;
    let dropped =
        if ignored > 0 { BTreeMap::from([("unknown_fields".to_owned(), ignored)]) } else { BTreeMap::new() };
    Ok(ProjectInfo {
        format: format!("Lovelock project {PROJECT_VERSION}"),
        dropped,
        notes: problems.iter().map(ToString::to_string).collect(),
        body: project.body.source.name().map_or_else(|| name(&project.body.file), ToOwned::to_owned),
        motion: match project.motion.source {
            MotionSource::Clip => project.motion.clip.clone(),
            MotionSource::File => name(&project.motion.file),
            MotionSource::Rest => "rest".to_owned(),
        },
        hair: match project.hair.source {
            HairSource::Grown if !project.hair.style.is_empty() => project.hair.style.clone(),
            HairSource::Grown => project.hair.preset.id().to_owned(),
            HairSource::File => name(&project.hair.file),
        },
        surroundings: project.surroundings.file.as_ref().map(|file| file.path.display().to_string()),
        sound: project.sound.file.as_ref().map(|file| file.path.display().to_string()),
        shadow: project.shadow.method.to_string(),
        lights: project.lights.len(),
        width: project.recording.width,
        height: project.recording.height,
        fps: project.recording.fps,
        files: project.files().iter().map(|(_, file)| file.path.display().to_string()).collect(),
    })
}

#[cfg(test)]
mod tests;
