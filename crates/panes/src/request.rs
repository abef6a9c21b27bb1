//! What a round of panes is asked for, and what comes of it.

use std::sync::Arc;

use lovelock_project::Project;
use lovelock_project::files::Access;
use lovelock_project::project::Contender;
use lovelock_render::{Camera, FrameStats, Picture};
use lovelock_session::render_thread::Adapter;
use lovelock_session::snapshot::FrameSnapshot;

use crate::probe::ProbePlace;
use crate::view::{LiveShows, LiveView};

/// A round of panes on one instant.
#[derive(Clone, Debug)]
pub struct LiveRequest {
    /// The panes, and everything that they share.
    pub project: Arc<Project>,
    /// What panes with takes of their own may read.
    pub access: Access,
    /// The instant.
    pub snapshot: Arc<FrameSnapshot>,
    /// Which panes of the project are drawn, in this order.
    pub panes: Vec<usize>,
    /// Width of a pane, pixels.
    pub width: u32,
    /// Height of a pane, pixels.
    pub height: u32,
    /// Whether the panes are left in their slots together, when all are finished.
    pub together: bool,
    /// What they show.
    pub view: LiveView,
    /// The hair whose light is plotted.
    pub probe: Option<ProbePlace>,
}

/// What a pane took, milliseconds. Strands are made once for all panes and belong to none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LiveTimes {
    /// To make the shadow maps; none where the device does not measure its passes.
    pub build: Option<f64>,
    /// To ask them; none as above.
    pub ask: Option<f64>,
    /// The rest of the picture; none as above.
    pub draw: Option<f64>,
    /// The whole picture.
    pub whole: f64,
}

impl LiveTimes {
    /// The times of a picture.
    pub(super) fn of(stats: &FrameStats) -> Self {
        let whole = stats.shadow_ms + stats.draw_ms;
        if stats.passes.is_empty() {
            return Self { whole, ..Self::default() };
        }
        let (build, ask) = (stats.build_ms(), stats.ask_ms());
        let draw = (whole - build - ask).max(0.0);
        Self { build: Some(build), ask: Some(ask), draw: Some(draw), whole: build + ask + draw }
    }
}

/// How far the transmittance of a pane is from the exact method's, over all strand points.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum LiveError {
    /// Nobody asked.
    #[default]
    NotMeasured,
    /// The pane is the exact method itself, as the others are measured by.
    Reference,
    /// Measured.
    Measured {
        /// Root mean square.
        rmse: f64,
        /// Mean: above zero where the pane is too bright.
        bias: f64,
        /// 99th percentile of the magnitude.
        p99: f64,
    },
    /// The exact method could not be had, for the reason in the sentence.
    Refused(String),
}

impl LiveError {
    /// The root mean square, where it was measured.
    pub fn rmse(&self) -> Option<f64> {
        match self {
            Self::Measured { rmse, .. } => Some(*rmse),
            Self::NotMeasured | Self::Reference | Self::Refused(_) => None,
        }
    }
}

/// A finished pane.
#[derive(Clone, Debug)]
pub struct LivePane {
    /// What was drawn.
    pub contender: Contender,
    /// The project that it was drawn of.
    pub project: Arc<Project>,
    /// The size that was asked for, pixels.
    pub asked_size: [u32; 2],
    /// The picture; empty where there is a `problem` or a `colors_problem`.
    pub picture: Picture,
    /// Why there is no picture, in a sentence.
    pub problem: Option<String>,
    /// Why there is nothing in the colours that the view shows, in a sentence, although the pane was drawn.
    pub colors_problem: Option<String>,
    /// Where the picture was taken from.
    pub camera: Camera,
    /// [`FrameSnapshot::step`] of the instant.
    pub step: u64,
    /// [`FrameSnapshot::time_secs`] of the instant.
    pub time_secs: f64,
    /// What it took.
    pub times: LiveTimes,
    /// Bytes of the shadow maps.
    pub shadow_bytes: u64,
    /// Bytes of the drawn strands and of what is kept for the pixels.
    pub draw_bytes: u64,
    /// What drew it.
    pub adapter: Adapter,
    /// Its error.
    pub error: LiveError,
    /// Mean difference of the picture (FLIP), where the view shows it and the pane is not the reference itself.
    pub flip: Option<f64>,
    /// What the view showed.
    pub shows: LiveShows,
}

#[cfg(test)]
mod tests {
    use lovelock_render::PassTime;

    use super::*;

    #[test]
    fn a_device_that_measures_no_passes_has_no_parts_of_its_time() {
        let mut stats = FrameStats { shadow_ms: 0.0, draw_ms: 9.0, ..FrameStats::default() };
        assert_eq!(LiveTimes::of(&stats), LiveTimes { whole: 9.0, ..LiveTimes::default() });
        let pass = |name: &str, ms| PassTime { name: name.to_owned(), ms };
        stats.passes = vec![pass("shadow/fill", 2.0), pass("shadow/ask", 1.0), pass("draw/blend", 5.0)];
        stats.shadow_ms = 3.0;
        let parts = LiveTimes { build: Some(2.0), ask: Some(1.0), draw: Some(9.0), whole: 12.0 };
        assert_eq!(LiveTimes::of(&stats), parts);
    }
}
