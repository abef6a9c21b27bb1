//! The page with which the program starts: recent projects, examples, the tour.

mod card;
mod recent;

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, TryRecvError, sync_channel};

use egui::{Context, RichText, ScrollArea, TextureHandle, Ui, vec2};
use lovelock_jobs::examples::{Example, Made, folder};
use lovelock_project::error::ProjectError;

use super::command::Command;
use super::control::{HoverTooltip, titled_dialog};
use super::files::Pending;
use super::page::Page;
use super::purpose::Purpose;
use super::{Layout, Window, theme};
use recent::Recent;

/// The largest width of the page, points.
const WIDTH: f32 = 800.0;
/// Width of the column of recent projects, points.
const RECENT_WIDTH: f32 = 270.0;

/// The state of the page.
#[derive(Default)]
pub(super) struct StartPage {
    is_open: bool,
    /// Whether it was opened in this pass: its first button takes the focus.
    is_new: bool,
    recent: Vec<Recent>,
    examples: Vec<Option<TextureHandle>>,
    making: Option<(Example, Receiver<Result<Made, ProjectError>>)>,
    failed: Option<String>,
    /// The project whose picture was kept last.
    pictured: Option<PathBuf>,
}

/// What was chosen on the page.
enum Chosen {
    Close,
    Open(PathBuf),
    Example(Example),
    Run(Command),
}

impl StartPage {
    /// Whether it is shown.
    pub(super) fn is_open(&self) -> bool {
        self.is_open
    }

    /// Opens it with the projects that were used last.
    pub(super) fn open(&mut self, ctx: &Context, layout: &Layout) {
        self.recent = layout.recent.iter().take(recent::SHOWN).map(|path| Recent::of(path, ctx)).collect();
        if self.examples.is_empty() {
            let load = |example: &Example| card::texture(ctx, example.label(), example.picture());
            self.examples = Example::ALL.iter().map(load).collect();
        }
        (self.is_open, self.is_new, self.failed) = (true, true, None);
    }

    /// Leaves it.
    pub(super) fn close(&mut self) {
        (self.is_open, self.making) = (false, None);
    }
}

impl Window {
    /// Shows the page, and goes on with what is chosen there.
    pub(super) fn start_page(&mut self, ctx: &Context) {
        self.keep_recent_picture();
        self.take_example();
        // One question at a time.
        if !self.start.is_open || self.files.pending.is_some() || self.safety.is_asking() {
            return;
        }
        let Self { start, layout, .. } = self;
        let room = ctx.content_rect().size();
        let modal = titled_dialog("start page", "Start page").show(ctx, |ui| {
            ui.set_width(WIDTH.min(room.x - 40.0));
            start.contents(ui, layout, room.y - 60.0)
        });
        let closes = (modal.should_close() && self.start.making.is_none()).then_some(Chosen::Close);
        match modal.inner.or(closes) {
            None => {}
            Some(Chosen::Close) => self.start.close(),
            Some(Chosen::Open(path)) => {
                self.start.close();
                self.open_any(&path);
            }
            Some(Chosen::Example(example)) => self.unless_modified(Pending::Example(example), ctx),
            Some(Chosen::Run(command)) => {
                self.start.close();
                self.run(command, ctx);
            }
        }
    }

    /// Makes an example on a thread.
    pub(super) fn begin_example(&mut self, example: Example, ctx: &Context) {
        let (send, receive) = sync_channel(1);
        let ctx = ctx.clone();
        let make = move || {
            let folder = folder().unwrap_or_else(|| std::env::temp_dir().join("lovelock-examples"));
            let _ = send.send(example.make(&folder));
            ctx.request_repaint();
        };
        match std::thread::Builder::new().name("example".to_owned()).spawn(make) {
            Ok(_) => self.start.making = Some((example, receive)),
            Err(error) => {
                self.fail(format!("{}: could not start a thread to make it: {error}", example.label()));
            }
        }
    }

    /// Shows the example that is made.
    fn take_example(&mut self) {
        let Some((example, made)) = &self.start.making else { return };
        let made = match made.try_recv() {
            Ok(made) => made,
            Err(TryRecvError::Empty) => return,
            Err(TryRecvError::Disconnected) => {
                Err(ProjectError::work(format!("{}: was not made", example.label())))
            }
        };
        self.start.making = None;
        match made {
            Ok(Made { project, files, compares }) => {
                for file in &files {
                    self.session.pick(file);
                }
                self.replace_document(project, None);
                self.layout.page = if compares { Page::Compare } else { Page::Image };
                self.session.set_playing(true);
                self.start.close();
            }
            Err(error) => self.start.failed = Some(error.to_string()),
        }
    }

