//! The question which axis of a hair file points up, if its strands do not show it: six images of the hair to choose from.

mod sketch;

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};

use egui::{
    Button, ColorImage, Context, Grid, Image, RichText, Role, TextureHandle, TextureOptions, WidgetInfo,
};
use lovelock_groom::{ImportSettings, UpAxis, guess_units, load_hair};
use lovelock_project::Project;
use lovelock_project::history::GestureId;
use lovelock_project::project::HairSource;

use super::control::titled_dialog;
use super::{Window, theme};

/// Side of an image of the hair, points and pixels.
const SIDE: usize = 168;
/// Strands of an image.
const STRANDS: usize = 1500;

/// The images of a file whose axes are in doubt.
struct Doubt {
    guess: UpAxis,
    percent: f32,
    images: Vec<ColorImage>,
}

/// A file that was opened.
struct Asked {
    path: PathBuf,
    /// The undo step that opened it, which the answer joins.
    gesture: GestureId,
    state: State,
}

enum State {
    /// A thread reads it.
    Looks(Receiver<Option<Doubt>>),
    /// The user is asked.
    Asks { guess: UpAxis, percent: f32, images: Vec<TextureHandle>, is_new: bool },
}

/// The question about the hair file that was opened last, if there is one.
#[derive(Default)]
pub(super) struct UpQuestion(Option<Asked>);

impl UpQuestion {
    /// Whether the user is asked.
    pub(super) fn is_open(&self) -> bool {
        matches!(self.0, Some(Asked { state: State::Asks { .. }, .. }))
    }

    /// Whether a thread reads a file.
    #[cfg(test)]
    pub(super) fn looks(&self) -> bool {
        matches!(self.0, Some(Asked { state: State::Looks(_), .. }))
    }

    /// Reads a hair file on a thread of its own, unless its axis is set, and asks if its axis is in doubt. Whoever loads the hair reports
    /// errors.
    pub(super) fn look(&mut self, path: &Path, import: &ImportSettings, gesture: GestureId, ctx: &Context) {
        self.0 = None;
        if import.up != UpAxis::Auto {
            return;
        }
        let (sender, answer) = sync_channel(1);
        let (file, import, wake) = (path.to_owned(), *import, ctx.clone());
        let read = move || {
            // The window may be closed already.
            let _ = sender.send(doubt(&file, &import));
            super::images::wake(&wake);
        };
        // Without a thread nothing is asked; the note of the loader remains.
        let started = std::thread::Builder::new().name("lovelock up axis".to_owned()).spawn(read);
        if started.is_ok() {
            self.0 = Some(Asked { path: path.to_owned(), gesture, state: State::Looks(answer) });
        }
    }

    /// Takes the result of the thread, and forgets a question that has no meaning any more.
    fn poll(&mut self, project: &Project, ctx: &Context) {
        let Some(asked) = &mut self.0 else { return };
        let path = std::path::absolute(&asked.path).unwrap_or_else(|_| asked.path.clone());
        let is_used = project.hair.source == HairSource::File
            && project.hair.import.up == UpAxis::Auto
            && project.hair.file.as_ref().is_some_and(|file| file.path == path || file.path == asked.path);
        if !is_used {
            self.0 = None;
            return;
        }
        let State::Looks(answer) = &asked.state else { return };
        match answer.try_recv() {
            Err(TryRecvError::Empty) => {}
            Ok(Some(doubt)) => {
                let load = |image| ctx.load_texture("up axis", image, TextureOptions::LINEAR);
                let images = doubt.images.into_iter().map(load).collect();
                asked.state =
                    State::Asks { guess: doubt.guess, percent: doubt.percent, images, is_new: true };
            }
            Ok(None) | Err(TryRecvError::Disconnected) => self.0 = None,
        }
    }
}

/// The images of a file, if the axis that points up is in doubt.
fn doubt(path: &Path, import: &ImportSettings) -> Option<Doubt> {
    let hair = load_hair(path).ok()?;
    let guess = guess_units(&hair);
    if !guess.is_up_in_doubt() {
        return None;
    }
    let some = hair.some_strands(STRANDS);
    let drawn = |up| sketch::draw(&some.in_metres(&ImportSettings { up, ..*import }), SIDE);
    let images = UpAxis::AXES.into_iter().map(drawn).collect();
    Some(Doubt { guess: guess.up, percent: 100.0 * guess.up_confidence, images })
}

impl Window {
    /// As for hair that is opened, for the file that the program was started with.
    pub(super) fn ask_about_started_hair(&mut self) {
        let project = self.document.project();
        if self.document.path().is_none()
            && project.hair.source == HairSource::File
            && let Some(file) = &project.hair.file
        {
            self.files.up_question.look(&file.path, &project.hair.import, 0, &self.files.ctx);
        }
    }

    /// Asks which axis of the hair file points up, if that is in doubt. The answer is a part of the step that opened the file.
    pub(super) fn ask_up_axis(&mut self, ctx: &Context) {
        self.files.up_question.poll(self.document.project(), ctx);
        let Some(Asked { path, gesture, state: State::Asks { guess, percent, images, is_new } }) =
            &mut self.files.up_question.0
        else {
            return;
        };
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let modal = titled_dialog("up axis", "Which way is up?").show(ctx, |ui| {
            ui.heading("Which way is up?");
            ui.label(format!("{name} does not state its up axis, and its strands leave it in doubt."));
            ui.add_space(6.0);
            let mut chosen = None;
            Grid::new("up axis").num_columns(3).spacing([8.0, 8.0]).show(ui, |ui| {
                for (k, (up, image)) in UpAxis::AXES.into_iter().zip(&*images).enumerate() {
                    let is_guess = up == *guess;
                    ui.vertical(|ui| {
                        let button = Button::image(Image::new(image)).selected(is_guess);
                        let response = ui.add(button);
                        let label = if is_guess {
                            format!("{} up, guess of {percent:.0} %", up.label())
                        } else {
                            format!("{} up", up.label())
                        };
                        response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &label));
                        let text = RichText::new(&label);
                        ui.label(if is_guess { text.color(theme::accent()) } else { text });
                        if is_guess && *is_new {
                            response.request_focus();
                        }
                        if response.clicked() {
                            chosen = Some(up);
                        }
                    });
                    if k % 3 == 2 {
                        ui.end_row();
                    }
                }
            });
            *is_new = false;
            ui.add_space(6.0);
            let later = ui.button("Keep the guess").clicked();
            (chosen, later)
        });
        let (chosen, later) = modal.inner;
        if let Some(up) = chosen {
            let mut project = Project::clone(self.document.project());
            project.hair.import.up = up;
            self.document.edit_in(*gesture, "file", project);
        }
        if chosen.is_some() || later || modal.should_close() {
            self.files.up_question.0 = None;
        }
    }
}
