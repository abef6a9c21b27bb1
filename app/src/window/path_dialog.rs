//! The dialog for a path: a text field, and the system's own dialog if there is one.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};

use egui::{Modal, RichText};
use lovelock_base::clock::Stopwatch;
use lovelock_brush::StrokeFile;
use lovelock_jobs::info::FileKind;
use lovelock_project::project::PROJECT_EXTENSION;
use lovelock_project::styles::STYLE_EXTENSION;

use super::theme;

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
    /// A sound beside the dance.
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
}

/// Extensions of the files that can be opened, for the system's dialog; `part` is that of an unfinished take.
fn readable() -> Vec<&'static str> {
    FileKind::ALL.into_iter().flat_map(FileKind::extensions).chain(["part"]).collect()
}

/// A dialog that returns sooner than this without a path was never shown, seconds: no user closes a dialog so quickly, and the
/// system's answer is the same in both cases.
const NO_DIALOG_SECS: f64 = 0.5;

impl Purpose {
    fn title(self) -> &'static str {
        match self {
            Self::Open => "Open a project, take, hairstyle, character, motion, surroundings or sound",
            Self::Beside => "Compare with a take",
            Self::Body => "Body from a character file",
            Self::Motion => "Motion from a motion file, or from a clip of another character",
            Self::Surroundings => "Light from a picture of the surroundings: .hdr or .exr",
            Self::Sound => "Sound beside the dance: WAV, MP3, Ogg Vorbis or FLAC",
            Self::SaveProject => "Save the project",
            Self::Film => "Record a film",
            Self::Sequence => "Record images to a folder",
            Self::Preview => "Record an animated preview",
            Self::Resume => "Resume the images in a folder",
            Self::Curves => "Export curves: .usdc, .usda, .abc or .glb",
            Self::ExportStyle => "Export the style",
            Self::SaveStrokes => "Save the strokes of the brushes",
            Self::Picture => "Save the image",
        }
    }

    fn button(self) -> &'static str {
        match self {
            Self::Open | Self::Body | Self::Motion | Self::Surroundings | Self::Sound => "Open file",
            Self::Beside => "Compare",
            Self::SaveProject | Self::Picture | Self::Curves | Self::ExportStyle | Self::SaveStrokes => {
                "Save file"
            }
            Self::Film | Self::Sequence | Self::Preview => "Start recording",
            Self::Resume => "Resume recording",
        }
    }

    /// The extension that is added if none is given.
    fn extension(self) -> Option<&'static str> {
        match self {
            Self::Open
            | Self::Beside
            | Self::Body
            | Self::Motion
            | Self::Surroundings
            | Self::Sound
            | Self::Sequence
            | Self::Resume => None,
            Self::SaveProject => Some(PROJECT_EXTENSION),
            Self::Film => Some("mp4"),
            Self::Preview => Some("apng"),
            Self::Curves => Some("usdc"),
            Self::ExportStyle => Some(STYLE_EXTENSION),
            Self::SaveStrokes => Some(StrokeFile::EXTENSION),
            Self::Picture => Some("png"),
        }
    }
}

/// An open dialog for a path.
#[derive(Debug)]
pub(crate) struct PathDialog {
    purpose: Purpose,
    typed: String,
    /// Describes the file that will be written.
    about: Option<String>,
    /// The answer of the system's dialog, and when it was opened.
    browsed: Option<(Receiver<Option<PathBuf>>, Stopwatch)>,
    /// Whether the system appears to have no dialog.
    no_dialog: bool,
}

/// The state of the dialog after a pass.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    /// It is still open.
    Pending,
    /// It was closed without a path.
    Closed,
    /// This path was chosen.
    Path(Purpose, PathBuf),
}

impl PathDialog {
    /// Opens the dialog with `suggestion` in the field.
    pub(crate) fn new(purpose: Purpose, suggestion: &Path) -> Self {
        let typed = suggestion.display().to_string();
        Self { purpose, typed, about: None, browsed: None, no_dialog: false }
    }

    /// Adds a line that describes the file that will be written.
    pub(crate) fn about(self, text: String) -> Self {
        Self { about: Some(text), ..self }
    }

    /// Shows the dialog.
    pub(crate) fn show(&mut self, ctx: &egui::Context) -> Answer {
        if let Some((receiver, since)) = &self.browsed {
            match receiver.try_recv() {
                Ok(Some(path)) => return Answer::Path(self.purpose, path),
                Ok(None) | Err(TryRecvError::Disconnected) => {
                    self.no_dialog = since.secs() < NO_DIALOG_SECS;
                    self.browsed = None;
                }
                Err(TryRecvError::Empty) => {}
            }
        }
        let mut answer = Answer::Pending;
        let response = Modal::new(egui::Id::unique("path")).show(ctx, |ui| {
            ui.set_width(520.0);
            ui.heading(self.purpose.title());
            let field = ui.horizontal(|ui| {
                let label = ui.label("Path");
                let edit = egui::TextEdit::singleline(&mut self.typed).desired_width(380.0);
                let field = ui.add(edit).labelled_by(label.id);
                let browse = ui.add_enabled(self.browsed.is_none(), egui::Button::new("Browse…"));
                if browse.on_hover_text("Opens the system's file dialog.").clicked() {
                    self.browse(ui.ctx());
                }
                field
            });
            // Enter removes the keyboard focus from the field, so it must be read before the field requests the focus again.
            let entered = field.inner.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            if ui.memory(|memory| memory.focused().is_none()) {
                field.inner.request_focus();
            }
            if self.no_dialog {
                let text = "The system has no file dialog. Type the path above.";
                ui.label(RichText::new(text).color(theme::WRONG));
            }
            if let Some(about) = &self.about {
                ui.label(RichText::new(about).color(theme::QUIET));
            }
            let path = self.path();
            let is_file = matches!(self.purpose, Purpose::Film | Purpose::Preview);
            if is_file && path.as_ref().is_some_and(|path| path.exists()) {
                ui.label(RichText::new("The film with this name will be replaced.").color(theme::ACCENT));
            }
            if self.purpose == Purpose::Curves && path.as_ref().is_some_and(|path| path.exists()) {
                ui.label(RichText::new("The file with this name will be replaced.").color(theme::ACCENT));
            }
            ui.horizontal(|ui| {
                let go = ui.add_enabled(path.is_some(), egui::Button::new(self.purpose.button()));
                if let Some(path) = path.filter(|_| go.clicked() || entered) {
                    answer = Answer::Path(self.purpose, path);
                }
                if ui.button("Cancel").clicked() {
                    answer = Answer::Closed;
                }
            });
        });
        if response.should_close() && answer == Answer::Pending {
            answer = Answer::Closed;
        }
        answer
    }

