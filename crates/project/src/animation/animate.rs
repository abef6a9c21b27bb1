//! The project at a time of its timeline.

use lovelock_base::settings::{AnySettings, Settings};
use std::borrow::Cow;

use lovelock_simulation::SimulationSettings;

use super::leaf::{set_all, set_numbers};
use crate::project::Project;
use crate::styles::MovesMix;
use crate::tracks::{MORPH_TARGET, STACK_TARGET, Track};

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
        project.hair.morph.amount = project.hair.morph.amount.clamp(0.0, 1.0);
        let Self { look, simulation, shadow, lights, camera, picture, .. } = &mut project;
        let sections: [&mut dyn AnySettings; 5] = [look, simulation, shadow, camera, picture];
        sections.into_iter().for_each(AnySettings::clamp);
        lights.iter_mut().for_each(AnySettings::clamp);
        project
    }

    /// The project as it is drawn: as [`Project::at`], with the colours of the morph. Without a copy if neither has an effect.
    pub fn seen_at(&self, secs: f64) -> Cow<'_, Self> {
        let at = if self.is_animated() { Cow::Owned(self.at(secs)) } else { Cow::Borrowed(self) };
        match at.morphed_look() {
            Some(look) => {
                let mut at = at.into_owned();
                at.look = look;
                Cow::Owned(at)
            }
            None => at,
        }
    }
}

/// The tracks of the simulation's settings, prepared for evaluation at each step.
#[derive(Clone, Debug, PartialEq)]
pub struct Animation {
    settings: SimulationSettings,
    /// Active tracks, each with the path of its target below the simulation's settings.
    tracks: Vec<(String, Track)>,
    /// What the settings turn into.
    morph: Option<Morphing>,
}

/// How the settings of the simulation turn into those of another style.
#[derive(Clone, Debug, PartialEq)]
struct Morphing {
    to: MovesMix,
    amount: f32,
    track: Option<Track>,
}

impl Animation {
    /// The simulation's tracks of a project, and its morph; `None` if it has neither.
    pub fn of(project: &Project) -> Option<Self> {
        let active = project.timeline.tracks.iter().filter(|track| track.is_active());
        let tracks: Vec<_> = active
            .filter_map(|track| {
                let below = track.target.strip_prefix("simulation/")?;
                Some((below.replace('/', "."), track.clone()))
            })
            .collect();
        let morph = project.hair.morph.to.as_ref().map(|to| Morphing {
            to: MovesMix::to(&to.simulation),
            amount: project.hair.morph.amount,
            track: active_track(project, MORPH_TARGET),
        });
        let any = !tracks.is_empty() || morph.is_some();
        any.then_some(Self { settings: project.simulation, tracks, morph })
    }

    /// The settings at a time of the timeline.
    pub fn simulation_at(&self, secs: f64) -> SimulationSettings {
        let mut settings = self.settings;
        for (path, track) in &self.tracks {
            if let Some(numbers) = track.value_at(secs) {
                set_numbers(&mut settings, path, &numbers);
            }
        }
        if let Some(Morphing { to, amount, track }) = &self.morph {
            let keyed = track.as_ref().and_then(|track| track.value_at(secs)?.first().copied());
            let amount = keyed.unwrap_or(f64::from(*amount)).clamp(0.0, 1.0);
            settings = to.mixed(&settings, amount);
        }
        settings.clamped()
    }
}

/// The track of a target, if it has an effect.
pub(super) fn active_track(project: &Project, target: &str) -> Option<Track> {
    project.timeline.tracks.iter().find(|track| track.is_active() && track.target == target).cloned()
}
