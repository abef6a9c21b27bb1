//! One pass of the window, from top to bottom.

use std::sync::Arc;

use egui::text::{LayoutJob, TextWrapping};
use egui::{Align2, CentralPanel, Color32, Frame, Panel, ProgressBar, Rect, RichText, TextStyle, Ui, vec2};
use lovelock_base::settings::Info;
use lovelock_glyphs::Script;
use lovelock_project::Project;
use lovelock_project::document::Shown;
use lovelock_project::tracks::Track;
use lovelock_session::render_thread::ShownMask;
use lovelock_session::resolution;

use super::brushes::beside_bar;
use super::command::Command;
use super::control::Keying;
use super::focus::{Area, Focus};
use super::page::Page;
use super::recorder::State;
use super::shelf::Panels;
use super::viewport::{self, Viewport};
use super::{
    Window, camera_control, control, copy, dock, keys, notices, palette, panels, scale, theme, timeline,
};
use crate::window::control::HoverTooltip;

/// Files and sounds that are read faster show no progress bar, seconds.
const SHOW_READING_SECS: f64 = 0.15;
/// How often the progress of a file is drawn.
const DRAW_READING: std::time::Duration = std::time::Duration::from_millis(100);

impl Window {
    /// One pass.
    pub(super) fn pass(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        theme::follow(&ctx, self.layout.theme);
        self.layout.keys.begin(&ctx);
        scale::apply(&ctx, self.layout.scale, self.layout.panels_hidden);
        self.tools.pen.begin_pass();
        let continues =
            self.tools.gestures.continues(&ctx, self.document.overdub().writes().next().is_some());
        let second = &self.display.second;
        if !continues && !second.continues && !second.is_held {
            self.document.end_gesture();
        }
        let said = self.session.update();
        self.warn(said);
        for failed in std::mem::take(&mut self.session.failed) {
            self.fail(failed);
        }
        if !self.session.load_ends.is_empty() {
            self.take_load_ends();
            self.frame_opened_body();
        }
        self.follow_sound(&ctx);
        self.take_brushed();
        for done in std::mem::take(&mut self.session.done) {
            self.notices.push(notices::Kind::Done, done);
        }
        let said = self.pages.compare.update(self.session.live());
        self.warn(said);
        self.report_saved();
        self.report_exported();
        // The database is read or made when clusters are first drawn.
        if !self.panels.picture.record.is_noted
            && let Some((_, note)) = lovelock_satf::cache::ready()
        {
            self.panels.picture.record.is_noted = true;
            self.warn(note.as_ref().map(ToString::to_string));
        }
        self.warn(Script::missing(&super::glyphs::missing()));
        if let Some(end) = self.media.recorder.update() {
            match end {
                State::Done { what, out } => {
                    self.notices.push_written(what.as_str(), out.clone());
                }
                State::Failed(why) => {
                    self.notices.push(notices::Kind::Failed, format!("Recording: {why}"));
                }
                State::Cancelled(what) => {
                    self.notices.push(notices::Kind::Done, what.as_str());
                }
                State::Idle | State::Running { .. } => {}
            }
        }
        self.keyboard.focus.begin_pass(&ctx);
        self.keyboard.menu_keys.begin_pass(&ctx);
        let held = self.holds_keys(&ctx);
        for command in keys::pressed(&ctx, |command| !held || self.closes(command)) {
            // The dialog that one key opens takes those that follow it.
            if held || !self.holds_keys(&ctx) {
                if !matches!(command, Command::ScaleUp | Command::ScaleDown | Command::ScaleReset) {
                    self.start.close();
                }
                self.run(command, &ctx);
            }
        }
        for file in ctx.input(|input| input.raw.dropped_files.clone()) {
            self.open_any(file.path());
        }
        self.take_opened();
        self.follow_methods(&ctx);

        let begin = Focus::begin_area(ui);
        self.menu_bar(ui);
        self.keyboard.focus.end_area(ui, Area::Menu, begin);
        // Copied after the menus, which may have changed it: the panels must not restore the old values.
        let seen = self.seen();
        let mut project = copy(&seen);
        let keying = Keying::of(&project, self.now_secs(), &self.document.overdub().writes());
        control::begin_keying(&ctx, keying);
        let begin = Focus::begin_area(ui);
        let mut commands: Vec<Command> = self.timeline(ui, &mut project).into_iter().collect();
        self.keyboard.focus.end_area(ui, Area::Timeline, begin);
        self.pages.image.film = None;
        if !self.layout.panels_hidden || self.layout.dock.has_second() {
            commands.extend(self.side_panels(ui, &mut project));
        }
        let writes = self.document.overdub().writes().next().is_some();
        if self.layout.dock.has_second() && !continues && !writes && !self.display.second.continues {
            // What was pressed in the second window begins a change of its own.
            self.document.end_gesture();
        }
        control::keep_free_area(ui);
        let image = ui.available_rect_before_wrap();
        self.keyboard.focus.set_image(image);
        let begin = Focus::begin_area(ui);
        match self.layout.page {
            Page::Image => theme::over_image(|| self.picture(ui, &mut project)),
            Page::Compare => commands.extend(self.comparison(ui, &mut project)),
            Page::Wall => commands.extend(self.wall_page(ui, &mut project)),
        }
        self.keyboard.focus.end_area(ui, Area::Page, begin);
        commands.extend(control::end_keying(&ctx));
        if !std::mem::take(&mut self.panels.brushes.handled) {
            // Another page, another tool, or no image.
            self.end_stroke();
        }
        let moment = self.moment(&ctx);
        let refused = match self.take_stroke_label() {
            Some(label) => self.document.edit_seen_as(&label, &seen, project, moment),
            None => self.document.edit_seen(&seen, project, moment),
        };
        self.report_refused(refused);
        let said = control::said(&ctx);
        self.warn(said);
        for command in commands {
            self.run(command, &ctx);
        }
        let mut palette = std::mem::take(&mut self.keyboard.palette);
        let chosen = palette.show(&ctx, |command| self.can(command));
        self.keyboard.palette = palette;
        match chosen {
            Some(palette::Found::Command(info)) => self.run(info.command.clone(), &ctx),
            Some(palette::Found::Layer(kind)) => self.add_layer(kind, &ctx),
            Some(palette::Found::Setting(_, info)) => self.show_setting(info, &ctx),
            None => {}
        }
        self.windows(&ctx);
        self.keep_safe(&ctx);
        // The single image is not visible while panes are shown.
        let page = self.layout.page;
        self.rest_hidden_pages();
        let secs = self.now_secs();
        let Shown { project: shown, drawn: seen } =
            self.document.shown(secs, self.panels.hair.styles.preview());
        let size = if page == Page::Image { self.pages.image.wanted } else { [0, 0] };
        self.panels.brushes.send(self.session.worker());
        self.session.view.rate = (self.layout.view_scale <= 0.0).then_some(self.layout.view_rate);
        self.follow_mask(&seen);
        let again = self.session.send(&shown, &seen, size, self.tools.shown_mask.as_ref());
        if let Some(after) = again {
            ctx.request_repaint_after(after);
        }
        if page == Page::Compare {
            let (live, frame) = (self.session.live(), self.session.frame.as_ref());
            let playing = self.session.playing;
            self.pages.compare.send(
                live,
                (&seen, self.session.access()),
                frame,
                &self.layout.compare,
                playing,
            );
        }
        if page == Page::Wall {
            self.send_wall();
        }
        let title = format!("{} · Lovelock", self.document.title());
        // Any command to the window makes it paint again.
        if title != self.display.title {
            ctx.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.display.title = title;
        }
        if let Some(path) = self.notices.show(&ctx, beside_bar(&ctx, image))
            && let Err(error) = open::that_detached(&path)
        {
            self.warn([format!("{}: could not start a program to open it: {error}", path.display())]);
        }
        self.tour(&ctx, image);
        if let Some(info) = control::end_reveal(&ctx) {
            self.explain_missing(info);
        }
        self.help.manual.show(&ctx);
        if let Some(asked) = self.help.what.end_pass(&ctx) {
            self.explain(&asked);
        }
        self.keyboard.focus.end_pass(&ctx);
        if let Some(screenshot) = &mut self.display.screenshot {
            let shown = match page {
                Page::Image => self.session.painted.is_some(),
                Page::Compare => self.pages.compare.has_pictures(),
                Page::Wall => self.pages.wall.has_pictures(),
            };
            screenshot.update(&ctx, shown);
        }
        self.watch_close(&ctx);
    }

