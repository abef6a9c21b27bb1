//! The effects of commands.

use std::path::{Path, PathBuf};

use lovelock_project::Project;
use lovelock_project::error::Place;
use lovelock_project::project::{CameraMode, CameraSection, Marker, TimelineSection};
use lovelock_record as recording;
use lovelock_session::scene::frame_points;

use super::command::Command;
use super::control::titled_dialog;
use super::files::Pending;
use super::opening::Aim;
use super::page::Page;
use super::pointer_tool::PointerTool;
use super::purpose::Purpose;
use super::{Window, notices, scale};

/// Factor by which a key changes the radius of the brush.
const BRUSH_STEP: f32 = 1.15;

/// What became of a path that the user picked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Used {
    /// It was used.
    Done,
    /// A thread looks into the file.
    Waits,
}

impl Window {
    /// Carries out a command.
    pub(super) fn run(&mut self, command: Command, ctx: &egui::Context) {
        if let Some(why_not) = self.why_not(&command) {
            self.notices.push(notices::Kind::Warning, why_not);
            return;
        }
        if let Some(info) = command.info() {
            crate::failure::note_command(info.id);
        }
        match command {
            Command::PlayPause => self.session.set_playing(!self.session.playing),
            Command::StepForward | Command::StepBack => {
                self.session.set_playing(false);
                self.session.worker().step(if command == Command::StepForward { 1 } else { -1 });
            }
            Command::JumpToStart => self.session.worker().restart(),
            Command::JumpToEnd => {
                let duration = self.session.frame.as_ref().map_or(0.0, |frame| frame.duration_secs);
                // A looping clip starts again at its end, whereas a take ends with its last frame.
                let takes = self.document.project().take.file.is_some();
                let last = if takes { duration } else { duration - lovelock_session::clock::STEP_SECS };
                self.session.worker().seek(last.max(0.0));
            }
            Command::ToggleLoop => {
                self.change("loop", |project| project.motion.looping = !project.motion.looping);
            }
            Command::SettleHair => self.session.worker().settle(),
            Command::Use(tool) => {
                self.tools.active.toggle(tool);
                // The mask is shown while it is painted.
                self.panels.layers.show_mask |= self.tools.active == PointerTool::Mask;
            }
            Command::ShowMask => self.panels.layers.toggle_mask(),
            Command::BrushSmaller => self.resize_brush(1.0 / BRUSH_STEP),
            Command::BrushLarger => self.resize_brush(BRUSH_STEP),
            Command::ShowColliders => self.panels.colliders.on = !self.panels.colliders.on,
            Command::RecordTake => self.record_take(),
            Command::PlayTake => {
                if let Some(path) = self.session.saved_take.clone() {
                    self.open_take(&path);
                }
            }
            Command::LeaveTake => {
                self.session.set_backwards(false);
                self.change("take", |project| {
                    project.take.file = None;
                    // They are frames of the take, and the dance has others.
                    project.recording.record_all();
                });
            }
            Command::PlayBackwards => {
                let backwards = !self.session.backwards;
                self.session.set_backwards(backwards);
                self.session.set_playing(true);
            }
            Command::WriteTracks => {
                let armed = !self.document.overdub().is_armed();
                self.document.overdub_mut().set_armed(armed);
            }
            Command::AddMarker => self.add_marker(),
            Command::MarkIn | Command::MarkOut => self.mark_end(command == Command::MarkIn),
            Command::Record if self.media.recorder.is_running() => self.media.recorder.cancel(),
            Command::Record => self.open_path_dialog(Purpose::Film),
            Command::PickFile(purpose) => self.open_path_dialog(purpose),
            Command::ExportReport => self.open_report_dialog(),
            Command::FrameHair => self.frame_hair(ctx),
            Command::ToggleFollow => self.change_seen(ctx, |project| {
                project.camera.mode = match project.camera.mode {
                    CameraMode::Follow => CameraMode::Fixed,
                    CameraMode::Fixed => CameraMode::Follow,
                };
            }),
            Command::ResetCamera => {
                self.change_seen(ctx, |project| project.camera = CameraSection::default());
            }
            Command::Undo => {
                self.document.undo();
                self.follow_path();
            }
            Command::Redo => {
                self.document.redo();
                self.follow_path();
            }
            Command::NewProject => self.unless_modified(Pending::New, ctx),
            Command::Save => match self.document.path().map(Path::to_owned) {
                Some(path) => {
                    if let Err(error) = self.save_to(&path) {
                        self.save_elsewhere(error);
                    }
                }
                None => self.open_path_dialog(Purpose::SaveProject),
            },
            Command::Load(preset) => self.change_seen(ctx, |project| project.set_preset(preset)),
            Command::Palette => self.keyboard.palette.toggle(),
            Command::Show(page) => self.layout.page.toggle(page),
            Command::TogglePanels => self.layout.panels_hidden = !self.layout.panels_hidden,
            Command::ResetLayout => self.reset_layout(ctx),
            Command::Manual => self.help.manual.toggle(),
            Command::WhatIsThis => self.what_is_this(ctx),
            Command::About => self.help.about_shown = !self.help.about_shown,
            Command::ReportProblem => self.report_problem(ctx),
            Command::ShowKeys => self.help.keys_shown = !self.help.keys_shown,
            Command::StartPage => self.start.open(ctx, &self.layout),
            Command::Tour => self.tour.begin(),
            Command::Preferences => self.preferences.toggle(),
            Command::ScaleUp => self.layout.scale = scale::larger(scale::clamped(self.layout.scale)),
            Command::ScaleDown => self.layout.scale = scale::smaller(scale::clamped(self.layout.scale)),
            Command::ScaleReset => self.layout.scale = 1.0,
            Command::ShowUnsaved => self.show_unsaved(ctx),
            Command::Quit => ctx.send_viewport_cmd(egui::ViewportCommand::Close),
            Command::Seek(secs) => self.session.worker().seek(secs),
            Command::SetRate(rate) => self.session.set_rate(rate),
            Command::TrimToPoints => self.change("trim", Project::trim_to_points),
            Command::RemoveTrim => self.change("trim", Project::trim_nothing),
            Command::SetKey { target, value } => self.set_key(&target, value),
            Command::RemoveKey(target) => self.remove_key(&target),
            Command::RecordControl { target, label } => self.record_control(target, label),
            Command::PaintMap(id) => self.paint_map(id),
            Command::Unfreeze => {
                self.session.worker().thaw();
                self.panels.brushes.forget_frozen();
            }
            Command::ExportStyle(style) => {
                self.files.exported = Some(style);
                self.open_path_dialog(Purpose::ExportStyle);
            }
            Command::EditPane(pane) => self.pages.compare.selected = pane,
            Command::ShowGauge(kind) => self.show_gauge(kind, ctx),
            Command::Report(text) => self.notices.push(notices::Kind::Done, text),
            Command::Fail(text) => self.fail(text),
        }
    }

