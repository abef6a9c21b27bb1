//! Files that were opened as a part of the project and are not loaded yet. One that cannot be loaded leaves the project again.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::Document;
use crate::error::{Place, Problem, ProblemKind};
use crate::history::History;
use crate::project::Project;

/// A file that stays in the project only if it can be loaded.
#[derive(Clone, Debug)]
pub(super) struct Trial {
    place: Place,
    file: PathBuf,
    /// The project without it.
    before: Arc<Project>,
    /// The file of that project, which is the document's again when a take leaves the project.
    saved_in: Option<PathBuf>,
}

impl Trial {
    fn is_in(&self, project: &Project) -> bool {
        project.files().into_iter().any(|(place, file)| place == self.place && file.path == self.file)
    }

    /// Whether `problems` say that the file is not loaded, and `known` did not.
    fn is_refused(&self, project: &Project, problems: &[Problem], known: &[Problem]) -> bool {
        self.is_in(project)
            && problems.iter().any(|problem| {
                problem.is_failure() && problem.place == self.place && !known.contains(problem)
            })
    }
}

/// Whether a change of the hair has no effect, such as a tie that gathers nothing.
fn is_vain(problem: &Problem) -> bool {
    problem.place == Place::Hair && problem.kind == ProblemKind::Ignored
}

impl Document {
    /// Makes a file a part of the project, as an undo step. It leaves the project again if it cannot be loaded.
    pub fn try_file(&mut self, label: &str, place: Place, file: &Path, set: impl FnOnce(&mut Project)) {
        let before = Arc::clone(self.project());
        self.change(label, set);
        self.try_part(place, file, before);
    }

    /// Puts the file of a part of the project on trial: unless it can be loaded, that part is again the one of `before`.
    pub fn try_part(&mut self, place: Place, file: &Path, before: Arc<Project>) {
        let file = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
        let saved_in = self.path.clone().filter(|_| place == Place::Take);
        self.trials.push(Trial { place, file, before, saved_in });
    }

    /// Whether files are not loaded yet.
    pub fn has_trials(&self) -> bool {
        !self.trials.is_empty()
    }

    /// Takes the problems with which `loaded` was loaded: a file that could not be loaded leaves the project. Returns the problems
    /// that were not there before, those that are failures last.
    pub fn take_problems(&mut self, loaded: &Project, problems: &[Problem]) -> Vec<Problem> {
        let known = std::mem::take(&mut self.problems);
        let vain = problems.iter().filter(|problem| is_vain(problem));
        let failures = problems.iter().filter(|problem| problem.is_failure());
        let all: Vec<Problem> = vain.chain(failures).cloned().collect();
        let new = all.iter().filter(|problem| !known.contains(problem)).cloned().collect();
        self.problems = all;
        let undone = self.end_trials(|trial| trial.is_refused(loaded, problems, &known));
        // The same file is reported again if it is opened again.
        self.problems.retain(|problem| !undone.contains(&problem.place));
        let current = Arc::clone(self.project());
        // A load that began before a file was opened says nothing about it.
        self.trials
            .retain(|trial| trial.is_in(&current) && (trial.place == Place::Sound || !trial.is_in(loaded)));
        new
    }

    /// Takes all files on trial out of the project, because nothing was loaded. Sound is loaded by itself.
    pub fn refuse_unloaded(&mut self) {
        self.end_trials(|trial| trial.place != Place::Sound);
    }

    /// Takes the sound on trial out of the project, or lets it stay.
    pub fn end_sound_trial(&mut self, stays: bool) {
        let project = Arc::clone(self.project());
        let is_ended = |trial: &Trial| trial.place == Place::Sound && trial.is_in(&project);
        if stays {
            self.trials.retain(|trial| !is_ended(trial));
        } else {
            self.end_trials(is_ended);
        }
    }

    /// Takes the files of the trials that `ends` selects out of the project, the newest first; returns their places.
    fn end_trials(&mut self, ends: impl Fn(&Trial) -> bool) -> Vec<Place> {
        let mut places = Vec::new();
        while let Some(at) = self.trials.iter().rposition(&ends) {
            let trial = self.trials.remove(at);
            self.take_out(&trial);
            self.path = self.path.take().or(trial.saved_in);
            places.push(trial.place);
        }
        places
    }

    /// Takes a file out of the project. The step that opened it disappears if it is still the newest.
    fn take_out(&mut self, trial: &Trial) {
        if self.history.take_back(&trial.before) || !trial.is_in(self.history.project()) {
            return;
        }
        let mut project = (**self.history.project()).clone();
        project.restore_part(trial.place, &trial.before);
        if self.history.undo_len() == 0 {
            // The program was started with the file.
            self.history = History::new(project);
        } else {
            self.history.edit("file", None, project);
        }
    }
}
