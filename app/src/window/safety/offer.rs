//! The dialog that offers what earlier runs did not save.

use std::path::{Path, PathBuf};

use egui::{Context, RichText, TextureHandle, TextureOptions, Ui, Vec2, vec2};
use lovelock_base::words::counted;
use lovelock_project::journal::Unsaved;

use super::ago::ago;
use crate::window::control::{HoverTooltip, titled_dialog};
use crate::window::files::Pending;
use crate::window::notices::Kind;
use crate::window::{Window, remember, theme};

/// The most that are shown at once. The others follow when these are answered.
const SHOWN: usize = 4;
/// Size of a picture, points.
const PICTURE: Vec2 = vec2(128.0, 80.0);

/// What is offered.
#[derive(Default)]
pub(super) struct Offers {
    list: Vec<Offer>,
    is_open: bool,
    /// The one that shall be discarded, while the user is asked.
    asked: Option<usize>,
}

struct Offer {
    unsaved: Unsaved,
    picture: Option<TextureHandle>,
}

/// An answer of the user.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answer {
    Recover(usize),
    OpenSaved(usize),
    AskDiscard(usize),
    Discard(usize),
    Keep,
    Later,
}

impl Offers {
    pub(super) fn is_open(&self) -> bool {
        self.is_open
    }
}

/// The picture in a PNG file.
fn load_picture(path: &Path, ctx: &Context) -> Option<TextureHandle> {
    let data = std::fs::metadata(path).ok()?;
    let file = (data.len() < 1 << 22).then(|| std::fs::read(path).ok()).flatten()?;
    let pixels = image::load_from_memory(&file).ok()?.to_rgba8();
    let size = [pixels.width() as usize, pixels.height() as usize];
    let image = egui::ColorImage::from_rgba_unmultiplied(size, pixels.as_raw());
    Some(ctx.load_texture("unsaved", image, TextureOptions::LINEAR))
}

impl Window {
    /// Looks for what earlier runs did not save, and offers it. Returns whether there is something.
    pub(in crate::window) fn find_unsaved(&mut self, ctx: &Context) -> bool {
        let found = self.safety.journals.unsaved(self.document.path());
        let of = |unsaved: Unsaved| Offer {
            picture: unsaved.picture.as_deref().and_then(|path| load_picture(path, ctx)),
            unsaved,
        };
        let list: Vec<Offer> = found.into_iter().map(of).collect();
        let is_open = !list.is_empty();
        self.safety.offers = Offers { list, is_open, asked: None };
        is_open
    }

    /// Shows what earlier runs did not save, because the user asked for it.
    pub(in crate::window) fn show_unsaved(&mut self, ctx: &Context) {
        let found = [self.find_unsaved(ctx), self.safety.works.find()];
        if found == [false; 2] {
            self.notices
                .push(Kind::Done, "Earlier runs left no unsaved changes and no unfinished recordings.");
        }
    }

    /// Shows the dialog while it is open.
    pub(in crate::window) fn offer_unsaved(&mut self, ctx: &Context) {
        let offers = &self.safety.offers;
        // One question at a time.
        if !offers.is_open || self.files.pending.is_some() || self.files.dialog.is_some() {
            return;
        }
        let title = "Unsaved changes of earlier runs";
        let modal = titled_dialog("unsaved changes of earlier runs", title).show(ctx, |ui| {
            ui.set_width(560.0);
            match offers.asked.and_then(|k| Some((k, offers.list.get(k)?))) {
                Some((k, offer)) => ask(ui, k, &offer.unsaved),
                None => list(ui, &offers.list),
            }
        });
        let closes = modal.should_close().then_some(Answer::Later);
        match modal.inner.or(closes) {
            None => {}
            Some(Answer::Later) => self.safety.offers.is_open = false,
            Some(Answer::Keep) => self.safety.offers.asked = None,
            Some(Answer::AskDiscard(k)) => self.safety.offers.asked = Some(k),
            Some(Answer::Discard(k)) => {
                let offers = &mut self.safety.offers;
                offers.asked = None;
                if k < offers.list.len() {
                    offers.list.remove(k).unsaved.discard();
                }
                offers.is_open = !offers.list.is_empty();
            }
            Some(Answer::Recover(k)) => {
                if let Some(offer) = self.safety.offers.list.get(k) {
                    let pending = Pending::Recover(offer.unsaved.journal().to_owned());
                    self.unless_modified(pending, ctx);
                }
            }
            Some(Answer::OpenSaved(k)) => {
                let project = self.safety.offers.list.get(k).and_then(|offer| offer.unsaved.project.clone());
                self.safety.offers.is_open = false;
                if let Some(project) = project {
                    self.unless_modified(Pending::Open(project), ctx);
                }
            }
        }
    }

