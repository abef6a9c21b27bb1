//! What a path is asked for.

use std::path::Path;

use lovelock_brush::StrokeFile;
use lovelock_jobs::info::FileKind;
use lovelock_project::project::PROJECT_EXTENSION;
use lovelock_project::styles::STYLE_EXTENSION;
use lovelock_record::CurveFormat;

/// What a path is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// Opening any file that the program reads.
    Open,
    /// Comparing with a take.
    Beside,
    /// The body, from a character file.
    Body,
    /// The motion, from a motion file or from a character's clip.
    Motion,
    /// Light from a picture of the surroundings.
    Surroundings,
    /// A picture behind the figure.
    Backdrop,
    /// A picture to compare with the image.
    Reference,
    /// A sound for the dance.
    Sound,
    /// Saving the project.
    SaveProject,
    /// Recording a film.
    Film,
    /// Recording a folder of images.
    Sequence,
    /// Recording an animated preview.
    Preview,
    /// Continuing a folder of images.
    Resume,
    /// Exporting hair and body for other programs.
    Curves,
    /// Exporting a style.
    ExportStyle,
    /// Saving the strokes of brushes.
    SaveStrokes,
    /// Saving the image in the viewport.
    Picture,
    /// Writing the report of a comparison to a folder.
    Report,
}

/// What happens to an existing file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Replaces {
    /// There is none, or it is only read, or it is the file that is saved again.
    Nothing,
    /// It can be made again, so a line says that it is replaced.
    Tells,
    /// It holds work, so the user is asked.
    Asks,
}