    fn menu_bar(&mut self, ui: &mut Ui) {
        let mut open_recent = None;
        let mut menu_keys = std::mem::take(&mut self.keyboard.menu_keys);
        let chosen = Panel::top("menu")
            .show(ui, |ui| {
                egui::MenuBar::new()
                    .ui(ui, |ui| {
                        let chosen = keys::menus(ui, &mut menu_keys, |command| self.can(command));
                        menu_keys.menu(ui, "Recent", 'R', |ui| {
                            for path in &self.layout.recent {
                                if ui.button(path.display().to_string()).clicked() {
                                    open_recent = Some(path.clone());
                                    ui.close();
                                }
                            }
                            if self.layout.recent.is_empty() {
                                ui.label(RichText::new("No project yet").color(theme::quiet()));
                            }
                        });
                        menu_keys.menu(ui, "Image size", 'I', |ui| {
                            for (scale, name) in
                                [(0.0, "Automatic"), (1.0, "Every pixel"), (0.5, "Half"), (0.25, "Quarter")]
                            {
                                ui.radio_value(&mut self.layout.view_scale, scale, name);
                            }
                            ui.separator();
                            ui.add_enabled_ui(self.layout.view_scale <= 0.0, |ui| {
                                let [least, most] = resolution::RATES;
                                let rate = &mut self.layout.view_rate;
                                let slider = egui::Slider::new(rate, least..=most).integer();
                                ui.add(slider.suffix(" images/s").text("while moving")).hover_tooltip(
                                    "Renders fewer pixels during motion if needed to keep this frame rate. At rest every \
                                     pixel is rendered.",
                                );
                            });
                        });
                        let moved = menu_keys.menu(ui, "Panels", 'N', |ui| {
                            dock::places(ui, &self.layout.dock, Panels::usual())
                        });
                        if let Some(moved) = moved.flatten() {
                            moved.apply(&mut self.layout.dock, ui.ctx());
                        }
                        if let Some(label) = self.document.history().undo_label() {
                            ui.label(
                                RichText::new(format!("last change: {label}")).small().color(theme::quiet()),
                            );
                        }
                        chosen
                    })
                    .inner
            })
            .inner;
        self.keyboard.menu_keys = menu_keys;
        if let Some(path) = open_recent {
            self.open_any(&path);
        }
        if let Some(command) = chosen {
            let ctx = ui.ctx().clone();
            self.run(command, &ctx);
        }
    }

