//! The project at a time of its timeline.

use std::borrow::Cow;

use lovelock_simulation::SimulationSettings;

use super::leaf::set_all;
use crate::{FrameSnapshot, Project};

impl Project {
    /// Whether anything of it follows the timeline.
    pub fn is_animated(&self) -> bool {
        self.timeline.tracks.iter().any(super::Track::is_active)
    }

    /// The project as it is `secs` after the start of the timeline: each track's value in its place, within its range.
    pub fn at(&self, secs: f64) -> Self {
        let mut project = self.clone();
        let active = self.timeline.tracks.iter().filter(|track| track.is_active());
        let values = active.filter_map(|track| Some((track.target.as_str(), track.value_at(secs)?)));
        let values: Vec<_> = values.collect();
        if values.is_empty() {
            return project;
        }
        set_all(&mut project, values);
        let ranged = project.in_range();
        // Only what tracks can move: the rest is the project's, to the last bit.
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

    /// The project as it is at an instant of the dance.
    pub fn seen_at(&self, snapshot: &FrameSnapshot) -> Cow<'_, Self> {
        if self.is_animated() { Cow::Owned(self.at(snapshot.position_secs)) } else { Cow::Borrowed(self) }
    }
}

/// What of the simulation follows the timeline, ready to be asked at each step.
#[derive(Clone, Debug, PartialEq)]
pub struct Animation {
    /// The simulation's tracks in a project with its settings and nothing else.
    project: Box<Project>,
}

impl Animation {
    /// The simulation's tracks of a project; none where it has none.
    pub fn of(project: &Project) -> Option<Self> {
        let of_simulation =
            |track: &&super::Track| track.is_active() && track.target.starts_with("simulation/");
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
