//! The dialogs of the window, which are above everything else and take all keys until they are answered.

use std::path::{Path, PathBuf};

use egui::ScrollArea;
use lovelock_base::words::counted;
use lovelock_jobs::record::videos_folder;
use lovelock_project::project::PROJECT_EXTENSION;
use lovelock_project::styles::STYLE_EXTENSION;

use super::actions::Used;
use super::command::Command;
use super::control::titled_dialog;
use super::page::Page;
use super::path_dialog::{Answer, PathDialog};
use super::purpose::Purpose;
use super::{Window, key_press, keys};

impl Window {
    /// Whether a dialog is open, which takes all keys until it is answered.
    pub(super) fn holds_keys(&self, ctx: &egui::Context) -> bool {
        self.files.dialog.is_some()
            || self.files.pending.is_some()
            || self.help.keys_shown
            || self.preferences.is_open()
            || self.start.is_open()
            || self.pages.compare.reporting.is_open()
            || self.keyboard.palette.is_open()
            || self.safety.is_asking()
            || self.files.up_question.is_open()
            || key_press::are_held(ctx)
    }

    /// Whether a command acts although a dialog is open: most of these close it.
    pub(super) fn closes(&self, command: &Command) -> bool {
        if self.preferences.takes_key() {
            return false;
        }
        if self.start.is_open() {
            // Tab goes from control to control there.
            return *command != Command::TogglePanels;
        }
        match command {
            Command::Palette => self.keyboard.palette.is_open(),
            Command::ShowKeys => self.help.keys_shown,
            Command::Preferences => self.preferences.is_open(),
            // They show what they do in any dialog.
            Command::ScaleUp | Command::ScaleDown | Command::ScaleReset => true,
            _ => false,
        }
    }

    /// Shows the dialogs above everything else.
    pub(super) fn windows(&mut self, ctx: &egui::Context) {
        let shown = self.files.dialog.as_mut().map(|dialog| dialog.show(ctx));
        match shown {
            None | Some(Answer::Pending) => {}
            Some(Answer::Closed) => {
                if let Some(path) = self.files.dialog.as_ref().and_then(PathDialog::waiting) {
                    self.files.openings.cancel_asked(path);
                }
                (self.files.dialog, self.files.after_saving) = (None, None);
            }
            // It stays open until the path is known to be good.
            Some(Answer::Path(purpose, path)) => match self.answer(purpose, &path, ctx) {
                Ok(Used::Done) => self.files.dialog = None,
                Ok(Used::Waits) => {
                    if let Some(dialog) = &mut self.files.dialog {
                        dialog.wait(&path);
                    }
                }
                Err(error) => {
                    if let Some(dialog) = &mut self.files.dialog {
                        dialog.refuse(error);
                    }
                }
            },
        }
        if self.help.keys_shown {
            let (mut change, mut close) = (false, false);
            let modal = titled_dialog("keys", "Keys").show(ctx, |ui| {
                // Above the list, which takes all the height there is.
                ui.horizontal(|ui| {
                    ui.heading("Keys");
                    change = ui.small_button("Change…").clicked();
                    close = ui.small_button("Close").clicked();
                });
                let most = ctx.content_rect().height() * 0.85;
                let area = ScrollArea::vertical().min_scrolled_height(most).max_height(most);
                // The bar lies over what is scrolled.
                let beside_bar = egui::Margin { right: 10, ..egui::Margin::ZERO };
                area.show(ui, |ui| egui::Frame::new().inner_margin(beside_bar).show(ui, keys::list));
            });
            self.help.keys_shown = !(modal.should_close() || change || close);
            if change {
                self.preferences.toggle();
            }
        }
        self.start_page(ctx);
        self.preferences(ctx);
        self.about(ctx);
        self.report_dialog(ctx);
        self.ask_up_axis(ctx);
        self.offer_unsaved(ctx);
        self.offer_recordings(ctx);
        self.confirm_loss(ctx);
    }

