//! A recording that runs in the background.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use lovelock_base::words::counted;
use lovelock_jobs::record::{RecordRequest, Recorded, record_in_background};
use lovelock_panes::sheet::Sheet;
use lovelock_project::Project;
use lovelock_project::files::Access;
use lovelock_project::unfinished::Running;
use lovelock_session::clock::Pace;
use lovelock_session::job::BackgroundJob;
use lovelock_session::progress::Progress;

/// The state of the newest recording.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum State {
    /// None has been made.
    Idle,
    /// One runs.
    Running {
        /// What is being done.
        what: String,
        /// Finished frames.
        done: u64,
        /// All frames.
        total: u64,
        /// Estimated seconds left.
        left_secs: Option<f64>,
    },
    /// The last one is finished.
    Done {
        /// What was written and where.
        what: String,
        /// The file or the folder.
        out: PathBuf,
    },
    /// The last one failed; the text says why.
    Failed(String),
    /// The user stopped the last one; the text says what is left of it.
    Cancelled(String),
}

impl State {
    /// Progress of the recording that runs, 0 to 1 and in words; `None` if none runs.
    pub(crate) fn progress(&self) -> Option<(f32, String)> {
        let Self::Running { what, done, total, left_secs } = self else { return None };
        let fraction = *done as f32 / (*total).max(1) as f32;
        // A task without parts has no numbers to show.
        let count = if *total > 1 { format!(" {done} of {total}") } else { String::new() };
        let left = left_secs.map_or_else(String::new, |secs| format!(", {} left", Pace::in_words(secs)));
        Some((fraction, format!("{what}{count}{left}")))
    }
}

/// A number of bytes, with a unit.
pub(crate) fn bytes_in_words(bytes: f64) -> String {
    let (unit, name) = match bytes {
        b if b >= 999.5e6 => (1e9, "GB"),
        b if b >= 999.5e3 => (1e6, "MB"),
        _ => (1e3, "kB"),
    };
    let number = bytes / unit;
    if number < 9.95 { format!("{number:.1} {name}") } else { format!("{number:.0} {name}") }
}

/// The recording that runs, if any, and the result of the last one. Dropping it cancels the recording.
pub(crate) struct Recorder {
    running: Option<(BackgroundJob<Recorded>, Pace)>,
    /// Whether the recording that runs was cancelled.
    cancelled: bool,
    /// Where the recording that runs is written.
    out: PathBuf,
    state: State,
    /// Says that it runs, so that a crash leaves an unfinished recording that is offered again.
    noted: Option<Running>,
}

impl Default for Recorder {
    fn default() -> Self {
        Self { running: None, cancelled: false, out: PathBuf::new(), state: State::Idle, noted: None }
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
        match record_in_background(project, request, Arc::new(move || super::images::wake(&ctx))) {
            Ok(job) => {
                self.state =
                    State::Running { what: "Loading".to_owned(), done: 0, total: 1, left_secs: None };
                (self.cancelled, self.out) = (false, out.to_owned());
                self.running = Some((job, Pace::default()));
            }
            Err(error) => self.state = State::Failed(error.to_string()),
        }
    }

    /// Keeps the note of the recording that was started, until it ends.
    pub(crate) fn note(&mut self, noted: Option<Running>) {
        self.noted = noted.filter(|_| self.running.is_some());
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
                Progress::Loaded { .. } => ("Preparing the first frame".to_owned(), 0, 1),
                Progress::Simulating { done, total } => ("Simulating".to_owned(), done, total),
                Progress::Frame { done, total, .. } => ("Frame".to_owned(), done, total),
                Progress::Kept { done, total } => ("Kept".to_owned(), done, total),
                Progress::Comparing { what, done, total, .. } => (what, done, total),
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
                let what = recorded(&report.out, report.frames, report.frames_kept);
                State::Done { what, out: report.out }
            }
            Err(_) if self.cancelled => State::Cancelled(left_by_cancel(&self.out)),
            Err(error) => State::Failed(error.to_string()),
        };
        drop(self.noted.take());
        Some(&self.state)
    }

    /// The state that the panel shows.
    pub(crate) fn state(&self) -> &State {
        &self.state
    }
}

/// Says what was recorded: name, frames, size and folder. `kept` of the frames were there before.
fn recorded(out: &Path, frames: u64, kept: u64) -> String {
    let name = out.file_name().unwrap_or_default().to_string_lossy();
    let kept = if kept > 0 { format!(", {kept} of which already existed") } else { String::new() };
    let data = std::fs::metadata(out).ok();
    let size = data
        .filter(std::fs::Metadata::is_file)
        .map(|data| format!(", {}", bytes_in_words(data.len() as f64)));
    let folder = std::path::absolute(out).ok().and_then(|out| Some(out.parent()?.display().to_string()));
    format!(
        "Recorded {name}: {}{kept}{}, in {}",
        counted(frames, "frame", "frames"),
        size.unwrap_or_default(),
        folder.unwrap_or_else(|| "the current folder".to_owned()),
    )
}

/// Says what a cancelled recording to `out` leaves.
fn left_by_cancel(out: &Path) -> String {
    let name = out.file_name().unwrap_or_default().to_string_lossy();
    if out.is_dir() {
        format!("Recording cancelled. Complete images are kept in {}.", out.display())
    } else if out.exists() {
        format!("Recording cancelled. Nothing was written: {name} is unchanged.")
    } else {
        "Recording cancelled. Nothing was written.".to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_end_of_a_recording_names_the_folder_and_what_is_there() {
        let folder = tempfile::tempdir().expect("a folder");
        let film = folder.path().join("dance.mp4");
        assert_eq!(left_by_cancel(&film), "Recording cancelled. Nothing was written.");
        std::fs::write(&film, vec![0; 2_500_000]).expect("a file");
        let said = recorded(&film, 48, 0);
        let place = folder.path().display().to_string();
        assert!(
            said.starts_with("Recorded dance.mp4: 48 frames, 2.5 MB, in ") && said.ends_with(&place),
            "{said}"
        );
        assert!(left_by_cancel(&film).contains("dance.mp4 is unchanged"));
        let images = folder.path().join("images");
        std::fs::create_dir(&images).expect("a folder");
        assert!(
            recorded(&images, 48, 12)
                .starts_with("Recorded images: 48 frames, 12 of which already existed, in ")
        );
        assert!(left_by_cancel(&images).contains("Complete images are kept in"));
    }
}
