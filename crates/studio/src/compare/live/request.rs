//! What a round of panes is asked for, and what comes of it.

use std::sync::Arc;

use lovelock_render::{Camera, FrameStats, Picture};

use super::{LiveView, ProbePlace};
use crate::{Adapter, Contender, FrameSnapshot, Project};

/// A round of panes on one instant.
#[derive(Clone, Debug)]
pub struct LiveRequest {
    /// The panes, and everything that they share.
    pub project: Arc<Project>,
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
    /// To make the shadow maps; 0 where the device does not measure its passes.
    pub build: f64,
    /// To ask them; 0 as above.
    pub ask: f64,
    /// The rest of the picture.
    pub draw: f64,
}

impl LiveTimes {
    /// The times of a picture.
    pub(super) fn of(stats: &FrameStats) -> Self {
        let (build, ask) = (stats.build_ms(), stats.ask_ms());
        let whole = stats.shadow_ms + stats.draw_ms;
        Self { build, ask, draw: (whole - build - ask).max(0.0) }
    }

    /// The whole picture.
    pub fn whole(&self) -> f64 {
        self.build + self.ask + self.draw
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
    /// The picture; empty where there is a `problem`.
    pub picture: Picture,
    /// Why there is no picture, in a sentence.
    pub problem: Option<String>,
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
    /// Mean difference of the picture (FLIP), where the view shows it.
    pub flip: Option<f64>,
    /// What the view showed.
    pub shows: super::LiveShows,
}