    /// Puts the unsaved project in `journal` in place of this one, with its undo steps.
    pub(in crate::window) fn recover(&mut self, journal: &Path) {
        let place = self.safety.offers.list.iter().position(|offer| offer.unsaved.journal() == journal);
        let Some(place) = place else { return };
        let history = match self.safety.offers.list[place].unsaved.history() {
            Ok(history) => history,
            Err(error) => {
                self.safety.offers.is_open = false;
                self.fail(format!("The project could not be recovered. {error}"));
                return;
            }
        };
        let unsaved = self.safety.offers.list.remove(place).unsaved;
        self.safety.offers.is_open = false;
        self.forget_document();
        let (name, project) = (unsaved.name(), unsaved.project.clone());
        self.document.recover(history, project.clone());
        if let Some(path) = &project {
            self.allow_granted(path);
            remember(&mut self.layout.recent, path);
        } else {
            // Only this program writes journals of projects without a file, in the user's own folder: it had picked them.
            let files: Vec<PathBuf> =
                self.document.project().files().into_iter().map(|(_, file)| file.path.clone()).collect();
            for file in &files {
                self.session.pick(file);
            }
        }
        self.rest_all();
        self.follow_path();
        self.safety.stamp(project.as_deref());
        if let Some(journal) = &mut self.safety.journal {
            journal.replaces(unsaved);
        }
        let more = self.safety.offers.list.len();
        let more = match more {
            0 => String::new(),
            more => format!(" {} in File, Recover.", counted(more, "more project is", "more projects are")),
        };
        self.notices
            .push(Kind::Done, format!("Recovered {name} with its undo steps. Save it to keep it.{more}"));
    }
}

/// What is offered, one below the other.
fn list(ui: &mut Ui, offers: &[Offer]) -> Option<Answer> {
    let mut answer = None;
    ui.heading("Lovelock did not close properly");
    ui.label("Changes that were not saved are still there.");
    for (k, offer) in offers.iter().enumerate().take(SHOWN) {
        ui.separator();
        ui.horizontal(|ui| {
            let (place, _) = ui.allocate_exact_size(PICTURE, egui::Sense::hover());
            ui.painter().rect_filled(place, 3.0, theme::page());
            if let Some(picture) = &offer.picture {
                let size = picture.size_vec2();
                let size = size * (PICTURE.x / size.x).min(PICTURE.y / size.y);
                let at = egui::Rect::from_center_size(place.center(), size);
                egui::Image::new(picture).paint_at(ui, at);
            }
            ui.vertical(|ui| answer = answer.or(one(ui, k, &offer.unsaved)));
        });
    }
    if offers.len() > SHOWN {
        ui.separator();
        ui.label(RichText::new(format!("{} more follow.", offers.len() - SHOWN)).color(theme::quiet()));
    }
    ui.separator();
    let later = ui.button("Decide later").hover_tooltip("Keeps everything: File, Recover offers it again.");
    if later.clicked() {
        answer = Some(Answer::Later);
    }
    answer
}

fn one(ui: &mut Ui, k: usize, unsaved: &Unsaved) -> Option<Answer> {
    let mut answer = None;
    ui.label(RichText::new(unsaved.name()).strong());
    let quiet = |text: String| RichText::new(text).color(theme::quiet());
    let place =
        unsaved.project.as_ref().map_or_else(|| "Never saved".to_owned(), |path| path.display().to_string());
    ui.add(egui::Label::new(quiet(place)).truncate());
    let steps = counted(unsaved.steps, "step can be undone", "steps can be undone");
    ui.label(quiet(format!("Changed {}; {steps}.", ago(unsaved.changed))));
    if unsaved.saved_later {
        ui.label(RichText::new("The file was saved after these changes.").color(theme::watch()));
    }
    ui.horizontal(|ui| {
        let recover =
            ui.button("Recover").hover_tooltip("Opens the project with these changes and its undo steps.");
        // Nothing is lost by Enter: the other answers stay in File, Recover.
        if k == 0 && ui.memory(|memory| memory.focused().is_none()) {
            recover.request_focus();
        }
        if recover.clicked() {
            answer = Some(Answer::Recover(k));
        }
        if unsaved.project.as_ref().is_some_and(|path| path.exists()) {
            let open = ui.button("Open the saved one");
            if open
                .hover_tooltip("Opens the file as it was saved. The changes stay in File, Recover.")
                .clicked()
            {
                answer = Some(Answer::OpenSaved(k));
            }
        }
        if ui.button("Discard…").hover_tooltip("Asks, then removes these changes for good.").clicked() {
            answer = Some(Answer::AskDiscard(k));
        }
    });
    answer
}

/// Asks before changes are removed.
fn ask(ui: &mut Ui, k: usize, unsaved: &Unsaved) -> Option<Answer> {
    ui.heading(format!("Discard the unsaved changes of {}?", unsaved.name()));
    ui.label("They cannot be recovered afterwards. The saved file stays as it is.");
    ui.horizontal(|ui| {
        let keep = ui.button("Keep");
        // Enter keeps: nothing is lost by it.
        if ui.memory(|memory| memory.focused().is_none()) {
            keep.request_focus();
        }
        let discard = ui.button("Discard for good").clicked().then_some(Answer::Discard(k));
        keep.clicked().then_some(Answer::Keep).or(discard)
    })
    .inner
}
