//! Errors of characters, motions, and pairs of them.

use std::path::Path;

use lovelock_gltf::GltfError;

/// Why a character or a motion was refused. Every message contains the file, what was found and what is
/// valid.
#[derive(Debug, thiserror::Error)]
pub enum MotionError {
    /// The operating system could not read the file.
    #[error("{file}: cannot be read: {source}")]
    Read {
        /// The file as the user named it.
        file: String,
        /// The system's error.
        source: std::io::Error,
    },
    /// The content does not conform to the format.
    #[error("{file}: {place}: {problem}")]
    Malformed {
        /// The file as the user named it.
        file: String,
        /// The byte, line or element, such as `accessor 3`.
        place: String,
        /// What was found and what was expected.
        problem: String,
    },
    /// What is wrong with a glTF file as such.
    #[error(transparent)]
    Gltf(#[from] GltfError),
    /// The file is well formed but contains nothing usable.
    #[error("{file}: contains {found}; must contain {wanted}")]
    Empty {
        /// The file as the user named it.
        file: String,
        /// What it contains.
        found: String,
        /// What was expected.
        wanted: &'static str,
    },
    /// The skeletons of motion and body do not correspond.
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
            Self::Read { file, .. } | Self::Malformed { file, .. } | Self::Empty { file, .. } => file,
            Self::Gltf(error) => error.file(),
            Self::Retarget { motion, .. } => motion,
        }
    }

    pub(crate) fn malformed(file: &str, place: impl Into<String>, problem: impl Into<String>) -> Self {
        Self::Malformed { file: file.to_owned(), place: place.into(), problem: problem.into() }
    }
}

/// Reads a whole file. Files larger than `limit` bytes are refused before they are loaded into memory.
pub(crate) fn read_file(path: &Path, limit: u64) -> Result<Vec<u8>, MotionError> {
    let file = path.display().to_string();
    let read = |source| MotionError::Read { file: file.clone(), source };
    let data = std::fs::metadata(path).map_err(read)?;
    if data.is_dir() {
        return Err(MotionError::malformed(&file, "the path", "is a folder; must be a file"));
    }
    if data.len() > limit {
        let problem = format!("{} bytes; must be at most {limit} bytes", data.len());
        return Err(MotionError::malformed(&file, "the file", problem));
    }
    std::fs::read(path).map_err(read)
}
