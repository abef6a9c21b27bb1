//! Exporting the report of a comparison: its options, and the job in the background.

use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{DragValue, RichText, ScrollArea, Ui};
use lovelock_base::settings::Choices;
use lovelock_render::{Backend, ShadowMethod};
use lovelock_session::clock::Pace;
use lovelock_session::job::BackgroundJob;
use lovelock_session::progress::Progress;
use lovelock_study::batch::{CompareRequest, compare};
use lovelock_study::report::CompareReport;

use crate::window::control::{HoverTooltip, note, titled_dialog};
use crate::window::purpose::Purpose;
use crate::window::{Window, images, notices, theme};

/// The options of a report.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ReportOptions {
    /// The methods, in the order of the menu.
    pub(crate) methods: Vec<ShadowMethod>,
    pub(crate) backends: Vec<Backend>,
    pub(crate) size: [u32; 2],
    /// The first frame and the number of frames.
    pub(crate) frames: [u64; 2],
    pub(crate) quick: bool,
}

impl ReportOptions {
    /// The request for a report in `out`. `clip` is the number of frames of the dance.
    fn request(&self, out: &Path, clip: u64) -> CompareRequest {
        let [first, count] = self.frames;
        let first = first.min(clip.saturating_sub(1));
        let frames: Range<u64> = first..(first + count.max(1)).min(clip.max(1));
        CompareRequest {
            out: out.to_owned(),
            frames: Some(frames),
            size: Some((self.size[0], self.size[1])),
            methods: self.methods.clone(),
            backends: self.backends.clone(),
            draws: if self.quick { CompareRequest::QUICK_DRAWS } else { CompareRequest::DEFAULT_DRAWS },
            quick: self.quick,
            film: true,
            ..CompareRequest::default()
        }
    }
}

/// The report that is being written, and the options of the next one.
#[derive(Default)]
pub(crate) struct Reporting {
    /// The options while their dialog is open, and after it while a folder is picked.
    pub(in crate::window) options: Option<ReportOptions>,
    is_open: bool,
    running: Option<(BackgroundJob<CompareReport>, PathBuf)>,
    is_cancelled: bool,
}

impl Reporting {
    /// Progress of the report that runs, 0 to 1 and in words; `None` if none runs.
    pub(crate) fn progress(&self) -> Option<(f32, String)> {
        let (job, _) = self.running.as_ref()?;
        if self.is_cancelled {
            return Some((0.0, "stopping".to_owned()));
        }
        Some(match job.progress() {
            Some(Progress::Comparing { what, done, total, left_secs }) => {
                let left = left_secs
                    .map_or_else(String::new, |secs| format!(", about {} left", Pace::in_words(secs)));
                let fraction = done as f32 / total.max(1) as f32;
                (fraction, format!("{what}, {} of {total}{left}", (done + 1).min(total)))
            }
            Some(Progress::Simulating { done, total }) => {
                (0.0, format!("simulating, {done} of {total} steps"))
            }
            Some(Progress::Loading { what }) => (0.0, what),
            _ => (0.0, "loading".to_owned()),
        })
    }

    /// Stops the report that runs.
    pub(crate) fn cancel(&mut self) {
        if let Some((job, _)) = &self.running {
            job.cancel();
            self.is_cancelled = true;
        }
    }

    /// Whether the dialog of the options is open.
    pub(crate) fn is_open(&self) -> bool {
        self.is_open
    }

    /// Whether a report is being written.
    pub(crate) fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// The end of a report, once.
    fn ended(&mut self) -> Option<Result<(CompareReport, PathBuf), String>> {
        if !self.running.as_ref()?.0.is_finished() {
            return None;
        }
        let (job, out) = self.running.take()?;
        Some(job.finish().map(|report| (report, out)).map_err(|error| error.to_string()))
    }
}

/// What the dialog of the options requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DialogAnswer {
    /// It stays open.
    Stay,
    /// It is closed.
    Cancel,
    /// The options are chosen.
    Go,
}

