//! The project at a time of its timeline.

use lovelock_base::settings::{AnySettings, Settings};
use std::borrow::Cow;

use lovelock_simulation::SimulationSettings;

use super::leaf::{set_all, set_numbers};
use crate::project::Project;
use crate::tracks::{STACK_TARGET, Track};

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
        // Only sections that tracks can change.
        if self
            .timeline
            .tracks
            .iter()
            .any(|track| track.is_active() && track.target.starts_with(STACK_TARGET))
        {
            AnySettings::clamp(&mut project.hair.stack);
        }
        let Self { look, simulation, shadow, lights, camera, picture, .. } = &mut project;
        let sections: [&mut dyn AnySettings; 5] = [look, simulation, shadow, camera, picture];
        sections.into_iter().for_each(AnySettings::clamp);
        lights.iter_mut().for_each(AnySettings::clamp);
        project
    }

    /// As [`Project::at`], without a copy if no track has an effect.
    pub fn seen_at(&self, secs: f64) -> Cow<'_, Self> {
        if self.is_animated() { Cow::Owned(self.at(secs)) } else { Cow::Borrowed(self) }
    }
}

/// The tracks of the simulation's settings, prepared for evaluation at each step.
#[derive(Clone, Debug, PartialEq)]
pub struct Animation {
    settings: SimulationSettings,
    /// Active tracks, each with the path of its target below the simulation's settings.
    tracks: Vec<(String, Track)>,
}

impl Animation {
    /// The simulation's tracks of a project; `None` if it has none.
    pub fn of(project: &Project) -> Option<Self> {
        let active = project.timeline.tracks.iter().filter(|track| track.is_active());
        let tracks: Vec<_> = active
            .filter_map(|track| {
                let below = track.target.strip_prefix("simulation/")?;
                Some((below.replace('/', "."), track.clone()))
            })
            .collect();
        (!tracks.is_empty()).then_some(Self { settings: project.simulation, tracks })
    }

    /// The settings at a time of the timeline.
    pub fn simulation_at(&self, secs: f64) -> SimulationSettings {
        let mut settings = self.settings;
        for (path, track) in &self.tracks {
            if let Some(numbers) = track.value_at(secs) {
                set_numbers(&mut settings, path, &numbers);
            }
        }
        settings.clamped()
    }
}
