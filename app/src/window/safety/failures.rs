//! Failures of the program: the window stays open where it can, says so, and the next start shows the report.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;

use egui::Ui;
use lovelock_base::clock::Stopwatch;
use lovelock_session::render_thread::Adapter;

use crate::failure;
use crate::window::Window;
use crate::window::notices::Kind;
use crate::window::page::Page;

/// Failed passes in a row after which all panels and dialogs are closed, and after which the window closes.
const CLOSES_PARTS: u32 = 2;
const GIVES_UP: u32 = 12;

/// Environment variable with a number of seconds after which the window fails, once, for trials.
const FAIL: &str = "LOVELOCK_FAIL_WINDOW";

/// Name of the file with the newest report that the user was told of.
const TOLD: &str = "told";

/// What failed in this window.
#[derive(Default)]
pub(super) struct Failures {
    folder: Option<PathBuf>,
    /// Passes that failed one after another.
    in_row: u32,
    fails: Option<(Stopwatch, f64)>,
    /// The device that reports name.
    adapter: Option<Arc<Adapter>>,
}

impl Failures {
    pub(super) fn of_user() -> Self {
        let secs = std::env::var(FAIL).ok().and_then(|secs| secs.parse().ok());
        let fails = secs.map(|secs| (Stopwatch::start(), secs));
        Self { folder: failure::folder(), fails, ..Self::default() }
    }

    /// Whether the window closes because it fails again and again.
    pub(super) fn gives_up(&self) -> bool {
        self.in_row >= GIVES_UP
    }

    /// Notes the newest report as told. Returns whether there is one that was not told before, and its file.
    fn newest_untold(&self) -> Option<PathBuf> {
        let folder = self.folder.as_ref()?;
        let newest = failure::reports_in(folder).into_iter().next()?;
        let name = newest.file_name()?.to_string_lossy().into_owned();
        let told = std::fs::read_to_string(folder.join(TOLD)).unwrap_or_default();
        if told.trim() >= name.as_str() {
            return None;
        }
        // If it cannot be written, the user is told again.
        let _ = std::fs::write(folder.join(TOLD), name);
        Some(newest)
    }
}

impl Window {
    /// One pass that survives a failure: the changes reach the disk, and the window goes on.
    pub(in crate::window) fn pass_safely(&mut self, ui: &mut Ui) {
        let ctx = ui.ctx().clone();
        let fails = &mut self.safety.failures.fails;
        let is_trial = fails.take_if(|(since, secs)| since.secs() > *secs).is_some();
        let passed = catch_unwind(AssertUnwindSafe(|| {
            assert!(!is_trial, "a trial of a failure");
            self.pass(ui);
        }));
        if passed.is_ok() {
            self.safety.failures.in_row = 0;
            return;
        }
        self.safety.failures.in_row += 1;
        let in_row = self.safety.failures.in_row;
        if in_row == 1 {
            self.safety.flush(&self.document);
        }
        if in_row == CLOSES_PARTS {
            self.close_parts();
        }
        if in_row == GIVES_UP {
            self.safety.flush(&self.document);
            eprintln!(
                "lovelock: the window fails again and again and closes; the next start offers unsaved changes"
            );
            self.files.quitting = true;
            ctx.send_viewport_cmd(egui::ViewportCommand::Close);
        }
        ctx.request_repaint();
    }

    /// Makes the next pass fail.
    #[cfg(test)]
    pub(in crate::window) fn fail_for_test(&mut self) {
        self.safety.failures.fails = Some((Stopwatch::start(), -1.0));
    }

    /// Closes what may have failed: dialogs, pages and panels.
    fn close_parts(&mut self) {
        self.files.dialog = None;
        self.files.pending = None;
        self.help = super::super::Help::default();
        self.keyboard = super::super::Keyboard::default();
        self.layout.page = Page::Image;
        self.layout.panels_hidden = true;
        // The pen listens since the window was opened.
        let pen = std::mem::take(&mut self.tools.pen);
        self.tools = super::super::Tools { pen, ..super::super::Tools::default() };
    }

    /// Says what failed since the last pass.
    pub(super) fn tell_failures(&mut self) {
        let adapter = self.session.painter().adapter();
        if let Some(adapter) = adapter
            && self.safety.failures.adapter.as_ref().is_none_or(|noted| !Arc::ptr_eq(noted, &adapter))
        {
            self.safety.failures.adapter = Some(Arc::clone(&adapter));
            failure::note_adapter(&format!("{} ({})", adapter.name, adapter.backend_label()));
        }
        if self.safety.journal.is_none() {
            return;
        }
        for report in failure::take_reports() {
            let is_kept = self.safety.flush(&self.document);
            let what =
                if report.what.is_empty() || report.what == "main" { "window" } else { report.what.as_str() };
            let kept = match (self.document.is_modified(), is_kept) {
                (false, _) => "",
                (true, true) => " Your changes are safe.",
                (true, false) => " Save your project.",
            };
            let file = report.file.map_or_else(String::new, |file| {
                // The next start does not tell it again.
                let _ = self.safety.failures.newest_untold();
                format!(" {} says what happened; nothing was sent.", file.display())
            });
            self.fail(format!("A part of the program failed (thread: {what}) and goes on.{kept}{file}"));
        }
    }

    /// Shows where the report of a failure is that ended an earlier run.
    pub(super) fn tell_earlier_failures(&mut self) {
        if let Some(report) = self.safety.failures.newest_untold() {
            self.notices.push_report(
                Kind::Warning,
                "Lovelock failed in an earlier run. The report holds no contents of your files and was sent nowhere.",
                report,
            );
        }
    }
}
