//! The dialog that offers recordings that were interrupted.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::{Context, RichText, Ui};
use lovelock_base::clock::Stopwatch;
use lovelock_base::words::counted;
use lovelock_project::Project;
use lovelock_project::error::ProjectError;
use lovelock_project::unfinished::{Interrupted, Job, Recordings, Running};
use lovelock_record::{UnfinishedKind, can_be_kept, discard_unfinished, keep_unfinished};

use super::ago::ago;
use crate::window::control::{HoverTooltip, titled_dialog};
use crate::window::recorder::State;
use crate::window::{Window, theme};

/// The most that are shown at once.
const SHOWN: usize = 5;
/// A take has begun after that time, seconds.
const TAKE_BEGINS_SECS: f64 = 3.0;

/// Recordings that were interrupted, and the take that is recorded.
#[derive(Default)]
pub(super) struct Works {
    recordings: Recordings,
    list: Vec<Interrupted>,
    /// Whether enough of each is there to keep, or why it cannot be read.
    keeps: Vec<(PathBuf, Result<bool, String>)>,
    is_open: bool,
    /// The one that shall be discarded, while the user is asked.
    asked: Option<usize>,
    take: Option<(Running, Stopwatch)>,
    /// The one that is recorded again. Its note stays until that has ended well.
    again: Option<Interrupted>,
}

/// An answer of the user.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Answer {
    /// Records the rest of a sequence, or a film again.
    Record(usize),
    Keep(usize),
    AskDiscard(usize),
    Discard(usize),
    Back,
    Later,
}

impl Works {
    pub(super) fn new(recordings: Recordings) -> Self {
        Self { recordings, ..Self::default() }
    }

    pub(super) fn is_open(&self) -> bool {
        self.is_open
    }

    /// Looks for recordings that were interrupted. Returns whether there are some.
    pub(super) fn find(&mut self) -> bool {
        self.list = self.recordings.interrupted();
        if let Some(again) = &self.again {
            self.list.retain(|work| work.job.out != again.job.out);
        }
        let keeps = |work: &Interrupted| {
            let out = work.job.out.clone();
            let keeps = can_be_kept(&out).map_err(|error| error.to_string());
            (out, keeps)
        };
        self.keeps = self.list.iter().map(keeps).collect();
        (self.is_open, self.asked) = (!self.list.is_empty(), None);
        self.is_open
    }

    /// Whether enough of a recording is there to keep, or why it cannot be read.
    fn keeps(&self, out: &Path) -> Option<&Result<bool, String>> {
        self.keeps.iter().find_map(|(known, keeps)| (known == out).then_some(keeps))
    }
}

impl Window {
    /// Notes a recording of `project` that begins.
    pub(in crate::window) fn note_recording(&mut self, out: &Path, project: &Project, panes: bool) {
        let running = self.safety.works.recordings.begin(&Job::new(out, project, panes));
        self.media.recorder.note(running);
    }

    /// Notes a take that begins.
    pub(in crate::window) fn note_take(&mut self, out: &Path) {
        let running = self.safety.works.recordings.begin(&Job::new(out, self.document.project(), false));
        self.safety.works.take = running.map(|running| (running, Stopwatch::start()));
    }

    /// Forgets the take when it has ended.
    pub(super) fn follow_take(&mut self) {
        let ended = self.session.worker().take_progress().is_none();
        self.safety.works.take.take_if(|(_, since)| ended && since.secs() > TAKE_BEGINS_SECS);
    }

    /// Forgets what was recorded again if that has ended well. Otherwise File, Recover offers it as before.
    pub(super) fn follow_again(&mut self) {
        if self.media.recorder.is_running() {
            return;
        }
        let ended_well = matches!(self.media.recorder.state(), State::Done { .. });
        if let Some(work) = self.safety.works.again.take().filter(|_| ended_well) {
            work.forget();
        }
    }