    fn timeline(&mut self, ui: &mut Ui, project: &mut Project) -> Option<Command> {
        let session = &self.session;
        let frame = session.frame.as_ref();
        let duration_secs = frame.map_or(0.0, |frame| frame.duration_secs);
        let (project_and_access, painted) =
            ((self.document.project(), session.access()), session.painted.as_ref());
        // A style that is only shown leaves no thumbnails, and neither do the hair, body or take before, which are seen until the next
        // ones are loaded.
        let painted = painted.filter(|painted| {
            let is_of_now = frame.is_some_and(|frame| Arc::ptr_eq(&frame.scene, &painted.snapshot.scene));
            !self.document.is_preview() && is_of_now && !session.worker().is_loading()
        });
        let shown = (self.layout.timeline, duration_secs, ui.available_width());
        self.media.thumbnails.update(ui.ctx(), project_and_access, painted, shown);
        let clip = frame.and_then(|frame| frame.scene.clip.as_ref());
        let view = timeline::View {
            time_secs: frame.map_or(0.0, |frame| frame.position_secs),
            duration_secs,
            playing: session.playing,
            looping: project.motion.looping,
            rate: session.rate,
            clip: clip.map_or_else(String::new, |clip| clip.name.clone()),
            clips: session.body.clips.clone(),
            take: project.take.file.as_ref().map(|file| timeline::Take {
                name: file.path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
                backwards: session.backwards,
            }),
            can_play_take: session.saved_take.is_some(),
            thumbs: self.media.thumbnails.shown(),
            writing: timeline::Writing {
                armed: self.document.overdub().is_armed(),
                only: self
                    .document
                    .overdub()
                    .only()
                    .map(|target| Track::new(target).label_in(&project.hair.stack)),
                targets: self.document.overdub().writes().map(str::to_owned).collect(),
            },
            sound: project.sound.file.as_ref().map(|file| timeline::SoundLane {
                name: file.path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
                loaded: self.media.soundtrack.loaded().cloned().unwrap_or_default(),
            }),
            recording: session.worker().take_progress().map(|take| {
                let kept = take.kept as f64 / take.frames.max(1) as f64;
                let (from_secs, secs) = (take.from_secs, take.secs);
                timeline::Recorded { from_secs, secs, kept_secs: secs * kept }
            }),
        };
        let kept = (&mut self.layout.timeline, &mut self.layout.tracks_height);
        let Project { recording, motion, timeline: section, hair, sound, .. } = project;
        let lovelock_project::project::TimelineSection { markers, tracks, .. } = section;
        let mut edited = timeline::Edited { recording, markers, tracks, motion, sound, stack: &hair.stack };
        timeline::panel(ui, &view, kept, &mut edited)
    }

