//! Loads the pictures around the figure: the surroundings that give light from all directions, and what is behind it.

use std::path::Path;
use std::sync::Arc;

use lovelock_appearance::environment::{BackdropPicture, Panorama};
use lovelock_project::Project;
use lovelock_project::error::{Place, Problem, ProblemKind};
use lovelock_project::files::{Access, FileRef};

use super::parts::Stamp;

/// The pictures around the figure.
#[derive(Clone, Debug, Default)]
pub struct Surroundings {
    /// The picture that gives light from all directions, if there is one.
    pub light: Option<Arc<Panorama>>,
    /// The picture behind the figure, if there is one.
    pub backdrop: Option<Arc<BackdropPicture>>,
}

impl Surroundings {
    /// Whether both hold the same pictures.
    pub fn is(&self, other: &Self) -> bool {
        fn same<T>(a: Option<&Arc<T>>, b: Option<&Arc<T>>) -> bool {
            a.map(Arc::as_ptr) == b.map(Arc::as_ptr)
        }
        same(self.light.as_ref(), other.light.as_ref())
            && same(self.backdrop.as_ref(), other.backdrop.as_ref())
    }
}

/// Loads pictures. A file is read again only after it has changed.
#[derive(Debug, Default)]
pub(crate) struct SurroundingsLoader {
    light: Slot<Panorama>,
    backdrop: Slot<BackdropPicture>,
}

impl SurroundingsLoader {
    /// The pictures of a project. A file that cannot be read is a problem: the previous light stays, and the background is its colour.
    pub(crate) fn load(
        &mut self,
        project: &Project,
        access: &Access,
        problems: &mut Vec<Problem>,
    ) -> Surroundings {
        let file = project.surroundings.file.as_ref();
        let (light, problem) = self.light.load((Place::Surroundings, file), access, |path| {
            Panorama::load(path).map_err(|error| Problem::not_loaded(Place::Surroundings, error))
        });
        problems.extend(problem.map(|problem| problem.with_fallback("the previous light stays")));
        let file = project.surroundings.backdrop.as_ref();
        let (backdrop, problem) = self.backdrop.load((Place::Backdrop, file), access, |path| {
            BackdropPicture::load(path).map_err(|error| Problem::not_loaded(Place::Backdrop, error))
        });
        // Another picture would be taken for the one that was asked for.
        let backdrop = backdrop.filter(|_| problem.is_none());
        problems.extend(problem.map(|problem| problem.with_fallback("the background has one colour")));
        Surroundings { light, backdrop }
    }

    /// What was replaced or stretched in the picture that gives light.
    pub(crate) fn notes(&self) -> Vec<Problem> {
        let messages = self.light.picture.iter().flat_map(|picture| picture.notes().messages());
        messages.map(|message| Problem::new(Place::Surroundings, ProblemKind::Note, message)).collect()
    }
}

/// One picture.
#[derive(Debug)]
struct Slot<T> {
    /// The file that was read last, and the problem if it could not be read.
    read: Option<(Stamp, Option<Problem>)>,
    /// The picture that was last read without a problem.
    picture: Option<Arc<T>>,
}

impl<T> Default for Slot<T> {
    fn default() -> Self {
        Self { read: None, picture: None }
    }
}

impl<T> Slot<T> {
    /// The picture of a file, or the one before if it cannot be read; nothing without a file.
    fn load(
        &mut self,
        (place, file): (Place, Option<&FileRef>),
        access: &Access,
        load: impl FnOnce(&Path) -> Result<T, Problem>,
    ) -> (Option<Arc<T>>, Option<Problem>) {
        let Some(file) = file else {
            *self = Self::default();
            return (None, None);
        };
        let problem = match access.read(place, file).map(|path| (Stamp::of(&path), path)) {
            Err(problem) => {
                self.read = None;
                Some(problem)
            }
            Ok((stamp, path)) => {
                if self.read.as_ref().is_none_or(|(known, _)| *known != stamp) {
                    let problem = match load(&path) {
                        Ok(picture) => {
                            self.picture = Some(Arc::new(picture));
                            None
                        }
                        Err(problem) => Some(problem),
                    };
                    self.read = Some((stamp, problem));
                }
                self.read.as_ref().and_then(|(_, problem)| problem.clone())
            }
        };
        (self.picture.clone(), problem)
    }
}