    /// Keeps a small picture of the project for the list of recent ones, once it is drawn, and again after it is saved.
    fn keep_recent_picture(&mut self) {
        let Some(path) = self.document.path().filter(|_| self.safety.is_kept()) else { return };
        if self.start.pictured.as_deref() == Some(path) || self.session.worker().is_loading() {
            return;
        }
        let painted = self.session.painted.as_ref();
        let is_of_now = |painted: &&std::sync::Arc<lovelock_session::render_thread::RenderedImage>| {
            self.session
                .frame
                .as_ref()
                .is_some_and(|frame| std::sync::Arc::ptr_eq(&frame.scene, &painted.snapshot.scene))
        };
        if let Some(painted) = painted.filter(is_of_now)
            && let Some(small) = super::safety::picture::small(&painted.image)
        {
            recent::keep_picture(path, small);
            self.start.pictured = Some(path.to_owned());
        }
    }

    /// Has the picture of the project kept again.
    pub(super) fn forget_recent_picture(&mut self) {
        self.start.pictured = None;
    }
}

impl StartPage {
    fn contents(&mut self, ui: &mut Ui, layout: &mut Layout, height: f32) -> Option<Chosen> {
        let mut chosen = None;
        ui.horizontal(|ui| {
            ui.label(RichText::new("Lovelock").size(22.0).strong());
            ui.label(
                RichText::new("Hair that is styled, simulated, shadowed and judged live.")
                    .color(theme::quiet()),
            );
        });
        ui.add_space(4.0);
        ui.horizontal_wrapped(|ui| {
            let begin =
                ui.button("Start with the dancer").hover_tooltip("Leaves this page. Escape does, too.");
            if std::mem::take(&mut self.is_new) {
                begin.request_focus();
            }
            if begin.clicked() {
                chosen = Some(Chosen::Close);
            }
            if ui
                .button("Open a file…")
                .hover_tooltip("Opens a project, hair, a character or motion.")
                .clicked()
            {
                chosen = Some(Chosen::Run(Command::PickFile(Purpose::Open)));
            }
            if ui.button("Take the tour").hover_tooltip("Shows the controls one after the other.").clicked() {
                chosen = Some(Chosen::Run(Command::Tour));
            }
        });
        ui.separator();
        let list = ScrollArea::vertical().max_height((height - 130.0).max(120.0)).auto_shrink([false, true]);
        list.show(ui, |ui| {
            let narrow = ui.available_width() < 620.0;
            let is_enabled = self.making.is_none();
            ui.add_enabled_ui(is_enabled, |ui| {
                if narrow {
                    chosen = self.examples(ui).or(chosen.take());
                    ui.separator();
                    chosen = self.recent(ui).or(chosen.take());
                } else {
                    ui.horizontal_top(|ui| {
                        ui.vertical(|ui| {
                            ui.set_width(RECENT_WIDTH);
                            chosen = self.recent(ui).or(chosen.take());
                        });
                        // A line would be as tall as the window.
                        ui.add_space(16.0);
                        ui.vertical(|ui| chosen = self.examples(ui).or(chosen.take()));
                    });
                }
            });
        });
        ui.separator();
        ui.horizontal(|ui| {
            ui.checkbox(&mut layout.starts_with_page, "Show at start")
                .hover_tooltip("Shows this page when the program starts without a project.");
            if let Some((example, _)) = &self.making {
                ui.spinner();
                ui.label(format!("Making: {}", example.label()));
                if ui.button("Cancel").clicked() {
                    self.making = None;
                }
            } else if let Some(failed) = &self.failed {
                ui.label(RichText::new(failed).color(theme::wrong()));
            }
        });
        chosen
    }

    fn recent(&self, ui: &mut Ui) -> Option<Chosen> {
        let mut chosen = None;
        ui.label(RichText::new("Recent projects").strong());
        if self.recent.is_empty() {
            ui.label(RichText::new("Projects that you save or open appear here.").color(theme::quiet()));
        }
        for recent in &self.recent {
            if recent.show(ui) {
                chosen = Some(Chosen::Open(recent.path.clone()));
            }
        }
        chosen
    }

    fn examples(&self, ui: &mut Ui) -> Option<Chosen> {
        let mut chosen = None;
        ui.label(RichText::new("Examples").strong());
        let gap = ui.spacing().item_spacing.x + 4.0;
        let width = ((ui.available_width() - gap) / 2.0).floor().max(120.0);
        for (row, pair) in Example::ALL.chunks(2).enumerate() {
            ui.horizontal_top(|ui| {
                ui.spacing_mut().item_spacing.x = gap;
                for (at, example) in pair.iter().enumerate() {
                    let picture = self.examples.get(row * 2 + at).and_then(Option::as_ref);
                    let size = vec2(width, (width * 0.56).floor());
                    if card::show(ui, size, picture, example.label(), example.text()).clicked() {
                        chosen = Some(Chosen::Example(*example));
                    }
                }
            });
            ui.add_space(2.0);
        }
        chosen
    }
}
