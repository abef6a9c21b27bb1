//! The inputs that a scene is loaded from.

use std::time::SystemTime;

use lovelock_project::Project;
use lovelock_project::files::{Access, FileRef};
use lovelock_project::project::{BodySection, HairSection, MotionSection, SurroundingsSection};

use crate::take::CurveInputs;

/// The inputs of a scene. Changes of other sections of a project need no load.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum SceneInputs {
    Simulated(Box<(BodySection, MotionSection, HairSection, SurroundingsSection, Access)>),
    /// The take, with data that identifies the file's contents.
    Take {
        file: FileRef,
        version: Option<(u64, SystemTime)>,
        /// Body, motion and how curves are read: curves of another program bring none.
        around: Option<CurveInputs>,
        surroundings: SurroundingsSection,
        access: Access,
    },
}

impl SceneInputs {
    pub(super) fn of(project: &Project, access: &Access) -> Self {
        let Project { body, motion, hair, surroundings, take, .. } = project.clone();
        let access = access.clone();
        match take.file {
            Some(file) => {
                let data = std::fs::metadata(&file.path).ok();
                let version = data.and_then(|data| Some((data.len(), data.modified().ok()?)));
                let around = CurveInputs::of(&file.path, project);
                Self::Take { file, version, around, surroundings, access }
            }
            None => Self::Simulated(Box::new((body, motion, hair, surroundings, access))),
        }
    }
}