    /// Starts to paint where an operation acts. The pointer does not brush hair meanwhile.
    fn paint_map(&mut self, id: &str) {
        let mut stack = self.document.project().hair.stack.clone();
        if self.panels.layers.paint_map(&mut stack, id) {
            self.change("layer", |project| project.hair.stack = stack);
            self.tools.active = PointerTool::Mask;
        } else {
            self.warn(["The layer limit is reached. Remove a layer first.".to_owned()]);
        }
    }

    /// Resizes the brush that is in use: that of the hair, otherwise that of masks.
    fn resize_brush(&mut self, factor: f32) {
        if self.tools.active == PointerTool::Brush {
            self.panels.brushes.scale_radius(factor);
        } else {
            self.panels.layers.resize_brush(factor);
        }
    }

    /// Makes a change that is one undo step.
    pub(super) fn change(&mut self, label: &str, change: impl FnOnce(&mut Project)) {
        if self.document.change(label, change) {
            tracing::debug!(label, "edited");
        }
    }

    /// Like [`Window::change`], for values that a track may animate: the change is treated as an edit in a panel.
    pub(super) fn change_seen(&mut self, ctx: &egui::Context, change: impl FnOnce(&mut Project)) {
        let now = self.moment(ctx);
        let refused = self.document.change_seen(now, change);
        self.report_refused(refused);
    }

    /// Starts recording a take to a new file, or ends the one that is being recorded.
    fn record_take(&mut self) {
        if self.session.worker().take_progress().is_some() {
            self.session.worker().finish_take();
            return;
        }
        match new_take(self.document.path()) {
            Ok(path) => {
                self.session.set_playing(true);
                self.note_take(&path);
                self.session.worker().record_take(path);
            }
            Err(error) => self.fail(error),
        }
    }

    /// The current time of the timeline, seconds.
    pub(super) fn now_secs(&self) -> f64 {
        self.session.frame.as_ref().map_or(0.0, |frame| frame.position_secs)
    }

    /// The time of the scene in the image, seconds; keeps increasing when the clip loops.
    pub(super) fn scene_secs(&self) -> f64 {
        self.session.frame.as_ref().map_or(0.0, |frame| frame.time_secs)
    }

