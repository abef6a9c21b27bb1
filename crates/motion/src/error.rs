//! What can be wrong with a character, a motion, or the pair of them.

use std::path::Path;

/// Why a character or a motion was refused. Every message names the file, what was found and what would be right.
#[derive(Debug, thiserror::Error)]
pub enum MotionError {
    /// The operating system refused the file.
    #[error("{file}: cannot be read: {source}")]
    Read {
        /// The file as the user named it.
        file: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// The bytes are not what the format says.
    #[error("{file}: {place}: {problem}")]
    Malformed {
        /// The file as the user named it.
        file: String,
        /// The byte, line or element, such as `accessor 3`.
        place: String,
        /// What was found and what was wanted.
        problem: String,
    },
    /// The file needs an extension of glTF that is not read here.
    #[error("{file}: needs the glTF extension {extension}, which is not read here; {advice}")]
    Extension {
        /// The file as the user named it.
        file: String,
        /// Name of the extension.
        extension: String,
        /// What to do about it.
        advice: &'static str,
    },
    /// The file asks for data outside its own folder.
    #[error("{file}: refers to `{uri}`; only files in its own folder and below it are read")]
    Outside {
        /// The file as the user named it.
        file: String,
        /// The reference as it stands in the file.
        uri: String,
    },
    /// The file is well formed and holds nothing of use.
    #[error("{file}: holds {found}; wanted {wanted}")]
    Empty {
        /// The file as the user named it.
        file: String,
        /// What it holds.
        found: String,
        /// What would be useful.
        wanted: &'static str,
    },
    /// Two skeletons have too little in common.
    #[error("{motion} cannot move {body}: {problem}")]
    Retarget {
        /// Name of the motion.
        motion: String,
        /// Name of the body.
        body: String,
        /// Which joints are missing on which side.
        problem: String,
    },
}

impl MotionError {
    /// The file at fault as the user named it (for a pair, the motion).
    pub fn file(&self) -> &str {
        match self {
            Self::Read { file, .. }
            | Self::Malformed { file, .. }
            | Self::Extension { file, .. }
            | Self::Outside { file, .. }
            | Self::Empty { file, .. } => file,
            Self::Retarget { motion, .. } => motion,
        }
    }

    pub(crate) fn malformed(file: &str, place: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Malformed { file: file.to_owned(), place: place.into(), problem: problem.into() }
    }
}

/// Reads a whole file, refusing those of more than `limit` bytes before any of it is in memory.
pub(crate) fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>, MotionError> {
    let file = path.display().to_string();
    let read = |source| MotionError::Read { file: file.clone(), source };
    let data = std::fs::metadata(path).map_err(read)?;
    if data.is_dir() {
        return Err(MotionError::malformed(&file, "the path", "is a folder; wanted a file"));
    }
    if data.len() > limit {
        let problem = format!("{} bytes; files of at most {limit} bytes are read", data.len());
        return Err(MotionError::malformed(&file, "the file", problem));
    }
    std::fs::read(path).map_err(read)
}