    /// Reads the sound of the project and plays it in step with the image.
    fn follow_sound(&mut self, ctx: &egui::Context) {
        let project = Arc::clone(self.document.project());
        let said = self.media.soundtrack.update(&project.sound, self.session.access(), ctx);
        self.judge_sound(said);
        let message = self.media.reference.update(&project.reference, self.session.access(), ctx);
        self.warn(message);
        let rate = if self.session.backwards { -self.session.rate } else { self.session.rate };
        let playing = self.session.playing && self.session.frame.is_some();
        self.media.soundtrack.follow(&project.sound, self.now_secs(), playing, rate);
    }

    fn picture(&mut self, ui: &mut Ui, project: &mut Project) {
        CentralPanel::default().frame(Frame::NONE).show(ui, |ui| {
            let most_pixels = viewport::most_pixels_at_rest(self.session.painter().adapter().as_deref());
            let painted = (self.session.painted.as_deref(), &self.display.textures);
            let response = self.pages.image.show(ui, painted, most_pixels, self.layout.view_scale);
            if response.contains_pointer() && ui.input(|input| input.pointer.any_pressed()) {
                // The keys are shortcuts again.
                ui.memory_mut(egui::Memory::stop_text_input);
            }
            if self.tools(ui, &response, project) {
                camera_control::apply(&mut project.camera, self.scene_secs(), &response);
            }
            let rect = response.rect;
            if let Some(place) = self.pages.image.place(rect) {
                self.media.reference.show(ui, &project.reference, place);
            }
            if let Some(error) = &self.session.draw_error {
                Viewport::caption(ui, rect, Align2::LEFT_BOTTOM, error, theme::wrong());
            }
            let ms = self.session.times.stages.median_total();
            let adapter = self.session.painter().adapter();
            let name = adapter.map_or_else(String::new, |adapter| adapter.name.clone());
            let size = self.size_label();
            let is_covered = self.running(ui, rect) && rect.width() < ROOM_BESIDE_PROGRESS;
            if !is_covered {
                Viewport::caption(ui, rect, Align2::RIGHT_TOP, &caption(ms, &size, &name), theme::quiet());
            }
        });
    }