    fn add_marker(&mut self) {
        let secs = self.now_secs();
        self.change("marker", |project| {
            let markers = &mut project.timeline.markers;
            if markers.len() < TimelineSection::MAX_MARKERS {
                markers.push(Marker { secs, name: format!("{}", markers.len() + 1) });
            }
        });
    }

    /// Makes the current frame the first or the last one of recordings.
    fn mark_end(&mut self, first: bool) {
        let secs = self.now_secs();
        let duration_secs = self.session.frame.as_ref().map_or(0.0, |frame| frame.duration_secs);
        self.change("recording", |project| {
            let recording = &mut project.recording;
            let frame = (secs * recording.fps).round() as u64;
            // At the very end the frame that is shown is the one after the last.
            let frames = (duration_secs * recording.fps).round() as u64;
            let frame = if frames > 0 { frame.min(frames - 1) } else { frame };
            if first {
                recording.first_frame = frame;
                recording.end_frame = recording.end_frame.filter(|end| *end > frame);
            } else {
                recording.end_frame = Some(frame + 1);
                recording.first_frame = recording.first_frame.min(frame);
            }
        });
    }

    fn frame_hair(&mut self, ctx: &egui::Context) {
        let Some(frame) = self.session.frame.clone() else { return };
        let [width, height] = if self.layout.page == Page::Compare {
            self.pages.compare.wanted()
        } else {
            self.pages.image.wanted
        };
        let aspect = width as f32 / height.max(1) as f32;
        let guides = &frame.guides.guides;
        let points = (0..guides.x.len()).map(|i| glam::Vec3::new(guides.x[i], guides.y[i], guides.z[i]));
        let camera = frame_points(&self.seen().camera, &frame.scene, frame.time_secs, points, aspect);
        self.change_seen(ctx, |project| project.camera = camera);
    }

    /// Uses the path that the user picked.
    ///
    /// # Errors
    /// Why it cannot be used, as a sentence.
    pub(super) fn answer(
        &mut self,
        purpose: Purpose,
        path: &Path,
        ctx: &egui::Context,
    ) -> Result<Used, String> {
        let aim = match purpose {
            Purpose::Open => Some(Aim::Open),
            Purpose::Beside => Some(Aim::Beside),
            // Another kind of file is a problem of the part, which its loader reports.
            Purpose::Body => Some(Aim::Part(Place::Body)),
            Purpose::Motion => Some(Aim::Part(Place::Motion)),
            Purpose::Surroundings => Some(Aim::Part(Place::Surroundings)),
            Purpose::Sound => Some(Aim::Part(Place::Sound)),
            _ => None,
        };
        if let Some(aim) = aim {
            self.look_into(path, aim)?;
            return Ok(Used::Waits);
        }
        match purpose {
            Purpose::SaveProject => {
                self.save_to(path)?;
                if let Some(pending) = self.files.after_saving.take() {
                    self.go_on(pending, ctx);
                }
            }
            Purpose::Film | Purpose::Sequence | Purpose::Preview | Purpose::Resume | Purpose::Curves => {
                let pictures = purpose != Purpose::Curves;
                if pictures {
                    recording::OutputKind::of(path).map_err(|error| error.to_string())?;
                } else if recording::CurveFormat::of(path).is_none() {
                    return Err(format!("{}: must end in .usdc, .usd, .usda, .glb or .abc", path.display()));
                }
                let access = self.session.access().clone();
                let panes =
                    (self.layout.page == Page::Compare && pictures).then(|| self.layout.compare.sheet());
                let (resume, project) = (purpose == Purpose::Resume, self.document.project().clone());
                if !self.media.recorder.is_running() {
                    let has_panes = panes.is_some();
                    self.media.recorder.start(project.clone(), access, path, panes, resume, ctx);
                    self.note_recording(path, &project, has_panes);
                    if self.media.recorder.is_running() {
                        self.layout.recordings = path.parent().map(Path::to_owned);
                    }
                }
            }
            Purpose::ExportStyle => self.export_style(path)?,
            Purpose::SaveStrokes => self.save_strokes(path)?,
            Purpose::Report => self.export_report(path, ctx),
            Purpose::Picture if self.layout.page == Page::Compare => self.save_panes(path, ctx),
            Purpose::Picture => {
                let Some(painted) = self.session.painted.clone() else { return Ok(Used::Done) };
                let [width, height] = painted.image.size();
                let picture = painted.image.picture().map_err(|error| error.to_string())?;
                recording::write_png(path, picture.width, picture.height, &picture.rgba)
                    .map_err(|error| error.to_string())?;
                let what = format!("Saved {}, {width} × {height} pixels", path.display());
                self.notices.push_written(what, path.to_owned());
            }
            Purpose::Open
            | Purpose::Beside
            | Purpose::Body
            | Purpose::Motion
            | Purpose::Surroundings
            | Purpose::Sound => {}
            Purpose::Reference => {
                self.open_part(Place::Reference, path, |project| project.set_reference_file(path));
            }
            Purpose::Backdrop => {
                self.open_part(Place::Backdrop, path, |project| project.set_backdrop_file(path));
            }
        }
        Ok(Used::Done)
    }

