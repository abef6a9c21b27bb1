//! Errors of glTF files.

/// The extension for meshes compressed with Draco.
pub const DRACO: &str = "KHR_draco_mesh_compression";

/// Why a file was refused.
#[derive(Debug, thiserror::Error)]
pub enum GltfError {
    /// The operating system could not read the file or one of its buffers.
    #[error("{file}: cannot be read: {source}")]
    Read {
        /// The file as the user named it, with the buffer.
        file: String,
        /// The system's error.
        source: std::io::Error,
    },
    /// The content contradicts itself or the format.
    #[error("{file}: {place}: found {found}; must be {wanted}")]
    Malformed {
        /// The file as the user named it.
        file: String,
        /// The position in the file in bytes, 0 if it is not known.
        offset: u64,
        /// The element, such as `accessor 3`.
        place: String,
        /// What was found there.
        found: String,
        /// What would be valid.
        wanted: String,
    },
    /// The file needs an extension that is not supported.
    #[error("{file}: needs the glTF extension {extension}, which is not supported; {advice}")]
    Extension {
        /// The file as the user named it.
        file: String,
        /// Name of the extension.
        extension: String,
        /// How to fix it.
        advice: &'static str,
    },
    /// The file refers to data outside its own folder.
    #[error("{file}: refers to `{uri}`; only files in its own folder and its subfolders are read")]
    Outside {
        /// The file as the user named it.
        file: String,
        /// The reference as written in the file.
        uri: String,
    },
}

impl GltfError {
    /// The file at fault as the user named it.
    pub fn file(&self) -> &str {
        match self {
            Self::Read { file, .. }
            | Self::Malformed { file, .. }
            | Self::Extension { file, .. }
            | Self::Outside { file, .. } => file,
        }
    }

    pub(crate) fn malformed(
        file: &str,
        place: impl Into<String>,
        found: impl Into<String>,
        wanted: impl Into<String>,
    ) -> Self {
        Self::Malformed {
            file: file.to_owned(),
            offset: 0,
            place: place.into(),
            found: found.into(),
            wanted: wanted.into(),
        }
    }

    /// The error for an extension that is not supported, with advice.
    pub fn extension(file: &str, extension: &str) -> Self {
        let advice = if extension == DRACO {
            "export it again without Draco compression"
        } else if extension.ends_with("_meshopt_compression") {
            "export it again without meshopt compression (gltfpack: leave out -c and -cc)"
        } else {
            "export it again without that extension"
        };
        Self::Extension { file: file.to_owned(), extension: extension.to_owned(), advice }
    }

    /// The same error with its position in the file, in bytes.
    pub(crate) fn at(mut self, position: u64) -> Self {
        if let Self::Malformed { offset, .. } = &mut self {
            *offset = position;
        }
        self
    }
}
