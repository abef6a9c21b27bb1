//! Loads the picture of the surroundings that gives light from all directions.

use std::sync::Arc;

use lovelock_appearance::environment::Panorama;
use lovelock_project::Project;
use lovelock_project::error::{Place, Problem, ProblemKind};
use lovelock_project::files::Access;

use super::parts::Stamp;

/// Loads pictures of the surroundings. A file is read again only after it has changed.
#[derive(Debug, Default)]
pub(crate) struct SurroundingsLoader {
    /// The file that was read last, and the problem if it could not be read.
    read: Option<(Stamp, Option<Problem>)>,
    /// The picture that gives light.
    picture: Option<Arc<Panorama>>,
}

impl SurroundingsLoader {
    /// The picture of a project; `None` if it has none. A file that cannot be read is a problem, and the previous light stays.
    pub(crate) fn load(
        &mut self,
        project: &Project,
        access: &Access,
        problems: &mut Vec<Problem>,
    ) -> Option<Arc<Panorama>> {
        let Some(file) = &project.surroundings.file else {
            *self = Self::default();
            return None;
        };
        let read = access.read(Place::Surroundings, file).map(|path| (Stamp::of(&path), path));
        let problem = match read {
            Err(problem) => {
                self.read = None;
                Some(problem)
            }
            Ok((stamp, path)) => {
                if self.read.as_ref().is_none_or(|(known, _)| *known != stamp) {
                    let problem = match Panorama::load(&path) {
                        Ok(picture) => {
                            self.picture = Some(Arc::new(picture));
                            None
                        }
                        Err(error) => Some(Problem::not_loaded(Place::Surroundings, error)),
                    };
                    self.read = Some((stamp, problem));
                }
                self.read.as_ref().and_then(|(_, problem)| problem.clone())
            }
        };
        problems.extend(problem.map(|problem| problem.with_fallback("the previous light stays")));
        self.picture.clone()
    }

    /// What was replaced or stretched in the picture.
    pub(crate) fn notes(&self) -> Vec<Problem> {
        let messages = self.picture.iter().flat_map(|picture| picture.notes().messages());
        messages.map(|message| Problem::new(Place::Surroundings, ProblemKind::Note, message)).collect()
    }
}
