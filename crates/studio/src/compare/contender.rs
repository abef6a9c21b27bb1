//! One way to draw hair among those that are compared.

use lovelock_render::{Backend, PictureSettings, ShadowSettings, Transparency};
use serde::{Deserialize, Serialize};

use crate::{FileRef, Project};

/// One way to draw hair among those that are compared, or another take of it: everything else of the picture is shared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Contender {
    /// How hair shadows itself, with the values of every method.
    pub shadow: ShadowSettings,
    /// How overlapping strands are put together.
    pub transparency: Transparency,
    /// What draws.
    pub backend: Backend,
    /// Pixels that are drawn for one pixel of the pane along each edge, 0.1 to 1.
    pub scale: f32,
    /// A take that it shows at the time of all, in place of what the others show.
    pub take: Option<FileRef>,
}

impl Default for Contender {
    fn default() -> Self {
        Self::of(&Project::default())
    }
}

impl Contender {
    /// The smallest and the largest [`Contender::scale`].
    pub const SCALES: std::ops::RangeInclusive<f32> = 0.1..=1.0;

    /// What `project` itself does.
    pub fn of(project: &Project) -> Self {
        let PictureSettings { transparency, backend, .. } = project.picture;
        Self { shadow: project.shadow, transparency, backend, scale: 1.0, take: None }
    }

    /// The project drawn this way.
    pub fn applied_to(&self, project: &Project) -> Project {
        let mut project = project.clone();
        project.shadow = self.shadow;
        project.picture.transparency = self.transparency;
        project.picture.backend = self.backend;
        project
    }
}

#[cfg(test)]
mod tests {
    use lovelock_render::ShadowMethod;

    use super::*;

    #[test]
    fn a_project_drawn_its_own_way_is_itself() {
        let project = Project::default();
        assert_eq!(Contender::of(&project).applied_to(&project), project);
        let mut other = Contender::of(&project);
        other.shadow.method = ShadowMethod::OccupancyMaps;
        let changed = other.applied_to(&project);
        assert_ne!(changed, project);
        assert_eq!(Contender::of(&changed), other);
    }
}