    /// What the automatic size of images does at present, after a separator.
    fn size_label(&self) -> String {
        let Some(painted) = self.session.painted.as_deref() else { return String::new() };
        if self.layout.view_scale > 0.0 {
            return String::new();
        }
        let share = painted.image.size()[0] as f32 / self.pages.image.wanted[0].max(1) as f32;
        match painted.samples {
            _ if share < 0.98 => format!(" · {:.0} % size", 100.0 * share),
            samples if samples > 1 => format!(" · {samples} samples"),
            _ => String::new(),
        }
    }

    /// Shows background work over the image as well, because the panels may be hidden. Returns whether there is any.
    pub(super) fn running(&mut self, ui: &mut Ui, rect: Rect) -> bool {
        {
            let mut row = 0;
            if let Some((fraction, text)) = self.media.recorder.state().progress() {
                let tip = panels::recording::CANCEL;
                if progress_overlay(ui, rect, row, fraction, &format!("Recording · {text}"), tip) {
                    self.media.recorder.cancel();
                }
                row += 1;
            }
            if let Some((fraction, text)) = self.pages.compare.reporting.progress() {
                let tip = "Stops the report. Finished methods are kept in it.";
                if progress_overlay(ui, rect, row, fraction, &format!("Report · {text}"), tip) {
                    self.pages.compare.reporting.cancel();
                }
                row += 1;
            }
            let dragged = ui.input(|input| input.pointer.any_down());
            let ([loads, settles], again) = self.session.follow_work(dragged);
            if let Some(after) = again {
                ui.request_repaint_after(after);
            }
            if let Some(progress) = self.session.worker().load_progress().filter(|_| loads) {
                let tip = "Stops loading. The scene stays unchanged.";
                let what = as_sentence(&progress.what);
                if progress_overlay(ui, rect, row, progress.fraction, &what, tip) {
                    self.session.worker().cancel_load();
                    self.files.framing = None;
                }
                row += 1;
            }
            if let Some((name, taken_secs)) = self.files.openings.running() {
                let left = SHOW_READING_SECS - taken_secs;
                if left > 0.0 {
                    ui.request_repaint_after(std::time::Duration::from_secs_f64(left));
                } else {
                    let tip = "Cancels opening this file. The project stays unchanged.";
                    let done = self.files.openings.done();
                    ui.request_repaint_after(DRAW_READING);
                    if progress_overlay(ui, rect, row, done, &format!("Opening {name}"), tip) {
                        self.files.openings.cancel_first();
                    }
                    row += 1;
                }
            }
            if let Some(loading) = self.media.soundtrack.loading()
                && loading.taken_secs > SHOW_READING_SECS
            {
                let tip = "Stops reading the sound. The dance is silent.";
                if progress_overlay(ui, rect, row, loading.fraction, "Reading the sound", tip) {
                    self.media.soundtrack.cancel();
                }
                row += 1;
            }
            if let Some(settling) = self.session.worker().settling().filter(|_| settles) {
                let tip = "Continues immediately, with hair that has not settled.";
                let fraction = settling.done as f32 / settling.total.max(1) as f32;
                let text = format!("Settling the hair at {:.2} s", settling.to_secs);
                if progress_overlay(ui, rect, row, fraction, &text, tip) {
                    self.session.worker().cancel_settle();
                }
                row += 1;
            }
            row > 0
        }
    }

    /// Keeps the mask that the image shows up to date.
    fn follow_mask(&mut self, project: &Project) {
        let wanted = self.panels.layers.shown_mask(&project.hair.stack);
        let same = match (&self.tools.shown_mask, wanted) {
            (Some(shown), Some(wanted)) => shown.mask == *wanted,
            (shown, wanted) => shown.is_none() && wanted.is_none(),
        };
        if !same {
            let scale = theme::mask_colors();
            self.tools.shown_mask = wanted.map(|mask| Arc::new(ShownMask { mask: mask.clone(), scale }));
        }
    }