    /// Shows the dialog while it is open.
    pub(in crate::window) fn offer_recordings(&mut self, ctx: &Context) {
        let works = &self.safety.works;
        let others =
            self.safety.offers.is_open() || self.files.pending.is_some() || self.files.dialog.is_some();
        if !works.is_open || others {
            return;
        }
        let busy = self.media.recorder.is_running();
        let modal = titled_dialog("interrupted recordings", "Interrupted recordings").show(ctx, |ui| {
            ui.set_width(520.0);
            match works.asked.and_then(|k| Some((k, works.list.get(k)?))) {
                Some((k, work)) => ask(ui, k, work),
                None => list(ui, works, busy),
            }
        });
        let closes = modal.should_close().then_some(Answer::Later);
        let Some(answer) = modal.inner.or(closes) else { return };
        let works = &mut self.safety.works;
        works.asked = None;
        match answer {
            Answer::Later => works.is_open = false,
            Answer::Back => {}
            Answer::AskDiscard(k) => works.asked = Some(k),
            Answer::Record(k) | Answer::Keep(k) | Answer::Discard(k) => {
                let Some(work) = works.list.get(k).cloned() else { return };
                let done = match answer {
                    Answer::Record(_) => self.record_again(&work, ctx).map_err(|error| error.to_string()),
                    Answer::Keep(_) => self.keep_recording(&work),
                    _ => discard_unfinished(&work.job.out).map_err(|error| {
                        format!("{}: what is left could not be removed: {error}", work.job.out.display())
                    }),
                };
                match done {
                    Ok(()) => {
                        self.safety.works.list.retain(|other| *other != work);
                        if matches!(answer, Answer::Record(_)) {
                            self.safety.works.again = Some(work);
                        } else {
                            work.forget();
                        }
                    }
                    Err(error) => self.fail(error),
                }
                self.safety.works.is_open =
                    !self.safety.works.list.is_empty() && !matches!(answer, Answer::Record(_));
            }
        }
    }

    /// Records the rest of a sequence, or a film from its start, as it was asked for.
    fn record_again(&mut self, work: &Interrupted, ctx: &Context) -> Result<(), ProjectError> {
        let project = work.job.project()?;
        // The list is in the user's own folder: the program had read these files.
        let mut access = self.session.access().clone();
        for (_, file) in project.files() {
            access.pick(&file.path);
        }
        let panes = work.job.panes.then(|| self.layout.compare.sheet());
        let resume = work.kind == UnfinishedKind::Sequence;
        self.media.recorder.start(Arc::new(project.clone()), access, &work.job.out, panes, resume, ctx);
        if let State::Failed(why) = self.media.recorder.state() {
            return Err(ProjectError::work(why.clone()));
        }
        self.note_recording(&work.job.out, &project, work.job.panes);
        Ok(())
    }

    fn keep_recording(&mut self, work: &Interrupted) -> Result<(), String> {
        let out = &work.job.out;
        let kept = keep_unfinished(out).map_err(|error| error.to_string())?;
        let Some(kept) = kept else {
            return Err(format!("{}: less than a second was recorded, too little to keep.", out.display()));
        };
        let frames = counted(kept.frames, "frame", "frames");
        self.notices.push_written(format!("Kept {frames} as {}.", kept.path.display()), kept.path.clone());
        if work.kind == UnfinishedKind::Take {
            self.session.saved_take = Some(kept.path);
        }
        Ok(())
    }
}

fn list(ui: &mut Ui, works: &Works, busy: bool) -> Option<Answer> {
    let mut answer = None;
    ui.heading("Recordings were interrupted");
    for (k, work) in works.list.iter().enumerate().take(SHOWN) {
        ui.separator();
        answer = answer.or(one(ui, k, work, (busy, works.keeps(&work.job.out))));
    }
    if works.list.len() > SHOWN {
        ui.separator();
        ui.label(RichText::new(format!("{} more follow.", works.list.len() - SHOWN)).color(theme::quiet()));
    }
    ui.separator();
    let later = ui.button("Decide later").hover_tooltip("Keeps everything: File, Recover offers it again.");
    if later.clicked() {
        answer = Some(Answer::Later);
    }
    answer
}

