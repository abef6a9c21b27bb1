//! Clamps all values to their ranges, so that no file and no slider can break an image.

use lovelock_base::settings::Settings;
use lovelock_base::words::counted;
use lovelock_picture::MAX_LIGHTS;

use super::super::Project;
use super::generic::differences;
use super::sections::TimelineSection;
use crate::error::{Place, Problem, ProblemKind};

impl Project {
    /// The project with every value inside its range, and a problem for each value that was changed.
    pub fn sanitised(&self) -> (Self, Vec<Problem>) {
        let project = self.clamped();

        let mut problems = Vec::new();
        let mut note = |place, changes: Vec<String>| {
            problems
                .extend(changes.into_iter().map(|change| Problem::new(place, ProblemKind::Adjusted, change)));
        };
        note(Place::Motion, differences(&self.motion, &project.motion));
        note(Place::Hair, differences(&self.hair, &project.hair));
        note(Place::Look, differences(&self.look, &project.look));
        note(Place::Simulation, differences(&self.simulation, &project.simulation));
        note(Place::Shadow, differences(&self.shadow, &project.shadow));
        note(Place::Reference, differences(&self.reference, &project.reference));
        note(Place::Sound, differences(&self.sound, &project.sound));
        note(Place::Camera, differences(&self.camera, &project.camera));
        note(Place::Picture, differences(&self.picture, &project.picture));
        note(Place::Recording, differences(&self.recording, &project.recording));
        for (before, after) in self.compare.panes.iter().zip(&project.compare.panes) {
            note(Place::Compare, differences(before, after));
        }
        let (found, kept) = (self.compare.panes.len(), project.compare.panes.len());
        if found != kept {
            note(Place::Compare, vec![format!("found {}; {kept} kept", counted(found, "pane", "panes"))]);
        }
        let preroll_of = |timeline: &TimelineSection| TimelineSection {
            preroll_secs: timeline.preroll_secs,
            ..TimelineSection::default()
        };
        note(Place::Timeline, differences(&preroll_of(&self.timeline), &preroll_of(&project.timeline)));
        let lost = self.timeline.markers.len() - project.timeline.markers.len();
        if lost > 0 {
            note(
                Place::Timeline,
                vec![format!("left out: {} without a time, or too many", counted(lost, "marker", "markers"))],
            );
        }
        let keys =
            |project: &Self| project.timeline.tracks.iter().map(|track| track.keys.len()).sum::<usize>();
        let lost = keys(self) - keys(&project);
        if lost > 0 {
            note(
                Place::Timeline,
                vec![format!(
                    "left out: {} of tracks without a time or a value, or too many",
                    counted(lost, "key", "keys")
                )],
            );
        }
        for (before, after) in self.lights.iter().zip(&project.lights) {
            note(Place::Lights, differences(before, after));
        }
        if self.lights.len() > MAX_LIGHTS {
            let found = self.lights.len();
            note(
                Place::Lights,
                vec![format!(
                    "found {found} lights; must be at most {MAX_LIGHTS}: the first {MAX_LIGHTS} are kept"
                )],
            );
        }
        (project, problems)
    }
}