    /// Shows the control of a setting.
    fn show_setting(&mut self, info: &'static Info, ctx: &egui::Context) {
        self.layout.panels_hidden = false;
        control::reveal(ctx, info);
    }

    /// Adds a layer of that kind and shows its first control.
    fn add_layer(&mut self, kind: &lovelock_style::Kind, ctx: &egui::Context) {
        let Some(operation) = lovelock_style::Operation::new(kind.id) else { return };
        let first = operation.known().and_then(|known| known.settings().infos().first().copied());
        let mut layers = std::mem::take(&mut self.panels.layers);
        self.change("layer", |project| {
            layers.add(&mut project.hair.stack, operation);
        });
        self.panels.layers = layers;
        if let Some(info) = first {
            self.show_setting(info, ctx);
        }
    }
}

/// The line over the image: how long it took, its size, and what drew it. What is not known yet is left out.
fn caption(ms: f64, size: &str, adapter: &str) -> String {
    let took = if ms > 0.0 { format!("{ms:.0} ms{size}") } else { String::new() };
    let parts = [took.as_str(), adapter].into_iter().filter(|part| !part.is_empty());
    parts.collect::<Vec<_>>().join(" · ")
}

/// The width of an image beside whose bars of progress its caption has room, points.
const ROOM_BESIDE_PROGRESS: f32 = 720.0;

/// A text with a capital at its beginning.
fn as_sentence(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or_else(String::new, |first| first.to_uppercase().chain(chars).collect())
}

/// The width of a bar of progress whose text wants a width, in an image of a width, beside a button, points.
fn bar_width(wanted: f32, image: f32, button: f32) -> f32 {
    // In steps, so that a number that changes does not move the button.
    let wanted = ((wanted / 40.0).ceil() * 40.0).max(300.0);
    // In a wide image the caption stands beside the bar.
    let caption = if image < ROOM_BESIDE_PROGRESS { 0.0 } else { 334.0 };
    wanted.min(image - button - 26.0 - caption).max(60.0)
}

/// Shows a progress bar in the corner of the image, `row` from the top, and a button that stops the work. Returns whether the
/// button was clicked.
fn progress_overlay(ui: &mut Ui, picture: Rect, row: u8, fraction: f32, text: &str, tip: &str) -> bool {
    let button_width = 60.0;
    // The text is painted in the bar's own colour.
    let font = TextStyle::Button.resolve(ui.style());
    let mut job = LayoutJob::simple_singleline(text.to_owned(), font, Color32::PLACEHOLDER);
    let margins = 2.0 * ui.spacing().item_spacing.x;
    let wanted = ui.painter().layout_job(job.clone()).size().x + margins;
    let width = bar_width(wanted, picture.width(), button_width);
    job.wrap = TextWrapping::truncate_at_width((width - margins).max(0.0));
    let shown = ui.painter().layout_job(job);
    let corner = picture.left_top() + vec2(10.0, 10.0 + 26.0 * f32::from(row));
    let bar = Rect::from_min_size(corner, vec2(width, 20.0));
    ui.put(bar, ProgressBar::new(fraction).text(shown).corner_radius(4));
    let button = Rect::from_min_size(bar.right_top() + vec2(6.0, 0.0), vec2(button_width, 20.0));
    let cancel = ui.put(button, egui::Button::new("Cancel"));
    // Several of them may be shown: a screen reader says which.
    cancel.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, format!("Cancel: {text}")));
    cancel.hover_tooltip(tip).clicked()
}

#[cfg(test)]
mod tests {
    use super::bar_width;

    #[test]
    fn bars_of_progress_widen_to_their_text_and_stay_in_the_image() {
        assert_eq!(bar_width(120.0, 600.0, 60.0), 300.0);
        assert_eq!(bar_width(390.0, 600.0, 60.0), 400.0);
        assert_eq!(bar_width(390.0, 450.0, 60.0), 364.0);
        assert_eq!(bar_width(390.0, 90.0, 60.0), 60.0);
        assert_eq!(bar_width(390.0, 720.0, 60.0), 300.0, "the caption has its place");
    }
}
