//! Detects the kind of a file by content and name.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use lovelock_groom::{HairFormat, gltf_content};
use lovelock_motion::{FigureContent, figure_content, is_fbx};
use lovelock_project::error::ProjectError;
use lovelock_project::project::PROJECT_EXTENSION;
use lovelock_project::styles::STYLE_EXTENSION;
use lovelock_record::TAKE_EXTENSION;
use lovelock_session::strokes::STROKES_EXTENSION;

/// A kind of readable file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FileKind {
    /// Hair, in one of [`HAIR_FORMATS`](lovelock_groom::HAIR_FORMATS).
    Hair,
    /// A body in glTF 2, VRM, FBX or USD, with or without clips.
    Character,
    /// BVH, VMD, motion of VRM, or a glTF, FBX or USD file that has clips and no body.
    Motion,
    /// A project.
    Project,
    /// A hairstyle as a document of its own.
    Style,
    /// A take.
    Take,
    /// Recorded strokes of brushes.
    Strokes,
    /// A picture of the surroundings: Radiance or `OpenEXR`.
    Surroundings,
    /// A sound: WAV, MP3, Ogg Vorbis or FLAC.
    Sound,
}

/// The kinds of files that can be read, with their extensions, for messages.
fn readable() -> String {
    let kinds = FileKind::ALL.map(|kind| format!("{} (.{})", kind.label(), kind.extensions().join(", .")));
    kinds.join(", ")
}

impl FileKind {
    /// All kinds.
    pub const ALL: [Self; 9] = [
        Self::Hair,
        Self::Character,
        Self::Motion,
        Self::Project,
        Self::Style,
        Self::Take,
        Self::Strokes,
        Self::Surroundings,
        Self::Sound,
    ];

