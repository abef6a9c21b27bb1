//! Curves over time in a file.

use glam::Vec3;

use super::HairFileError;
use super::file::RawHair;

/// What a file states about its space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stated {
    pub(super) unit: bool,
    pub(super) up: bool,
}

/// The curves of a file at its times. The number of their points does not change.
pub(super) trait CurveFrames: Send {
    /// The times at which something changes, seconds, ascending; at least one.
    fn times(&self) -> &[f64];

    /// Whether points may leave the straight lines between their places at two times, because a transform turns them.
    fn bends(&self) -> bool {
        false
    }

    /// What the file states, if its format has a place for unit and up axis.
    fn stated(&self) -> Stated {
        Stated { unit: true, up: true }
    }

    /// Replaces `out` by the points of all polylines at a time, in the order of the file and in its unit and axes.
    fn points(&mut self, secs: f64, out: &mut Vec<Vec3>) -> Result<(), HairFileError>;
}

/// The curves of a file over time, or why they cannot be played although the hair at their first time can be read.
pub(super) type FramesOrReason = Result<Box<dyn CurveFrames>, HairFileError>;

/// The curves of a file over time, and the hair at their first time.
pub(super) type OpenedFrames = (FramesOrReason, RawHair);

/// Sorted times without those that are equal up to rounding.
pub(super) fn merged(mut times: Vec<f64>) -> Vec<f64> {
    times.retain(|time| time.is_finite());
    times.sort_by(f64::total_cmp);
    times.dedup_by(|later, before| *later - *before < 1e-6);
    if times.is_empty() {
        times.push(0.0);
    }
    times
}
