//! Files that were opened as a part of the project and are not loaded yet. One that cannot be loaded leaves the project again.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use lovelock_project::Project;
use lovelock_project::error::{Place, Problem, ProblemKind};
use lovelock_project::history::History;

use super::Window;
use super::session::LoadEnd;

/// A file that is a part of the project for as long as it is not known to be broken.
#[derive(Clone, Debug)]
pub(super) struct Trial {
    place: Place,
    file: PathBuf,
    /// The project without it.
    before: Arc<Project>,
    /// The file of that project, if it has one that the project with the file does not have.
    saved_in: Option<PathBuf>,
}

impl Trial {
    pub(super) fn new(place: Place, file: &Path, before: Arc<Project>) -> Self {
        let file = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
        Self { place, file, before, saved_in: None }
    }

    /// Sets the file of the project before, which is the window's again when the trial is taken back.
    pub(super) fn saved_in(self, saved_in: Option<PathBuf>) -> Self {
        Self { saved_in, ..self }
    }

    fn is_in(&self, project: &Project) -> bool {
        project.files().into_iter().any(|(place, file)| place == self.place && file.path == self.file)
    }

    /// The problem because of which the file is not loaded, if there is one that was not there before.
    fn refused(&self, project: &Project, problems: &[Problem], known: &[Problem]) -> bool {
        self.is_in(project)
            && problems.iter().any(|problem| {
                problem.is_failure() && problem.place == self.place && !known.contains(problem)
            })
    }

    /// Takes the file out of the project. The step that opened it disappears if it is still the newest.
    fn undo(&self, history: &mut History) {
        if history.take_back(&self.before) || !self.is_in(history.project()) {
            return;
        }
        let untouched = history.undo_len() == 0;
        let mut project = (**history.project()).clone();
        project.restore_part(self.place, &self.before);
        if untouched {
            // The program was started with the file.
            *history = History::new(project);
        } else {
            history.edit("file", None, project);
        }
    }
}

impl Window {
    /// Takes the ends of loads: a file that could not be loaded is taken out of the project again, and a message says why.
    pub(super) fn take_load_ends(&mut self) {
        for end in std::mem::take(&mut self.session.load_ends) {
            match end {
                LoadEnd::Loaded(project, problems) => self.judge(&project, &problems),
                LoadEnd::Nothing => {
                    // Another load follows where one was replaced by a newer one.
                    if !self.session.worker().is_loading() {
                        self.take_back(|trial| trial.place != Place::Sound);
                    }
                }
            }
        }
    }

    fn judge(&mut self, project: &Project, problems: &[Problem]) {
        let known = std::mem::take(&mut self.told);
        // Such as a tie that gathers nothing: what was just done to the hair has no effect.
        let is_vain =
            |problem: &&Problem| problem.place == Place::Hair && problem.kind == ProblemKind::Ignored;
        let vain: Vec<&Problem> = problems.iter().filter(is_vain).collect();
        let new = vain.iter().filter(|problem| !known.contains(problem));
        self.warn(new.map(|problem| problem.message.clone()));
        let failures = problems.iter().filter(|problem| problem.is_failure());
        for problem in failures.clone().filter(|problem| !known.contains(problem)) {
            if self.starting {
                eprintln!("lovelock: {}", problem.message);
            }
            self.fail(&problem.message);
        }
        self.starting = false;
        self.told = failures.chain(vain).cloned().collect();
        let undone = self.take_back(|trial| trial.refused(project, problems, &known));
        // The same file is reported again if it is opened again.
        self.told.retain(|problem| !undone.contains(&problem.place));
        let current = Arc::clone(self.history.project());
        // A load that began before a file was opened says nothing about it.
        self.trials
            .retain(|trial| trial.is_in(&current) && (trial.place == Place::Sound || !trial.is_in(project)));
    }

    /// Shows what was said about the sound, and takes it out of the project if it could not be read.
    pub(super) fn judge_sound(&mut self, said: Vec<String>) {
        let failed = !said.is_empty();
        let project = Arc::clone(self.history.project());
        let is_heard = self.soundtrack.loaded().is_some();
        if is_heard {
            self.warn(said);
        } else {
            for sentence in said {
                if self.starting {
                    eprintln!("lovelock: {sentence}");
                }
                self.fail(sentence);
            }
        }
        if is_heard || (failed && self.soundtrack.loading().is_none()) {
            let of = |trial: &Trial| trial.place == Place::Sound && trial.is_in(&project);
            if is_heard {
                self.trials.retain(|trial| !of(trial));
            } else {
                self.take_back(of);
            }
        }
    }

    /// Takes back the trials that `ends` selects, the newest first; returns their places.
    fn take_back(&mut self, ends: impl Fn(&Trial) -> bool) -> Vec<Place> {
        let mut places = Vec::new();
        while let Some(at) = self.trials.iter().rposition(&ends) {
            let trial = self.trials.remove(at);
            trial.undo(&mut self.history);
            if self.project_path.is_none() && trial.saved_in.is_some() {
                self.project_path.clone_from(&trial.saved_in);
                self.session.set_project_path(self.project_path.as_ref());
            }
            places.push(trial.place);
        }
        places
    }
}
