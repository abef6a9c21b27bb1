//! The layout of the comparison, which is stored between runs and is not part of the project.

use lovelock_panes::sheet::Sheet;
use lovelock_panes::view::{LiveShows, LiveView};
use serde::{Deserialize, Serialize};

/// The layout of the comparison.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
#[expect(clippy::struct_excessive_bools, reason = "switches, each with its own button")]
pub(crate) struct CompareLayout {
    /// Whether two panes share the page, divided by a line, instead of a grid of all panes.
    pub(crate) wipe: bool,
    /// The panes to the left and right of the line. A held key shows the second in place of the others.
    pub(crate) pair: [usize; 2],
    /// The position of the line, as a fraction of the image's width.
    pub(crate) split: f32,
    /// The quantity that the panes show.
    pub(crate) shows: LiveShows,
    /// The value of the last colour of the scale.
    pub(crate) largest: f32,
    /// Whether errors are measured.
    pub(crate) measures: bool,
    /// Whether the plot of transmittance along a ray is open.
    pub(crate) probe: bool,
    /// Whether the plots of cost are open.
    pub(crate) costs: bool,
    /// The selected plot of cost.
    pub(crate) cost_plot: CostPlot,
}

/// A plot of cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum CostPlot {
    /// The time of the whole image over the last seconds.
    #[default]
    Whole,
    /// The time to build the shadow maps over the last seconds.
    Build,
    /// The time to look up the shadow maps over the last seconds.
    Ask,
    /// The time of the rest of the image over the last seconds.
    Draw,
    /// Error against time.
    ErrorTime,
    /// Error against memory.
    ErrorMemory,
}

impl CostPlot {
    /// All of them, in their order.
    pub(crate) const ALL: [Self; 6] =
        [Self::Whole, Self::Build, Self::Ask, Self::Draw, Self::ErrorTime, Self::ErrorMemory];

    pub(crate) const fn label(self) -> &'static str {
        match self {
            Self::Whole => "Whole",
            Self::Build => "Build",
            Self::Ask => "Query",
            Self::Draw => "Draw",
            Self::ErrorTime => "Error · time",
            Self::ErrorMemory => "Error · memory",
        }
    }

    pub(crate) const fn tip(self) -> &'static str {
        match self {
            Self::Whole => {
                "Time per image over the last seconds, without simulation and interpolation of strands."
            }
            Self::Build => "Time to build the shadow maps over the last seconds.",
            Self::Ask => "Time to query the shadow maps at all strand points over the last seconds.",
            Self::Draw => "Time of the rest of the image over the last seconds.",
            Self::ErrorTime => {
                "Each variant as a point: lower left is better. Its previous settings form a trail."
            }
            Self::ErrorMemory => "Error against the memory of the shadow maps.",
        }
    }
}

impl Default for CompareLayout {
    fn default() -> Self {
        Self {
            wipe: false,
            pair: [0, 1],
            split: 0.5,
            shows: LiveShows::Picture,
            largest: 0.25,
            measures: true,
            probe: false,
            costs: false,
            cost_plot: CostPlot::default(),
        }
    }
}

impl CompareLayout {
    /// The two panes that are compared, out of `panes`.
    pub(crate) fn pair_of(&self, panes: usize) -> [usize; 2] {
        self.pair.map(|pane| pane.min(panes.saturating_sub(1)))
    }

    /// The panes composed into one image as they are on the screen.
    pub(crate) fn sheet(&self) -> Sheet {
        Sheet {
            columns: None,
            wipe: self.wipe.then_some((self.pair, self.split)),
            view: self.view(),
            figures: true,
            colors: Sheet::COLORS,
        }
    }

    /// The quantity that the panes show.
    pub(crate) fn view(&self) -> LiveView {
        let measures = self.measures || self.shows.colors().is_some();
        LiveView { shows: self.shows, largest: self.largest, measures, light: 0 }
    }

    /// The panes that are on the screen, out of `panes`.
    pub(crate) fn visible(&self, panes: usize) -> Vec<usize> {
        match (self.wipe, self.pair_of(panes)) {
            (true, [left, right]) if left == right => vec![left],
            (true, pair) => pair.to_vec(),
            (false, _) => (0..panes).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pair_is_always_of_panes_that_there_are() {
        let mut layout = CompareLayout { pair: [4, 9], wipe: true, ..CompareLayout::default() };
        assert_eq!(layout.visible(6), [4, 5]);
        assert_eq!(layout.visible(2), [1]);
        assert_eq!(layout.visible(0), [0]);
        layout.wipe = false;
        assert_eq!(layout.visible(3), [0, 1, 2]);
    }
}