/// The controls of the options. `clip` is the number of frames of the dance.
pub(crate) fn options_ui(ui: &mut Ui, options: &mut ReportOptions, clip: u64) -> DialogAnswer {
    let mut answer = DialogAnswer::Stay;
    ui.set_width(420.0);
    ui.heading("Export report");
    note(
        ui,
        "Compares shadow methods with the settings of the project, and writes errors, times, images and a page to a folder. \
         Times are measured while the window runs: pause the dance for comparable times.",
    );
    ui.horizontal(|ui| {
        ui.label(RichText::new("Methods").strong());
        if ui.button("All").clicked() {
            options.methods = ShadowMethod::ALL.to_vec();
        }
        if ui.button("Clear").clicked() {
            options.methods.clear();
        }
    });
    ScrollArea::vertical().max_height(200.0).show(ui, |ui| {
        for method in ShadowMethod::offered() {
            let mut on = options.methods.contains(&method);
            if ui.checkbox(&mut on, method.label()).hover_tooltip(method.description()).changed() {
                let chosen = |known: &ShadowMethod| {
                    if *known == method { on } else { options.methods.contains(known) }
                };
                options.methods = ShadowMethod::offered().into_iter().filter(chosen).collect();
            }
        }
    });
    egui::Grid::new("report options").num_columns(2).spacing([12.0, 6.0]).show(ui, |ui| {
        ui.label("Backend");
        let choices: [(&[Backend], &str); 4] = [
            (&[Backend::Auto], "Automatic"),
            (&[Backend::Cpu], "CPU"),
            (&[Backend::Gpu], "GPU"),
            (&[Backend::Cpu, Backend::Gpu], "Both"),
        ];
        let chosen = choices.iter().find(|(backends, _)| *backends == options.backends);
        let response = egui::ComboBox::from_id_salt("report backend")
            .selected_text(chosen.map_or("", |(_, name)| name))
            .show_ui(ui, |ui| {
                for (backends, name) in choices {
                    ui.selectable_value(&mut options.backends, backends.to_vec(), name);
                }
            })
            .response;
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, "Backend"));
        response.hover_tooltip("The backends to render with and time. Each has its own tables.");
        ui.end_row();
        ui.label("Size");
        ui.horizontal(|ui| {
            for (side, name) in options.size.iter_mut().zip(["Width", "Height"]) {
                let drag = ui.add(DragValue::new(side).range(64..=4096).speed(4.0).suffix(" px"));
                drag.widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, true, name));
            }
        });
        ui.end_row();
        ui.label("First frame");
        let [first, count] = &mut options.frames;
        let last = clip.saturating_sub(1);
        let drag = ui.add(DragValue::new(first).range(0..=last).speed(0.5));
        drag.widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, true, "First frame"));
        drag.hover_tooltip("The frame for images, errors and times. Starts as the current frame.");
        ui.end_row();
        ui.label("Frames");
        let most = (clip - (*first).min(last)).min(240);
        let drag = ui.add(DragValue::new(count).range(1..=most.max(1)).speed(0.2));
        drag.widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, true, "Frames"));
        drag.hover_tooltip("With more than one, also measures popping and flicker from frame to frame, and makes films of all methods and the error map \
             of every frame.");
        ui.end_row();
        ui.label("Quick");
        let quick = ui.checkbox(&mut options.quick, "");
        quick.widget_info(|| {
            egui::WidgetInfo::selected(egui::Role::CheckBox, true, options.quick, "Quick report")
        });
        quick.hover_tooltip("Skips swim, banding and two stability tests, and times fewer draws.");
        ui.end_row();
    });
    if options.methods.is_empty() {
        ui.label(RichText::new("Choose a method.").color(theme::wrong()));
    }
    ui.horizontal(|ui| {
        if ui.add_enabled(!options.methods.is_empty(), egui::Button::new("Choose folder…")).clicked() {
            answer = DialogAnswer::Go;
        }
        if ui.button("Cancel").clicked() {
            answer = DialogAnswer::Cancel;
        }
    });
    answer
}

impl Window {
    /// Opens the dialog of a report with the options of the last one, at the present frame.
    pub(in crate::window) fn open_report_dialog(&mut self) {
        if self.pages.compare.reporting.is_running() {
            self.warn(["A report is being written. Wait for it, or cancel it above the image.".to_owned()]);
            return;
        }
        let project = self.document.project();
        let recording = &project.recording;
        let clip = self.session.frames(recording.fps);
        let now = ((self.now_secs() * recording.fps).round().max(0.0) as u64).min(clip.saturating_sub(1));
        let options = self.pages.compare.reporting.options.get_or_insert_with(|| ReportOptions {
            methods: ShadowMethod::ALL.to_vec(),
            backends: vec![project.picture.backend],
            size: [640, 360],
            frames: [now, 1],
            quick: true,
        });
        options.frames[0] = now;
        self.pages.compare.reporting.is_open = true;
    }

    /// Shows the dialog of a report.
    pub(in crate::window) fn report_dialog(&mut self, ctx: &egui::Context) {
        let clip = self.session.frames(self.document.project().recording.fps);
        let reporting = &mut self.pages.compare.reporting;
        let Some(options) = reporting.options.as_mut().filter(|_| reporting.is_open) else { return };
        let modal = titled_dialog("report", "Export report").show(ctx, |ui| options_ui(ui, options, clip));
        match modal.inner {
            DialogAnswer::Go => {
                reporting.is_open = false;
                self.open_path_dialog(Purpose::Report);
            }
            DialogAnswer::Cancel => reporting.is_open = false,
            DialogAnswer::Stay if modal.should_close() => reporting.is_open = false,
            DialogAnswer::Stay => {}
        }
    }

    /// Starts to write the report to a folder.
    pub(in crate::window) fn export_report(&mut self, out: &Path, ctx: &egui::Context) {
        let Some(options) = &self.pages.compare.reporting.options else { return };
        let project = Arc::clone(self.document.project());
        let clip = self.session.frames(project.recording.fps);
        let name = self.document.path().and_then(std::path::Path::file_name);
        let mut request = options.request(out, clip);
        request.access = self.session.access().clone();
        if let Some(name) = name {
            request.name = name.to_string_lossy().into_owned();
        }
        let ctx = ctx.clone();
        let wake = Arc::new(move || images::wake(&ctx));
        let work = move |progress: &mut dyn FnMut(Progress) -> std::ops::ControlFlow<()>| {
            compare(&project, &request, progress)
        };
        match BackgroundJob::start("comparison", wake, work) {
            Ok(job) => {
                self.pages.compare.reporting.is_cancelled = false;
                self.pages.compare.reporting.running = Some((job, out.to_owned()));
            }
            Err(error) => self.fail(error.to_string()),
        }
    }

    /// Shows a message that a report was written, or why not.
    pub(in crate::window) fn report_exported(&mut self) {
        match self.pages.compare.reporting.ended() {
            None => {}
            Some(Ok((report, out))) => {
                let page = out.join("report.html");
                let said = if report.complete {
                    format!("Report of {} rows in {}", report.methods.len(), page.display())
                } else {
                    format!("The report was stopped. The finished part is in {}", page.display())
                };
                self.notices.push_written(said, page);
            }
            Some(Err(_)) if self.pages.compare.reporting.is_cancelled => {
                self.notices.push(notices::Kind::Done, "The report was stopped before anything was written.");
            }
            Some(Err(why)) => self.notices.push(notices::Kind::Failed, format!("Report: {why}")),
        }
    }
}
