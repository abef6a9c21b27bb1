//! Asks for a path: a field to type in, and the system's own dialog where there is one.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};

use egui::{Modal, RichText};
use lovelock_base::clock::Stopwatch;
use lovelock_jobs::info::FileKind;
use lovelock_project::project::PROJECT_EXTENSION;

use super::theme;

/// What a path is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Purpose {
    /// Open any file that the program reads.
    Open,
    /// Compare with a take.
    Beside,
    /// Save the project.
    SaveProject,
    /// Record a film.
    Film,
    /// Record a folder of pictures.
    Sequence,
    /// Record an animated preview.
    Preview,
    /// Go on with a folder of pictures.
    Resume,
    /// Write the hair and the body for other programs.
    Curves,
    /// Save the picture in the viewport.
    Picture,
}

/// Extensions of the files that can be opened, for the system's dialog; `part` is that of an unfinished take.
fn readable() -> Vec<&'static str> {
    FileKind::ALL.into_iter().flat_map(FileKind::extensions).chain(["part"]).collect()
}

/// Nobody leaves a dialog sooner than this after asking for it: one that does so never came up. The system's
/// answer does not tell the two apart.
const NO_DIALOG_SECS: f64 = 0.5;

impl Purpose {
    fn title(self) -> &'static str {
        match self {
            Self::Open => "Open a project, take, hairstyle, character or motion",
            Self::Beside => "Compare with a take",
            Self::SaveProject => "Save the project",
            Self::Film => "Record a film",
            Self::Sequence => "Record pictures into a folder",
            Self::Preview => "Record an animated preview",
            Self::Resume => "Go on with the pictures in a folder",
            Self::Curves => "Export curves: .usdc, .usda or .glb",
            Self::Picture => "Save the picture",
        }
    }

    fn button(self) -> &'static str {
        match self {
            Self::Open => "Open file",
            Self::Beside => "Compare",
            Self::SaveProject | Self::Picture | Self::Curves => "Save file",
            Self::Film | Self::Sequence | Self::Preview => "Start recording",
            Self::Resume => "Go on recording",
        }
    }

    /// The extension that is added where none is given.
    fn extension(self) -> Option<&'static str> {
        match self {
            Self::Open | Self::Beside | Self::Sequence | Self::Resume => None,
            Self::SaveProject => Some(PROJECT_EXTENSION),
            Self::Film => Some("mp4"),
            Self::Preview => Some("apng"),
            Self::Curves => Some("usdc"),
            Self::Picture => Some("png"),
        }
    }
}

/// A question for a path that is on the screen.
#[derive(Debug)]
pub(crate) struct PathDialog {
    purpose: Purpose,
    typed: String,
    /// What will be at the path.
    about: Option<String>,
    /// What the system's dialog will send, and since when it is asked.
    browsed: Option<(Receiver<Option<PathBuf>>, Stopwatch)>,
    /// Whether the system seems to have no dialog.
    no_dialog: bool,
}

/// What became of the question.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Answer {
    /// It is still asked.
    Pending,
    /// It was closed without an answer.
    Closed,
    /// This path.
    Path(Purpose, PathBuf),
}

impl PathDialog {
    /// Asks, with `suggestion` in the field.
    pub(crate) fn new(purpose: Purpose, suggestion: &Path) -> Self {
        let typed = suggestion.display().to_string();
        Self { purpose, typed, about: None, browsed: None, no_dialog: false }
    }

    /// Says in a line what will be at the path.
    pub(crate) fn about(self, text: String) -> Self {
        Self { about: Some(text), ..self }
    }

    /// Shows it.
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
            // Enter takes the keyboard from the field: asked before the field takes it back.
            let entered = field.inner.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            if ui.memory(|memory| memory.focused().is_none()) {
                field.inner.request_focus();
            }
            if self.no_dialog {
                let text = "The system has no file dialog to show: type the path above.";
                ui.label(RichText::new(text).color(theme::WRONG));
            }
            if let Some(about) = &self.about {
                ui.label(RichText::new(about).color(theme::QUIET));
            }
            let path = self.path();
            let is_file = matches!(self.purpose, Purpose::Film | Purpose::Preview);
            if is_file && path.as_ref().is_some_and(|path| path.exists()) {
                ui.label(RichText::new("The film of this name will be replaced.").color(theme::ACCENT));
            }
            if self.purpose == Purpose::Curves && path.as_ref().is_some_and(|path| path.exists()) {
                ui.label(RichText::new("The file of this name will be replaced.").color(theme::ACCENT));
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

    /// What is typed, with the extension that its purpose wants.
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

    /// Opens the system's dialog. Its answer is waited for on a thread, so that the window goes on.
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
        // The dialog is made here, on the window's thread, as some systems demand.
        let future: std::pin::Pin<Box<dyn Future<Output = Option<rfd::FileHandle>> + Send>> = match purpose {
            Purpose::Open => Box::pin(dialog.add_filter("Lovelock reads", &readable()).pick_file()),
            Purpose::Beside => Box::pin(dialog.add_filter("Take", &["take", "part"]).pick_file()),
            Purpose::Sequence | Purpose::Resume => Box::pin(dialog.pick_folder()),
            Purpose::SaveProject => Box::pin(dialog.add_filter("Project", &[PROJECT_EXTENSION]).save_file()),
            Purpose::Film => Box::pin(dialog.add_filter("Film", &["mp4"]).save_file()),
            Purpose::Preview => Box::pin(dialog.add_filter("Preview", &["apng"]).save_file()),
            Purpose::Curves => {
                let dialog = dialog.add_filter("Curves", &lovelock_record::CurveFormat::EXTENSIONS);
                Box::pin(dialog.save_file())
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
