//! Errors that stop a request, and problems that do not.

use std::fmt;
use std::path::{Path, PathBuf};

use lovelock_base::Failure;
use serde::{Deserialize, Serialize};

/// Why a request failed. Displays as one line that names the file or the option.
#[derive(Debug, thiserror::Error)]
pub enum ProjectError {
    /// The request or an input file is wrong.
    #[error("{message}")]
    Request {
        /// The file that is wrong, if it is a file.
        file: Option<PathBuf>,
        /// What was found and what is valid.
        message: String,
    },
    /// The request was valid but the work failed, for example because the disk is full or there is no graphics device.
    #[error("{message}")]
    Work {
        /// The file that was being written or read, if there is one.
        file: Option<PathBuf>,
        /// What happened.
        message: String,
    },
    /// The work was cancelled.
    #[error("cancelled: nothing was left under the final name")]
    Cancelled,
}

impl ProjectError {
    /// An invalid input file; `message` names the file.
    pub fn input(file: &Path, message: impl fmt::Display) -> Self {
        Self::Request { file: Some(file.to_owned()), message: message.to_string() }
    }

    /// An invalid option.
    pub fn option(message: impl fmt::Display) -> Self {
        Self::Request { file: None, message: message.to_string() }
    }

    /// Work that failed on a file; `message` names the file.
    pub fn output(file: &Path, message: impl fmt::Display) -> Self {
        Self::Work { file: Some(file.to_owned()), message: message.to_string() }
    }

    /// Work that failed.
    pub fn work(message: impl fmt::Display) -> Self {
        Self::Work { file: None, message: message.to_string() }
    }

    /// The exit status of the command line: 2 for a wrong request or input file, 1 for work that failed.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Request { .. } => 2,
            Self::Work { .. } | Self::Cancelled => 1,
        }
    }

    /// The file that caused the error.
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::Request { file, .. } | Self::Work { file, .. } => file.as_deref(),
            Self::Cancelled => None,
        }
    }

    /// What `--json` prints: `{"error": {"message": …, "file": … or null}}`.
    pub fn to_json(&self) -> serde_json::Value {
        let file = self.file().map(|f| f.display().to_string());
        serde_json::json!({ "error": { "message": self.to_string(), "file": file } })
    }
}

impl<E: Failure> From<E> for ProjectError {
    fn from(error: E) -> Self {
        let (file, message) = (error.file().map(Path::to_owned), error.to_string());
        if error.is_request() { Self::Request { file, message } } else { Self::Work { file, message } }
    }
}

/// The part of a project that a problem belongs to. The interface shows the problem there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Place {
    /// The project file as a whole.
    Project,
    /// The body.
    Body,
    /// The motion.
    Motion,
    /// The hairstyle.
    Hair,
    /// Colour and width of the hair.
    Look,
    /// The simulation.
    Simulation,
    /// The shadow.
    Shadow,
    /// The lights.
    Lights,
    /// The picture of the surroundings.
    Surroundings,
    /// The picture behind the figure.
    Backdrop,
    /// The picture that is compared with the image.
    Reference,
    /// The sound of the dance.
    Sound,
    /// The camera.
    Camera,
    /// Settings of the picture.
    Picture,
    /// The recording.
    Recording,
    /// The comparison.
    Compare,
    /// The take that is played.
    Take,
    /// The timeline: markers and tracks.
    Timeline,
}

impl Place {
    /// The option of the command line that names a file for this part.
    pub fn option(self) -> Option<&'static str> {
        match self {
            Self::Body => Some("--body"),
            Self::Motion => Some("--motion"),
            Self::Hair => Some("--hair"),
            Self::Surroundings => Some("--surroundings"),
            Self::Backdrop => Some("--background"),
            Self::Sound => Some("--sound"),
            Self::Compare => Some("--beside"),
            _ => None,
        }
    }

    /// The name in sentences.
    pub fn label(self) -> &'static str {
        match self {
            Self::Project => "project",
            Self::Body => "body",
            Self::Motion => "motion",
            Self::Hair => "hair",
            Self::Look => "look",
            Self::Simulation => "simulation",
            Self::Shadow => "shadow",
            Self::Lights => "lights",
            Self::Surroundings => "surroundings",
            Self::Backdrop => "background picture",
            Self::Reference => "reference picture",
            Self::Sound => "sound",
            Self::Camera => "camera",
            Self::Picture => "picture",
            Self::Recording => "recording",
            Self::Compare => "comparison",
            Self::Take => "take",
            Self::Timeline => "timeline",
        }
    }
}

/// The kind of problem, which decides what the interface offers to do about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ProblemKind {
    /// A value was out of range and has been clamped.
    Adjusted,
    /// Something in the file is unknown and was ignored.
    Ignored,
    /// A file could not be loaded; the previous state is kept.
    NotLoaded,
    /// The project names a file outside its folder that the user has not picked: picking it lets it load.
    NeedsPermission(PathBuf),
    /// Loaded; the message is for information.
    Note,
}

/// Something that could not be done as requested. The scene stays usable.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// The part of the project.
    pub place: Place,
    /// What kind of problem.
    pub kind: ProblemKind,
    /// What happened, in one sentence.
    pub cause: String,
    /// The cause, and what was done instead.
    pub message: String,
}

impl Problem {
    /// A problem.
    pub fn new(place: Place, kind: ProblemKind, message: impl fmt::Display) -> Self {
        let cause = message.to_string();
        Self { place, kind, message: cause.clone(), cause }
    }

    /// A file that could not be loaded.
    pub fn not_loaded(place: Place, message: impl fmt::Display) -> Self {
        Self::new(place, ProblemKind::NotLoaded, message)
    }

    /// The problem with the fallback that was used, if a part of the scene could not be loaded.
    pub fn with_fallback(mut self, instead: &str) -> Self {
        if matches!(self.kind, ProblemKind::NotLoaded | ProblemKind::NeedsPermission(_))
            && self.place != Place::Project
        {
            self.message = format!("{}; {instead}", self.message);
        }
        self
    }

    /// Whether a part of the scene is missing because of this problem.
    pub fn is_failure(&self) -> bool {
        matches!(self.kind, ProblemKind::NotLoaded | ProblemKind::NeedsPermission(_))
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.place.label(), self.message)
    }
}

#[cfg(test)]
mod tests {
    use lovelock_record::TakeError;

    use super::*;

    #[test]
    fn errors_of_other_crates_keep_their_kind_and_their_file() {
        let size = ProjectError::from(lovelock_picture::check_size(0, 1).expect_err("refused"));
        assert_eq!((size.exit_code(), size.file()), (2, None));
        assert!(size.to_string().contains("0x1"), "{size}");
        let path = PathBuf::from("dance.take");
        let busy = ProjectError::from(TakeError::Busy { path: path.clone() });
        assert_eq!((busy.exit_code(), busy.file()), (2, Some(path.as_path())));
        let lost = ProjectError::from(TakeError::Stopped { path: path.clone(), kept: 0 });
        assert_eq!((lost.exit_code(), lost.file()), (1, Some(path.as_path())), "control: work that failed");
    }
}