    /// The typed path, with the extension of its purpose.
    fn path(&self) -> Option<PathBuf> {
        let typed = self.typed.trim();
        if typed.is_empty() {
            return None;
        }
        let mut path = PathBuf::from(typed);
        if let Some(extension) = self.purpose.extension().filter(|_| path.extension().is_none()) {
            path.set_extension(extension);
        }
        Some(path)
    }

    /// Opens the system's dialog. A thread waits for its answer, so that the window stays responsive.
    fn browse(&mut self, ctx: &egui::Context) {
        let mut dialog = rfd::AsyncFileDialog::new().set_title(self.purpose.title());
        if let Some(path) = self.path() {
            if let Some(folder) = path.parent().filter(|folder| folder.is_dir()) {
                dialog = dialog.set_directory(folder);
            }
            if let Some(name) = path.file_name() {
                dialog = dialog.set_file_name(name.to_string_lossy());
            }
        }
        let (sender, receiver) = sync_channel(1);
        let ctx = ctx.clone();
        let purpose = self.purpose;
        // Some systems require that the dialog is created on the window's thread.
        let future: std::pin::Pin<Box<dyn Future<Output = Option<rfd::FileHandle>> + Send>> = match purpose {
            Purpose::Open => Box::pin(dialog.add_filter("Lovelock reads", &readable()).pick_file()),
            Purpose::Beside => Box::pin(
                dialog
                    .add_filter("Take or curves", &["take", "part", "abc", "usdc", "usd", "usda"])
                    .pick_file(),
            ),
            Purpose::Body => {
                Box::pin(dialog.add_filter("Character", &FileKind::Character.extensions()).pick_file())
            }
            Purpose::Motion => {
                let kinds = [FileKind::Motion, FileKind::Character];
                let extensions: Vec<_> = kinds.into_iter().flat_map(FileKind::extensions).collect();
                Box::pin(dialog.add_filter("Motion", &extensions).pick_file())
            }
            Purpose::Surroundings => {
                let extensions = FileKind::Surroundings.extensions();
                Box::pin(dialog.add_filter("Surroundings", &extensions).pick_file())
            }
            Purpose::Sound => Box::pin(dialog.add_filter("Sound", &FileKind::Sound.extensions()).pick_file()),
            Purpose::Sequence | Purpose::Resume => Box::pin(dialog.pick_folder()),
            Purpose::SaveProject => Box::pin(dialog.add_filter("Project", &[PROJECT_EXTENSION]).save_file()),
            Purpose::Film => Box::pin(dialog.add_filter("Film", &["mp4"]).save_file()),
            Purpose::Preview => Box::pin(dialog.add_filter("Preview", &["apng"]).save_file()),
            Purpose::Curves => {
                let dialog = dialog.add_filter("Curves", &lovelock_record::CurveFormat::EXTENSIONS);
                Box::pin(dialog.save_file())
            }
            Purpose::ExportStyle => Box::pin(dialog.add_filter("Style", &[STYLE_EXTENSION]).save_file()),
            Purpose::SaveStrokes => {
                Box::pin(dialog.add_filter("Strokes", &[StrokeFile::EXTENSION]).save_file())
            }
            Purpose::Picture => Box::pin(dialog.add_filter("Picture", &["png"]).save_file()),
        };
        let spawned = std::thread::Builder::new().name("file dialog".to_owned()).spawn(move || {
            let picked = pollster::block_on(future).map(|file| file.path().to_owned());
            let _ = sender.send(picked);
            ctx.request_repaint();
        });
        self.no_dialog = spawned.is_err();
        self.browsed = spawned.is_ok().then_some((receiver, Stopwatch::start()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_without_extension_gets_one() {
        let path = |purpose, text: &str| PathDialog::new(purpose, Path::new(text)).path();
        assert_eq!(path(Purpose::Film, "a b/dance"), Some(PathBuf::from("a b/dance.mp4")));
        assert_eq!(path(Purpose::Film, "dance.mp4"), Some(PathBuf::from("dance.mp4")));
        assert_eq!(path(Purpose::Sequence, "frames"), Some(PathBuf::from("frames")));
        assert_eq!(path(Purpose::Open, "  "), None);
    }
}
