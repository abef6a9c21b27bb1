//! Requests for panes, and finished panes.

use std::sync::Arc;

use lovelock_project::Project;
use lovelock_project::files::Access;
use lovelock_project::project::Contender;
use lovelock_render::{Camera, FrameStats, Image};
use lovelock_session::render_thread::Adapter;
use lovelock_session::snapshot::FrameSnapshot;

use crate::probe::ProbePlace;
use crate::view::{LiveShows, LiveView};

/// A request for panes at one instant.
#[derive(Clone, Debug)]
pub struct LiveRequest {
    /// The project with the panes and all shared settings.
    pub project: Arc<Project>,
    /// The files that panes with their own takes may read.
    pub access: Access,
    /// The instant.
    pub snapshot: Arc<FrameSnapshot>,
    /// Numbers of the panes to render, in this order.
    pub panes: Vec<usize>,
    /// Width of a pane, pixels.
    pub width: u32,
    /// Height of a pane, pixels.
    pub height: u32,
    /// Whether the panes are published together when all are finished.
    pub together: bool,
    /// What they show.
    pub view: LiveView,
    /// The hair to probe.
    pub probe: Option<ProbePlace>,
}

/// Times of a pane, milliseconds: those of an image while everything moves. What a renderer keeps while nothing moves counts with the
/// time that it took when it was last made. Strands are interpolated once for all panes and not counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LiveTimes {
    /// Building the shadow maps; `None` if the device does not measure passes.
    pub build: Option<f64>,
    /// Looking them up; `None` as above.
    pub ask: Option<f64>,
    /// The rest of the image; `None` as above.
    pub draw: Option<f64>,
    /// The whole image.
    pub whole: f64,
}

impl LiveTimes {
    /// The times of an image.
    pub(super) fn of(stats: &FrameStats) -> Self {
        let stats = stats.made_anew();
        let whole = stats.shadow_ms + stats.draw_ms;
        if stats.passes.is_empty() {
            return Self { whole, ..Self::default() };
        }
        let (build, ask) = (stats.build_ms(), stats.query_ms());
        let draw = (whole - build - ask).max(0.0);
        Self { build: Some(build), ask: Some(ask), draw: Some(draw), whole: build + ask + draw }
    }
}

impl LiveTimes {
    /// These times with a whole time that became known later. Without times of passes everything else stays unknown.
    #[must_use]
    pub fn with_whole(self, whole: f64) -> Self {
        let draw = self.build.zip(self.ask).map(|(build, ask)| (whole - build - ask).max(0.0));
        Self { draw, whole, ..self }
    }
}

/// Error of a pane's transmittance against the exact method, over all strand points.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum LiveError {
    /// Not requested.
    #[default]
    NotMeasured,
    /// The pane is the reference itself.
    Reference,
    /// Measured.
    Measured {
        /// Root mean square.
        rmse: f64,
        /// Mean; positive if the pane is too bright.
        bias: f64,
        /// 99th percentile of the magnitude.
        p99: f64,
    },
    /// There is no reference, for the given reason.
    Refused(String),
}

impl LiveError {
    /// The root mean square, if it was measured.
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
    /// The settings of the pane.
    pub contender: Contender,
    /// The project that it shows.
    pub project: Arc<Project>,
    /// The requested size, pixels.
    pub asked_size: [u32; 2],
    /// The image; empty if there is a `problem` or a `colors_problem`. On the window's device it may still be drawn; later commands of
    /// the window wait for it there.
    pub image: Image,
    /// Why there is no image, as a sentence.
    pub problem: Option<String>,
    /// Why there are no false colours although the pane was rendered, as a sentence.
    pub colors_problem: Option<String>,
    /// The camera of the image.
    pub camera: Camera,
    /// [`FrameSnapshot::step`] of the instant.
    pub step: u64,
    /// [`FrameSnapshot::time_secs`] of the instant.
    pub time_secs: f64,
    /// The times.
    pub times: LiveTimes,
    /// Bytes of the shadow maps.
    pub shadow_bytes: u64,
    /// Records of the shadow maps that are read in a simpler way.
    pub shadow_fallbacks: u64,
    /// Bytes of the rendered strands and of the pixel buffers.
    pub draw_bytes: u64,
    /// The device that rendered it.
    pub adapter: Adapter,
    /// Its error.
    pub error: LiveError,
    /// Mean difference of the image (FLIP), if the view shows it and the pane is not the reference.
    pub flip: Option<f64>,
    /// What the image shows.
    pub shows: LiveShows,
}

#[cfg(test)]
mod tests {
    use lovelock_render::PassTime;

    use super::*;

    #[test]
    fn without_pass_times_only_the_whole_time_is_known() {
        let mut stats = FrameStats { shadow_ms: 0.0, draw_ms: 9.0, ..FrameStats::default() };
        assert_eq!(LiveTimes::of(&stats), LiveTimes { whole: 9.0, ..LiveTimes::default() });
        let pass = |name: &str, ms| PassTime { name: name.to_owned(), ms };
        stats.passes = vec![pass("shadow/fill", 2.0), pass("shadow/ask", 1.0), pass("draw/blend", 5.0)];
        stats.shadow_ms = 3.0;
        let parts = LiveTimes { build: Some(2.0), ask: Some(1.0), draw: Some(9.0), whole: 12.0 };
        assert_eq!(LiveTimes::of(&stats), parts);
    }
}
