//! The project at a time of its timeline.

use lovelock_base::settings::Settings;
use std::borrow::Cow;

use lovelock_simulation::SimulationSettings;

use super::leaf::set_all;
use crate::project::Project;
use crate::tracks::Track;

impl Project {
    /// Whether any track has an effect.
    pub fn is_animated(&self) -> bool {
        self.timeline.tracks.iter().any(Track::is_active)
    }

    /// The project `secs` after the start of the timeline: the value of each track replaces the project's, within its range.
    pub fn at(&self, secs: f64) -> Self {
        let mut project = self.clone();
        let active = self.timeline.tracks.iter().filter(|track| track.is_active());
        let values = active.filter_map(|track| Some((track.target.as_str(), track.value_at(secs)?)));
        let values: Vec<_> = values.collect();
        if values.is_empty() {
            return project;
        }
        set_all(&mut project, values);
        let ranged = project.clamped();
        // Only sections that tracks can change; the rest is copied bit for bit.
        Self {
            look: ranged.look,
            simulation: ranged.simulation,
            shadow: ranged.shadow,
            lights: ranged.lights,
            camera: ranged.camera,
            picture: ranged.picture,
            ..project
        }
    }

    /// As [`Project::at`], without a copy if no track has an effect.
    pub fn seen_at(&self, secs: f64) -> Cow<'_, Self> {
        if self.is_animated() { Cow::Owned(self.at(secs)) } else { Cow::Borrowed(self) }
    }
}

/// The tracks of the simulation's settings, prepared for evaluation at each step.
#[derive(Clone, Debug, PartialEq)]
pub struct Animation {
    /// A project with nothing but the simulation's settings and tracks.
    project: Box<Project>,
}

impl Animation {
    /// The simulation's tracks of a project; `None` if it has none.
    pub fn of(project: &Project) -> Option<Self> {
        let of_simulation = |track: &&Track| track.is_active() && track.target.starts_with("simulation/");
        let tracks: Vec<_> = project.timeline.tracks.iter().filter(of_simulation).cloned().collect();
        if tracks.is_empty() {
            return None;
        }
        let mut alone = Project { simulation: project.simulation, ..Project::default() };
        alone.timeline.tracks = tracks;
        Some(Self { project: Box::new(alone) })
    }

    /// The settings at a time of the timeline.
    pub fn simulation_at(&self, secs: f64) -> SimulationSettings {
        let tracks = &self.project.timeline.tracks;
        let values = tracks.iter().filter_map(|track| Some((track.target.as_str(), track.value_at(secs)?)));
        let mut project = Project { simulation: self.project.simulation, ..Project::default() };
        set_all(&mut project, values);
        project.simulation.clamped()
    }
}
