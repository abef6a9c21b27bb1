//! The layers of the hairstyle at a time of the timeline.

use lovelock_base::settings::AnySettings;
use lovelock_style::StyleStack;

use super::leaf::set_numbers;
use crate::project::Project;
use crate::tracks::{STACK_TARGET, Track};

/// The tracks of the numbers of layers, prepared for evaluation at each step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StyleTracks {
    /// Active tracks, each with the path of its target below the stack.
    tracks: Vec<(String, Track)>,
}

impl StyleTracks {
    /// The tracks of a project; `None` if it has none.
    pub fn of(project: &Project) -> Option<Self> {
        let active = project.timeline.tracks.iter().filter(|track| track.is_active());
        let tracks: Vec<_> = active
            .filter_map(|track| {
                Some((track.target.strip_prefix(STACK_TARGET)?.replace('/', "."), track.clone()))
            })
            .collect();
        (!tracks.is_empty()).then_some(Self { tracks })
    }

    /// The numbers of the tracks at a time of the timeline. Equal numbers give equal stacks.
    pub fn values_at(&self, secs: f64) -> Vec<Vec<f64>> {
        self.tracks.iter().map(|(_, track)| track.value_at(secs).unwrap_or_default()).collect()
    }

    /// A stack with these numbers, within their ranges; numbers of layers that it lacks are left out.
    pub fn stack_with(&self, stack: &StyleStack, values: &[Vec<f64>]) -> StyleStack {
        let mut stack = stack.clone();
        for ((path, _), numbers) in self.tracks.iter().zip(values) {
            set_numbers(&mut stack, path, numbers);
        }
        AnySettings::clamp(&mut stack);
        stack
    }
}
