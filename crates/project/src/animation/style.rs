//! The layers of the hairstyle and its morph at a time of the timeline.

use lovelock_base::settings::AnySettings;
use lovelock_style::StyleStack;

use super::animate::active_track;
use super::leaf::set_numbers;
use crate::project::Project;
use crate::tracks::{MORPH_TARGET, STACK_TARGET, Track};

/// The tracks of the numbers of layers and of the morph, prepared for evaluation at each step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StyleTracks {
    /// Active tracks, each with the path of its target below the stack.
    tracks: Vec<(String, Track)>,
    /// The track of the morph's amount.
    morph: Option<Track>,
}

/// The numbers of [`StyleTracks`] at a time. Equal numbers give equal hairstyles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StyleValues {
    stack: Vec<Vec<f64>>,
    amount: Option<f32>,
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
        let morph = project.hair.morph.to.as_ref().and_then(|_| active_track(project, MORPH_TARGET));
        (!tracks.is_empty() || morph.is_some()).then_some(Self { tracks, morph })
    }

    /// The numbers of the tracks at a time of the timeline.
    pub fn values_at(&self, secs: f64) -> StyleValues {
        let numbers = |track: &Track| track.value_at(secs).unwrap_or_default();
        let amount = self.morph.as_ref().and_then(|track| numbers(track).first().copied());
        StyleValues {
            stack: self.tracks.iter().map(|(_, track)| numbers(track)).collect(),
            amount: amount.map(|amount| amount.clamp(0.0, 1.0) as f32),
        }
    }

    /// A stack with these numbers, within their ranges; numbers of layers that it lacks are left out.
    pub fn stack_with(&self, stack: &StyleStack, values: &StyleValues) -> StyleStack {
        let mut stack = stack.clone();
        for ((path, _), numbers) in self.tracks.iter().zip(&values.stack) {
            set_numbers(&mut stack, path, numbers);
        }
        AnySettings::clamp(&mut stack);
        stack
    }
}

impl StyleValues {
    /// The amount of the morph, 0 to 1, if it has a track.
    pub fn amount(&self) -> Option<f32> {
        self.amount
    }
}