    /// The name in sentences.
    pub fn label(self) -> &'static str {
        match self {
            Self::Hair => "hair",
            Self::Character => "character",
            Self::Motion => "motion",
            Self::Project => "project",
            Self::Style => "style",
            Self::Take => "take",
            Self::Strokes => "strokes",
            Self::Surroundings => "surroundings",
            Self::Sound => "sound",
        }
    }

    /// Endings of such files, for dialogs, without the dot.
    pub fn extensions(self) -> Vec<&'static str> {
        match self {
            Self::Hair => HairFormat::all_extensions(),
            Self::Character => vec!["glb", "gltf", "vrm", "fbx", "usdc", "usda", "usd", "usdz"],
            Self::Motion => vec!["bvh", "vmd", "vrma"],
            Self::Project => vec![PROJECT_EXTENSION, "ron"],
            Self::Style => vec![STYLE_EXTENSION],
            Self::Take => vec![TAKE_EXTENSION],
            Self::Strokes => vec![STROKES_EXTENSION],
            Self::Surroundings => vec!["hdr", "exr"],
            Self::Sound => lovelock_sound::SOUND_EXTENSIONS.to_vec(),
        }
    }

    /// The kind of a file: by its first bytes if they are unambiguous, otherwise by its extension. glTF, FBX and USD files are read for it,
    /// because they may hold hair, a body or motion.
    ///
    /// # Errors
    /// If the file cannot be read, is of an unknown kind (the message lists the readable kinds), or holds none of hair, body and motion.
    pub fn of(path: &Path) -> Result<Self, ProjectError> {
        let name = path.display();
        let cannot_read =
            |error: std::io::Error| ProjectError::input(path, format!("{name}: cannot be read: {error}"));
        let file = File::open(path).map_err(cannot_read)?;
        if file.metadata().map_err(cannot_read)?.is_dir() {
            return Err(ProjectError::input(
                path,
                format!("{name}: is a folder; must be one of {}", readable()),
            ));
        }
        let mut start = Vec::new();
        file.take(4096).read_to_end(&mut start).map_err(cannot_read)?;
        let by_name = Self::by_extension(path);
        // A style is a project with fewer sections, and strokes begin as a project does: only their names tell them apart.
        // Motion of VRM is glTF without a body.
        let kind = match (Self::by_content(&start), by_name) {
            (Some(Self::Project), Some(Self::Style | Self::Strokes))
            | (Some(Self::Character), Some(Self::Motion)) => by_name,
            (by_content, _) => match by_content.or(by_name) {
                Some(kind @ (Self::Character | Self::Hair)) => Some(Self::of_parts(path, &start, kind)?),
                kind => kind,
            },
        };
        kind.ok_or_else(|| {
            let ending = path.extension().map_or_else(
                || "it has no extension".to_owned(),
                |ending| format!("`.{}` is not read", ending.to_string_lossy()),
            );
            ProjectError::input(
                path,
                format!("{name}: found an unknown kind of file: {ending}; must be {}", readable()),
            )
        })
    }

    /// The kind of a file that begins as `kind` does, by what it holds. A file that cannot be read keeps it: its reader says why.
    fn of_parts(path: &Path, start: &[u8], kind: Self) -> Result<Self, ProjectError> {
        let is_stage = start.starts_with(b"PXR-USDC") || start.starts_with(b"#usda");
        // Archives are packages of USD, or of arrays with hair.
        let is_package = start.starts_with(b"PK\x03\x04")
            && path.extension().is_none_or(|ending| !ending.eq_ignore_ascii_case("npz"));
        let holds = if is_stage || is_fbx(start) || is_package {
            figure_content(path).ok().flatten()
        } else if kind == Self::Character {
            gltf_content(path).map(|content| match content {
                // Lines are hair, whatever else the file holds.
                content if content.lines => FigureContent::Curves,
                content if content.triangles => FigureContent::Body,
                content if content.clips > 0 => FigureContent::Clip,
                _ => FigureContent::Nothing,
            })
        } else {
            None
        };
        match holds {
            None => Ok(kind),
            Some(FigureContent::Curves) => Ok(Self::Hair),
            Some(FigureContent::Body) => Ok(Self::Character),
            Some(FigureContent::Clip) => Ok(Self::Motion),
            Some(FigureContent::Nothing) => {
                let hair = if is_fbx(start) { "; hair comes from Alembic, USD or glTF" } else { "" };
                Err(ProjectError::input(
                    path,
                    format!(
                        "{}: found neither hair nor a mesh nor animation; must contain one of them{hair}",
                        path.display()
                    ),
                ))
            }
        }
    }

    /// The kind by file extension.
    pub fn by_extension(path: &Path) -> Option<Self> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        // A glTF file or a package is a character unless it contains lines or curves.
        if ["glb", "gltf", "usdz"].contains(&ending.as_str()) {
            return Some(Self::Character);
        }
        Self::ALL.into_iter().find(|kind| kind.extensions().contains(&ending.as_str()))
    }

    /// The kind by the first bytes of a file, if they are unambiguous.
    fn by_content(start: &[u8]) -> Option<Self> {
        if lovelock_sound::is_sound(start) {
            return Some(Self::Sound);
        }
        match start {
            [b'g', b'l', b'T', b'F', ..] => return Some(Self::Character),
            _ if is_fbx(start) => return Some(Self::Character),
            // The start of every chunk in `record::take`.
            [0x9a, b'L', b'T', b'A', b'K', b'E', ..] => return Some(Self::Take),
            [0x76, 0x2f, 0x31, 0x01, ..] | [b'#', b'?', ..] => return Some(Self::Surroundings),
            _ => {}
        }
        if HairFormat::of_magic(start).is_some() {
            return Some(Self::Hair);
        }
        let text = start.strip_prefix(b"\xef\xbb\xbf").unwrap_or(start).trim_ascii_start();
        let begins = |word: &str| {
            text.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word.as_bytes()))
        };
        let holds = |word: &[u8]| text.windows(word.len()).any(|window| window == word);
        if begins("HIERARCHY") || start.starts_with(b"Vocaloid Motion Data") {
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