fn one(
    ui: &mut Ui,
    k: usize,
    work: &Interrupted,
    (busy, keeps): (bool, Option<&Result<bool, String>>),
) -> Option<Answer> {
    let mut answer = None;
    let name = work.job.out.file_name().unwrap_or_default().to_string_lossy();
    ui.label(RichText::new(format!("{name}, a {}", work.kind.label())).strong());
    let place = RichText::new(work.job.out.display().to_string()).color(theme::quiet());
    ui.add(egui::Label::new(place).truncate());
    ui.label(RichText::new(format!("Begun {}.", ago(work.job.since()))).color(theme::quiet()));
    if let Some(Err(error)) = keeps {
        ui.label(RichText::new(error).color(theme::wrong()));
    }
    ui.horizontal(|ui| {
        if let Some(command) = &work.job.command {
            let tip = "It was recorded on the command line, which can record it again.";
            if ui.button("Copy the command").hover_tooltip(tip).clicked() {
                ui.ctx().copy_text(command_line(command, work.kind));
            }
        } else {
            let again = match work.kind {
                UnfinishedKind::Film => Some(("Record again", "Records the film again, from its start.")),
                UnfinishedKind::Sequence => Some(("Continue", "Records the images that are missing.")),
                UnfinishedKind::Take => None,
            };
            if let Some((label, tip)) = again
                && ui.add_enabled(!busy, egui::Button::new(label)).hover_tooltip(tip).clicked()
            {
                answer = Some(Answer::Record(k));
            }
        }
        let tip = match work.kind {
            UnfinishedKind::Film => "Makes a film of the images that were recorded.",
            UnfinishedKind::Sequence => "Lists the complete images in the manifest of the folder.",
            UnfinishedKind::Take => "Makes a take of the frames that were recorded, up to the last second.",
        };
        // One that cannot be read now may be readable at the click.
        let is_too_short = matches!(keeps, Some(Ok(false)));
        let keep = ui.add_enabled(!is_too_short, egui::Button::new("Keep what is there"));
        let why_not = "Less than a second of it can be read, too little to keep.";
        if keep.hover_tooltip(tip).disabled_hover_tooltip(why_not).clicked() {
            answer = Some(Answer::Keep(k));
        }
        if ui.button("Discard…").hover_tooltip("Asks, then removes what was recorded.").clicked() {
            answer = Some(Answer::AskDiscard(k));
        }
    });
    answer
}

/// The command line that records it again.
fn command_line(command: &[String], kind: UnfinishedKind) -> String {
    let plain = |word: &String| word.chars().all(|c| c.is_ascii_alphanumeric() || "-_./=:,".contains(c));
    let quoted = |word: &String| {
        if plain(word) && !word.is_empty() {
            word.clone()
        } else {
            format!("'{}'", word.replace('\'', r"'\''"))
        }
    };
    let mut words: Vec<String> = command.iter().map(quoted).collect();
    if kind == UnfinishedKind::Sequence && !command.iter().any(|word| word == "--resume") {
        words.push("--resume".to_owned());
    }
    words.join(" ")
}

fn ask(ui: &mut Ui, k: usize, work: &Interrupted) -> Option<Answer> {
    let name = work.job.out.file_name().unwrap_or_default().to_string_lossy();
    ui.heading(format!("Discard what was recorded of {name}?"));
    ui.label("It cannot be recovered afterwards.");
    ui.horizontal(|ui| {
        let keep = ui.button("Do not discard");
        // Enter keeps: nothing is lost by it.
        if ui.memory(|memory| memory.focused().is_none()) {
            keep.request_focus();
        }
        let discard = ui.button("Discard for good").clicked().then_some(Answer::Discard(k));
        keep.clicked().then_some(Answer::Back).or(discard)
    })
    .inner
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_recorded_again_is_offered_again_unless_that_ended_well() {
        let folder = tempfile::tempdir().expect("a folder");
        let notes = folder.path().join("recordings");
        let mut works = Works::new(Recordings::new(&notes));
        let out = folder.path().join("dance.mp4");
        std::fs::write(folder.path().join("dance.mp4.partial"), b"x").expect("a file");
        std::fs::create_dir(&notes).expect("a folder");
        // As a crash leaves it: the note is there and not locked.
        let note = serde_json::to_vec(&Job::new(&out, &Project::default(), false)).expect("text");
        std::fs::write(notes.join("1.json"), note).expect("a note");
        assert!(works.find());
        works.again = works.list.first().cloned();
        assert!(!works.find(), "it is being recorded");
        works.again = None;
        assert!(works.find(), "that failed");
        works.list[0].forget();
        assert!(!works.find(), "control: forgotten");
    }

    #[test]
    fn a_command_is_quoted_for_the_shell_and_resumes_a_sequence() {
        let words = ["lovelock", "record", "my hair.lovelock", "-o", "it's/out"].map(str::to_owned);
        assert_eq!(
            command_line(&words, UnfinishedKind::Sequence),
            r"lovelock record 'my hair.lovelock' -o 'it'\''s/out' --resume"
        );
        assert!(!command_line(&words, UnfinishedKind::Film).contains("--resume"));
    }
}
