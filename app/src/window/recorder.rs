//! A recording that runs in the background.

use lovelock_base::words::counted;
use std::path::Path;
use std::sync::Arc;

use lovelock_jobs::record::{RecordJob, RecordRequest};
use lovelock_panes::sheet::Sheet;
use lovelock_project::Project;
use lovelock_project::files::Access;
use lovelock_session::clock::Pace;
use lovelock_session::progress::Progress;

use super::panels::recording::State;

/// The recording that runs, if any, and the result of the last one. Dropping it cancels the recording.
pub(crate) struct Recorder {
    running: Option<(RecordJob, Pace)>,
    /// Whether the recording that runs was cancelled.
    cancelled: bool,
    state: State,
}

impl Default for Recorder {
    fn default() -> Self {
        Self { running: None, cancelled: false, state: State::Idle }
    }
}

impl Recorder {
    /// Starts recording `project`, or its panes, to `out`, unless a recording runs. `resume` continues the sequence at `out`.
    pub(crate) fn start(
        &mut self,
        project: Arc<Project>,
        access: Access,
        out: &Path,
        panes: Option<Sheet>,
        resume: bool,
        ctx: &egui::Context,
    ) {
        if self.running.is_some() {
            return;
        }
        let request =
            RecordRequest { out: out.to_owned(), access, panes, resume, ..RecordRequest::default() };
        let ctx = ctx.clone();
        match RecordJob::start(project, request, Arc::new(move || super::images::wake(&ctx))) {
            Ok(job) => {
                self.state =
                    State::Running { what: "Loading".to_owned(), done: 0, total: 1, left_secs: None };
                self.cancelled = false;
                self.running = Some((job, Pace::default()));
            }
            Err(error) => self.state = State::Failed(error.to_string()),
        }
    }

    /// Cancels the recording.
    pub(crate) fn cancel(&mut self) {
        if let Some((job, _)) = &self.running {
            job.cancel();
            self.cancelled = true;
        }
    }

    /// Whether a recording runs.
    pub(crate) fn is_running(&self) -> bool {
        self.running.is_some()
    }

    /// Updates the state. Returns the end of a recording once.
    pub(crate) fn update(&mut self) -> Option<&State> {
        let (job, pace) = self.running.as_mut()?;
        if let Some(progress) = job.progress() {
            let (what, done, total) = match progress {
                Progress::Loading { what } => (what, 0, 1),
                Progress::Loaded { .. } => ("Loaded".to_owned(), 0, 1),
                Progress::Simulating { done, total } => {
                    ("Simulating to the first frame".to_owned(), done, total)
                }
                Progress::Frame { done, total, .. } => ("Frame".to_owned(), done, total),
                Progress::Kept { done, total } => ("Kept".to_owned(), done, total),
                Progress::Comparing { what, done, total } => (what, done, total),
                Progress::Finishing => ("Finishing".to_owned(), 1, 1),
            };
            let left_secs = pace.left_secs(&what, done, total);
            self.state = State::Running { what, done, total, left_secs };
        }
        if !job.is_finished() {
            return None;
        }
        let (job, _) = self.running.take()?;
        self.state = match job.finish() {
            Ok(report) => {
                let kept = match report.frames_kept {
                    0 => String::new(),
                    kept => format!(", {kept} of which were there"),
                };
                State::Done(format!(
                    "{} in {}{kept}",
                    counted(report.frames, "frame", "frames"),
                    report.out.display()
                ))
            }
            Err(_) if self.cancelled => State::Cancelled,
            Err(error) => State::Failed(error.to_string()),
        };
        Some(&self.state)
    }

    /// The state that the panel shows.
    pub(crate) fn state(&self) -> &State {
        &self.state
    }
}