    /// Opens the dialog for a path.
    pub(super) fn open_path_dialog(&mut self, purpose: Purpose) {
        let folder = self
            .document
            .path()
            .and_then(Path::parent)
            .map_or_else(|| std::env::current_dir().unwrap_or_default(), Path::to_owned);
        let last = self.layout.recordings.as_deref().filter(|folder| folder.is_dir());
        let recordings = || recordings_folder(self.document.path(), last, videos_folder);
        let suggestion = match purpose {
            Purpose::Open
            | Purpose::Beside
            | Purpose::Body
            | Purpose::Motion
            | Purpose::Surroundings
            | Purpose::Backdrop
            | Purpose::Reference
            | Purpose::Sound => folder.join(""),
            Purpose::SaveProject => self
                .document
                .path()
                .map_or_else(|| folder.join("hair").with_extension(PROJECT_EXTENSION), Path::to_owned),
            Purpose::Film if self.layout.page == Page::Compare => recordings().join("comparison.mp4"),
            Purpose::Film => recordings().join("dance.mp4"),
            Purpose::Sequence | Purpose::Resume => recordings().join("frames"),
            Purpose::Preview => recordings().join("dance.apng"),
            Purpose::Curves => recordings().join("dance.usdc"),
            Purpose::Picture if self.layout.page == Page::Compare => folder.join("comparison.png"),
            Purpose::ExportStyle => {
                let name = self.files.exported.as_ref().map_or("", |style| style.name.as_str());
                folder.join(name.replace(['/', '\\'], "-")).with_extension(STYLE_EXTENSION)
            }
            Purpose::SaveStrokes => folder.join("hair").with_extension(lovelock_brush::StrokeFile::EXTENSION),
            Purpose::Picture => folder.join("hair.png"),
            Purpose::Report => folder.join("out").join("report"),
        };
        let recent = self.layout.files.iter().chain(&self.layout.recent).cloned();
        let dialog = PathDialog::new(purpose, &suggestion)
            .own(self.document.path().map(Path::to_owned))
            .recent(recent);
        self.files.dialog = Some(match purpose {
            Purpose::Film | Purpose::Sequence | Purpose::Preview | Purpose::Resume => {
                dialog.about(self.recording_in_words())
            }
            Purpose::Curves => dialog.about(
                "USD and Alembic contain all strands, .glb the guide strands; each includes the body. The Recording panel \
                 sets the frames."
                    .to_owned(),
            ),
            Purpose::Open
            | Purpose::Beside
            | Purpose::Body
            | Purpose::Motion
            | Purpose::Surroundings
            | Purpose::Backdrop
            | Purpose::Reference
            | Purpose::Sound
            | Purpose::SaveProject
            | Purpose::ExportStyle
            | Purpose::SaveStrokes
            | Purpose::Picture => dialog,
            Purpose::Report => dialog.about(
                "report.html opens in a browser. Replaces a report in the same folder, and its images."
                    .to_owned(),
            ),
        });
    }

    /// Describes the recording that would start now.
    fn recording_in_words(&self) -> String {
        let recording = &self.document.project().recording;
        let clip = self.session.frames(recording.fps);
        let first = recording.first_frame;
        let frames = recording.end_frame.unwrap_or(clip.max(first + 1)).saturating_sub(first);
        let what = if self.layout.page == Page::Compare { "The panes with their labels: " } else { "" };
        let counted = counted(frames, "frame", "frames");
        format!(
            "{what}{counted} of {} × {} at {} per second: {:.1} s. The Recording panel sets them.",
            recording.width,
            recording.height,
            recording.fps,
            frames as f64 / recording.fps,
        )
    }
}

/// The folder that is suggested for recordings: `out` beside the file of the project, otherwise that of the `last` recording, otherwise that
/// of the user's `videos`. The folder in which the program was started may be any.
fn recordings_folder(
    project: Option<&Path>,
    last: Option<&Path>,
    videos: impl FnOnce() -> Option<PathBuf>,
) -> PathBuf {
    let beside = project.and_then(Path::parent).map(|folder| folder.join("out"));
    beside.or_else(|| last.map(Path::to_owned)).or_else(videos).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn recordings_lie_beside_the_project_or_where_the_last_one_does() {
        let (project, last) = (Path::new("/hair/red.lovelock"), Path::new("/films"));
        let videos = || Some(PathBuf::from("/home/Videos"));
        assert_eq!(recordings_folder(Some(project), Some(last), videos), Path::new("/hair/out"));
        assert_eq!(recordings_folder(None, Some(last), videos), last);
        assert_eq!(recordings_folder(None, None, videos), Path::new("/home/Videos"));
    }
}