impl Purpose {
    pub(super) fn title(self) -> &'static str {
        match self {
            Self::Open => "Open a project, take, hairstyle, character, motion, surroundings or sound",
            Self::Beside => "Compare with a take",
            Self::Body => "Body from a character file",
            Self::Motion => "Motion from a motion file, or from a clip of another character",
            Self::Surroundings => "Light from a picture of the surroundings: .hdr or .exr",
            Self::Backdrop => "Picture behind the figure: PNG, JPEG, .hdr or .exr",
            Self::Reference => "Reference picture over the image: PNG, JPEG, .hdr or .exr",
            Self::Sound => "Sound for the dance: WAV, MP3, Ogg Vorbis or FLAC",
            Self::SaveProject => "Save the project",
            Self::Film => "Record a film",
            Self::Sequence => "Record images to a folder",
            Self::Preview => "Record an animated preview",
            Self::Resume => "Resume the images in a folder",
            Self::Curves => "Export curves: .usdc, .usda, .abc or .glb",
            Self::ExportStyle => "Export the style",
            Self::SaveStrokes => "Save the brush strokes",
            Self::Picture => "Save the image",
            Self::Report => "Export the report to a folder",
        }
    }

    pub(super) fn button(self) -> &'static str {
        match self {
            Self::Open
            | Self::Body
            | Self::Motion
            | Self::Surroundings
            | Self::Backdrop
            | Self::Reference
            | Self::Sound => "Open file",
            Self::Beside => "Compare",
            Self::SaveProject | Self::Picture | Self::Curves | Self::ExportStyle | Self::SaveStrokes => {
                "Save file"
            }
            Self::Film | Self::Sequence | Self::Preview => "Start recording",
            Self::Resume => "Resume recording",
            Self::Report => "Export report",
        }
    }

    /// Whether an existing file is read.
    pub(super) fn opens(self) -> bool {
        matches!(
            self,
            Self::Open
                | Self::Beside
                | Self::Body
                | Self::Motion
                | Self::Surroundings
                | Self::Backdrop
                | Self::Reference
                | Self::Sound
        )
    }

    /// Whether the path is that of a folder.
    pub(super) fn is_folder(self) -> bool {
        matches!(self, Self::Sequence | Self::Resume | Self::Report)
    }

    /// The extension that is added if none is given.
    pub(super) fn extension(self) -> Option<&'static str> {
        match self {
            Self::Open
            | Self::Beside
            | Self::Body
            | Self::Motion
            | Self::Surroundings
            | Self::Backdrop
            | Self::Reference
            | Self::Sound
            | Self::Sequence
            | Self::Resume
            | Self::Report => None,
            Self::SaveProject => Some(PROJECT_EXTENSION),
            Self::Film => Some("mp4"),
            Self::Preview => Some("apng"),
            Self::Curves => Some("usdc"),
            Self::ExportStyle => Some(STYLE_EXTENSION),
            Self::SaveStrokes => Some(StrokeFile::EXTENSION),
            Self::Picture => Some("png"),
        }
    }

    /// The name of its files in the system's dialog, and their extensions; none for folders.
    pub(super) fn files(self) -> (&'static str, Vec<&'static str>) {
        match self {
            // The extension `part` is that of an unfinished take.
            Self::Open => {
                let kinds = FileKind::ALL.into_iter().flat_map(FileKind::extensions);
                ("Lovelock reads", kinds.chain(["part"]).collect())
            }
            Self::Beside => ("Take or curves", vec!["take", "part", "abc", "usdc", "usd", "usda"]),
            Self::Body => ("Character", FileKind::Character.extensions()),
            Self::Motion => {
                let kinds = [FileKind::Motion, FileKind::Character];
                ("Motion", kinds.into_iter().flat_map(FileKind::extensions).collect())
            }
            Self::Surroundings => ("Surroundings", FileKind::Surroundings.extensions()),
            Self::Backdrop | Self::Reference => ("Picture", vec!["png", "jpg", "jpeg", "hdr", "exr"]),
            Self::Sound => ("Sound", FileKind::Sound.extensions()),
            Self::Sequence | Self::Resume | Self::Report => ("Folder", Vec::new()),
            Self::SaveProject => ("Project", vec![PROJECT_EXTENSION]),
            Self::Film => ("Film", vec!["mp4"]),
            Self::Preview => ("Preview", vec!["apng"]),
            Self::Curves => ("Curves", CurveFormat::EXTENSIONS.to_vec()),
            Self::ExportStyle => ("Style", vec![STYLE_EXTENSION]),
            Self::SaveStrokes => ("Strokes", vec![StrokeFile::EXTENSION]),
            Self::Picture => ("Picture", vec!["png"]),
        }
    }

    /// Whether a file has one of its extensions.
    pub(super) fn lists(self, path: &Path) -> bool {
        let extension = path.extension().unwrap_or_default();
        self.files().1.iter().any(|known| extension.eq_ignore_ascii_case(known))
    }

    /// What happens to the file at `path`; `own` is the file of the project.
    pub(super) fn replaces(self, path: &Path, own: Option<&Path>) -> Replaces {
        match self {
            _ if self.opens() || self == Self::Resume => Replaces::Nothing,
            Self::Sequence if path.join(lovelock_record::MANIFEST_NAME).exists() => Replaces::Tells,
            Self::Sequence => Replaces::Nothing,
            Self::Report if !path.join("report.json").exists() => Replaces::Nothing,
            _ if !path.exists() => Replaces::Nothing,
            Self::SaveProject if own.is_some_and(|own| is_same(own, path)) => Replaces::Nothing,
            Self::SaveProject | Self::ExportStyle | Self::SaveStrokes => Replaces::Asks,
            _ => Replaces::Tells,
        }
    }

    /// The kind of file that is replaced, in sentences.
    pub(super) fn replaced(self) -> &'static str {
        match self {
            Self::SaveProject => "project",
            Self::ExportStyle => "style",
            Self::SaveStrokes => "strokes",
            Self::Film => "film",
            Self::Sequence => "images",
            Self::Preview => "preview",
            Self::Picture => "image",
            Self::Report => "report",
            _ => "file",
        }
    }
}

/// Whether both paths are those of one file.
fn is_same(a: &Path, b: &Path) -> bool {
    a == b || a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
}