    pub(super) fn unless_modified(&mut self, pending: Pending, ctx: &egui::Context) {
        if self.document.is_modified() {
            self.files.pending = Some(pending);
        } else {
            self.go_on(pending, ctx);
        }
    }

    fn go_on(&mut self, pending: Pending, ctx: &egui::Context) {
        match pending {
            Pending::Quit => {
                self.files.quitting = true;
                ctx.send_viewport_cmd(egui::ViewportCommand::Close);
            }
            Pending::New => {
                // They were opened for the project that is closed.
                self.files.openings.cancel();
                self.replace_document(Project::default(), None);
            }
            Pending::Recover(journal) => self.recover(&journal),
            Pending::Example(example) => self.begin_example(example, ctx),
            Pending::Open(path) => {
                if let Err(error) = self.open_project(&path) {
                    self.fail(error);
                }
            }
            Pending::Strokes(played) => self.open_played(&played),
        }
    }

    /// Asks for confirmation before unsaved changes are lost.
    pub(super) fn confirm_loss(&mut self, ctx: &egui::Context) {
        let Some(pending) = self.files.pending.clone() else { return };
        let modal = titled_dialog("unsaved", "Unsaved changes").show(ctx, |ui| {
            ui.heading("The project has unsaved changes.");
            ui.horizontal(|ui| {
                let save = ui.button("Save");
                // Enter saves: nothing is lost by it.
                if ui.memory(|memory| memory.focused().is_none()) {
                    save.request_focus();
                }
                let lose = ui.button("Discard changes").clicked();
                let stay = ui.button("Cancel").clicked();
                (save.clicked(), lose, stay)
            })
            .inner
        });
        let (save, lose, stay) = modal.inner;
        if save {
            self.files.pending = None;
            if let Some(path) = self.document.path().map(Path::to_owned) {
                match self.save_to(&path) {
                    Ok(()) => self.go_on(pending, ctx),
                    Err(error) => self.save_elsewhere(error),
                }
            } else {
                self.open_path_dialog(Purpose::SaveProject);
                self.files.after_saving = Some(pending);
            }
        } else if lose {
            self.files.pending = None;
            self.go_on(pending, ctx);
        } else if stay || modal.should_close() {
            self.files.pending = None;
        }
        if self.files.pending.is_none() {
            // Files that were opened meanwhile have waited for the answer.
            ctx.request_repaint();
        }
    }

    /// Handles a request to close the window: asks first if changes would be lost.
    pub(super) fn watch_close(&mut self, ctx: &egui::Context) {
        let asked = ctx.input(|input| input.viewport().close_requested());
        if asked && !self.files.quitting && !self.display.is_reopening && self.document.is_modified() {
            ctx.send_viewport_cmd(egui::ViewportCommand::CancelClose);
            self.files.pending = Some(Pending::Quit);
        }
    }
}

/// A free name for a take: `takes/NAME-1.take` beside the project, or in the user's data folder if the project has no file.
fn new_take(project: Option<&Path>) -> Result<PathBuf, String> {
    let (folder, name) = if let Some(path) = project {
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        (path.parent().unwrap_or_else(|| Path::new(".")).to_owned(), name)
    } else {
        let folder = eframe::storage_dir("lovelock").ok_or(
            "there is no folder for takes: save the project first, so that they can be stored beside it",
        )?;
        (folder, "take".to_owned())
    };
    let folder = folder.join("takes");
    let free = |path: &PathBuf| !path.exists() && !path.with_extension("take.part").exists();
    (1..100_000)
        .map(|number| folder.join(format!("{name}-{number}.take")))
        .find(free)
        .ok_or_else(|| format!("{}: contains 100,000 takes of this name", folder.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn takes_lie_beside_their_project_and_replace_nothing() {
        let folder = tempfile::tempdir().expect("a folder");
        let project = folder.path().join("red hair.lovelock");
        let first = new_take(Some(&project)).expect("a name");
        assert_eq!(first, folder.path().join("takes/red hair-1.take"));
        std::fs::create_dir_all(first.parent().expect("a folder")).expect("a folder");
        std::fs::write(first.with_extension("take.part"), b"cut").expect("a file");
        assert_eq!(new_take(Some(&project)).expect("a name"), folder.path().join("takes/red hair-2.take"));
    }
}
