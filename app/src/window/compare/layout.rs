//! How the comparison is laid out: kept between runs, not part of the project.

use lovelock_panes::sheet::Sheet;
use lovelock_panes::view::{LiveShows, LiveView};
use serde::{Deserialize, Serialize};

use crate::window::theme;

/// How the comparison is laid out.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
#[expect(clippy::struct_excessive_bools, reason = "switches, each with its own button")]
pub(crate) struct CompareLayout {
    /// Whether the panes are on the screen in place of the one picture.
    pub(crate) shown: bool,
    /// Whether two panes share the page, divided by a line, in place of all in a grid.
    pub(crate) wipe: bool,
    /// The panes left and right of that line; a held key shows the second in place of the others.
    pub(crate) pair: [usize; 2],
    /// Where the line is, a share of the picture's width.
    pub(crate) split: f32,
    /// What the panes show.
    pub(crate) shows: LiveShows,
    /// What the last colour of the scale stands for.
    pub(crate) largest: f32,
    /// Whether errors are measured.
    pub(crate) measures: bool,
    /// Whether the plot of light along a ray is open.
    pub(crate) probe: bool,
    /// Whether the plots of cost are open.
    pub(crate) costs: bool,
    /// Which plot of cost.
    pub(crate) cost_plot: CostPlot,
}

/// What is plotted of the cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum CostPlot {
    /// The whole picture over the last seconds.
    #[default]
    Whole,
    /// The making of shadow maps over the last seconds.
    Build,
    /// Their asking.
    Ask,
    /// The rest of the picture.
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
            Self::Ask => "Ask",
            Self::Draw => "Draw",
            Self::ErrorTime => "Error · time",
            Self::ErrorMemory => "Error · memory",
        }
    }

    pub(crate) const fn tip(self) -> &'static str {
        match self {
            Self::Whole => "What a picture took over the last seconds, without simulation and strands.",
            Self::Build => "What making the shadow maps took over the last seconds.",
            Self::Ask => "What asking the shadow maps at all strand points took over the last seconds.",
            Self::Draw => "What the rest of the picture took over the last seconds.",
            Self::ErrorTime => {
                "Each way as a point: lower left is better. Its former settings are its trail."
            }
            Self::ErrorMemory => "The same against the memory of the shadow maps.",
        }
    }
}

impl Default for CompareLayout {
    fn default() -> Self {
        Self {
            shown: false,
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
    /// The two panes that are compared, of `panes` that there are.
    pub(crate) fn pair_of(&self, panes: usize) -> [usize; 2] {
        self.pair.map(|pane| pane.min(panes.saturating_sub(1)))
    }

    /// The panes put together into one picture as they are on the screen.
    pub(crate) fn sheet(&self) -> Sheet {
        Sheet {
            wipe: self.wipe.then_some((self.pair, self.split)),
            view: self.view(),
            figures: true,
            colors: theme::PLOT.map(theme::to_srgb),
        }
    }

    /// What the panes show.
    pub(crate) fn view(&self) -> LiveView {
        let measures = self.measures || self.shows.colors().is_some();
        LiveView { shows: self.shows, largest: self.largest, measures, light: 0 }
    }

    /// The panes that are on the screen, of `panes` that there are.
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
