//! One way to render hair among those that are compared.

use lovelock_base::settings::Choices;
use lovelock_picture::{Backend, HairDrawing, PictureSettings, Transparency};
use lovelock_shadow::ShadowSettings;
use serde::{Deserialize, Serialize};

use super::super::Project;
use crate::files::FileRef;

/// One way to render hair, or another take, among those that are compared. All other settings of the image are shared.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Contender {
    /// How hair shadows itself, with the values of every method.
    pub shadow: ShadowSettings,
    /// What hair is drawn as.
    pub draw: HairDrawing,
    /// How overlapping strands are blended.
    pub transparency: Transparency,
    /// What renders: CPU or GPU.
    pub backend: Backend,
    /// Rendered pixels per pixel of the pane along each edge.
    pub scale: f32,
    /// A take that this pane shows, at the common time, instead of what the others show.
    pub take: Option<FileRef>,
}

impl Default for Contender {
    fn default() -> Self {
        Self::of(&Project::default())
    }
}

impl Contender {
    /// The settings of `project` itself.
    pub fn of(project: &Project) -> Self {
        let PictureSettings { draw, transparency, backend, .. } = project.picture;
        Self { shadow: project.shadow, draw, transparency, backend, scale: 1.0, take: None }
    }

    /// The project with these settings.
    pub fn applied_to(&self, project: &Project) -> Project {
        let mut project = project.clone();
        self.apply_to(&mut project);
        project
    }

    /// Gives a project these settings. Everything else stays where it is in memory.
    pub fn apply_to(&self, project: &mut Project) {
        project.shadow = self.shadow;
        project.picture.draw = self.draw;
        project.picture.transparency = self.transparency;
        project.picture.backend = self.backend;
    }

    /// The main settings of the method: the size of its map, and the number of samples along the light.
    pub fn size_label(&self) -> String {
        self.shadow.size_label()
    }

    /// The settings besides the method, such as `128³ · sorted · CPU`, or `clusters · 128³ · sorted · CPU` if hair is not drawn as
    /// strands.
    pub fn settings_label(&self) -> String {
        let mut parts = vec![
            self.take_name().unwrap_or_default(),
            self.draw_label().unwrap_or_default().to_owned(),
            self.size_label(),
            self.transparency.id().to_owned(),
            backend_label(self.backend).to_owned(),
        ];
        if self.scale < 1.0 {
            parts.push(format!("{:.0} % size", 100.0 * self.scale));
        }
        parts.retain(|part| !part.is_empty());
        parts.join(" · ")
    }

    /// Whether hair is drawn as strands, at whose points transmittance is compared.
    pub fn draws_strands(&self) -> bool {
        self.draw == HairDrawing::Strands
    }

    /// What hair is drawn as, unless it is drawn as strands.
    pub fn draw_label(&self) -> Option<&'static str> {
        (!self.draws_strands()).then(|| self.draw.names().0)
    }

    /// The name of the take that is shown.
    pub fn take_name(&self) -> Option<String> {
        let file = self.take.as_ref()?;
        Some(format!("take {}", file.path.file_stem().unwrap_or_default().to_string_lossy()))
    }

    /// Method and settings, such as `Voxel map · 128³ · sorted · CPU`.
    pub fn label(&self) -> String {
        format!("{} · {}", self.shadow.method.label(), self.settings_label())
    }
}

/// The short name of a backend beside a time.
pub const fn backend_label(backend: Backend) -> &'static str {
    match backend {
        Backend::Auto => "auto",
        Backend::Gpu => "GPU",
        Backend::Cpu => "CPU",
    }
}

#[cfg(test)]
mod tests {
    use lovelock_shadow::ShadowMethod;

    use super::*;

    #[test]
    fn applying_a_projects_own_settings_changes_nothing() {
        let project = Project::default();
        assert_eq!(Contender::of(&project).applied_to(&project), project);
        let mut other = Contender::of(&project);
        other.shadow.method = ShadowMethod::OccupancyMaps;
        let changed = other.applied_to(&project);
        assert_ne!(changed, project);
        assert_eq!(Contender::of(&changed), other);
    }

    #[test]
    fn only_hair_that_is_not_drawn_as_strands_is_named() {
        let mut pane = Contender::default();
        let strands = pane.settings_label();
        assert!(!strands.contains("strands"), "{strands}");
        for (draw, name) in [(HairDrawing::Clusters, "clusters"), (HairDrawing::Auto, "auto")] {
            pane.draw = draw;
            assert_eq!(pane.settings_label(), format!("{name} · {strands}"));
            let project = pane.applied_to(&Project::default());
            assert_eq!((project.picture.draw, Contender::of(&project)), (draw, pane.clone()));
        }
    }

    #[test]
    fn a_contender_saved_without_its_drawing_draws_strands() {
        let pane: Contender = ron::from_str("(transparency: exact, scale: 0.5)").expect("an earlier file");
        assert_eq!((pane.draw, pane.scale), (HairDrawing::Strands, 0.5));
    }
}
