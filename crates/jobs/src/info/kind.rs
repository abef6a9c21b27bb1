//! What kind of file it is, by content and by name.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use lovelock_project::error::StudioError;
use lovelock_project::project::PROJECT_EXTENSION;
use lovelock_record::TAKE_EXTENSION;

/// A kind of file that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FileKind {
    /// Yuksel `.hair`, TressFX `.tfx`, curves of USD.
    Hair,
    /// glTF 2: `.glb`, `.gltf`.
    Character,
    /// BVH.
    Motion,
    /// A project.
    Project,
    /// A take.
    Take,
}

/// What is read, for messages.
const READ: &str = "hair (.hair, .tfx, .usd, .usda, .usdc), characters (.glb, .gltf), motion (.bvh), projects (.lovelock) and takes \
                    (.take)";

impl FileKind {
    /// All kinds.
    pub const ALL: [Self; 5] = [Self::Hair, Self::Character, Self::Motion, Self::Project, Self::Take];

    /// The name in sentences.
    pub fn label(self) -> &'static str {
        match self {
            Self::Hair => "hair",
            Self::Character => "character",
            Self::Motion => "motion",
            Self::Project => "project",
            Self::Take => "take",
        }
    }

    /// Endings of such files, for dialogs, without the dot.
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Hair => &["hair", "tfx", "usdc", "usda", "usd"],
            Self::Character => &["glb", "gltf"],
            Self::Motion => &["bvh"],
            Self::Project => &[PROJECT_EXTENSION, "ron"],
            Self::Take => &[TAKE_EXTENSION],
        }
    }

    /// The kind of a file: by its first bytes where they leave no doubt, else by its ending.
    ///
    /// # Errors
    /// Where it cannot be read, and for a file of no kind that is read, with what is.
    pub fn of(path: &Path) -> Result<Self, StudioError> {
        let name = path.display();
        let cannot_read =
            |error: std::io::Error| StudioError::input(path, format!("{name}: cannot be read: {error}"));
        let file = File::open(path).map_err(cannot_read)?;
        if file.metadata().map_err(cannot_read)?.is_dir() {
            return Err(StudioError::input(path, format!("{name}: is a folder; wanted a file: {READ}")));
        }
        let mut start = Vec::new();
        file.take(4096).read_to_end(&mut start).map_err(cannot_read)?;
        let by_name = Self::by_extension(path);
        Self::by_content(&start).or(by_name).ok_or_else(|| {
            let ending = path.extension().map_or_else(
                || "it has no ending".to_owned(),
                |ending| format!("`.{}` is not read", ending.to_string_lossy()),
            );
            StudioError::input(
                path,
                format!("{name}: not a file that is known here: {ending}; wanted {READ}"),
            )
        })
    }

    /// The kind that the ending of a name says.
    pub fn by_extension(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        Self::ALL.into_iter().find(|kind| kind.extensions().contains(&ending.as_str()))
    }

    /// The kind that the first bytes of a file leave no doubt of.
    fn by_content(start: &[u8]) -> Option<Self> {
        match start {
            [b'H', b'A', b'I', b'R', ..] => return Some(Self::Hair),
            [b'P', b'X', b'R', b'-', b'U', b'S', b'D', b'C', ..] | [b'#', b'u', b's', b'd', b'a', ..] => {
                return Some(Self::Hair);
            }
            [b'g', b'l', b'T', b'F', ..] => return Some(Self::Character),
            // As `record::take` begins every chunk.
            [0x9a, b'L', b'T', b'A', b'K', b'E', ..] => return Some(Self::Take),
            _ => {}
        }
        let text = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start).trim_ascii_start();
        let begins = |word: &str| {
            text.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word.as_bytes()))
        };
        let holds = |word: &[u8]| text.windows(word.len()).any(|window| window == word);
        if begins("HIERARCHY") {
            Some(Self::Motion)
        } else if begins("{") && holds(b"\"asset\"") {
            Some(Self::Character)
        } else if begins("(") && holds(b"version") {
            Some(Self::Project)
        } else {
            None
        }
    }
}
