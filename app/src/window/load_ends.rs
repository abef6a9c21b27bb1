//! What the window does when files are loaded or fail to load.

use lovelock_project::Project;
use lovelock_project::error::Problem;

use super::Window;
use super::session::LoadEnd;

impl Window {
    /// Takes the ends of loads: a file that could not be loaded is taken out of the project again, and a message says why.
    pub(super) fn take_load_ends(&mut self) {
        for end in std::mem::take(&mut self.session.load_ends) {
            match end {
                LoadEnd::Loaded(project, problems) => self.report_problems(&project, &problems),
                // Another load follows where one was replaced by a newer one.
                LoadEnd::Nothing if self.session.worker().is_loading() => {}
                LoadEnd::Nothing => self.document.refuse_unloaded(),
            }
        }
        self.follow_path();
    }

    fn report_problems(&mut self, project: &Project, problems: &[Problem]) {
        for problem in self.document.take_problems(project, problems) {
            if problem.is_failure() {
                if self.files.starting {
                    eprintln!("lovelock: {}", problem.message);
                }
                self.fail(&problem.message);
            } else {
                self.warn([problem.message]);
            }
        }
        self.files.starting = false;
    }

    /// Shows messages about the sound, and takes it out of the project if it could not be read.
    pub(super) fn judge_sound(&mut self, said: Vec<String>) {
        let failed = !said.is_empty();
        let is_heard = self.media.soundtrack.loaded().is_some();
        if is_heard {
            self.warn(said);
        } else {
            for sentence in said {
                if self.files.starting {
                    eprintln!("lovelock: {sentence}");
                }
                self.fail(sentence);
            }
        }
        if is_heard || (failed && self.media.soundtrack.loading().is_none()) {
            self.document.end_sound_trial(is_heard);
        }
    }

    /// Lets the project read files of its own folder.
    pub(super) fn follow_path(&mut self) {
        self.session.set_project_path(self.document.path());
    }
}
