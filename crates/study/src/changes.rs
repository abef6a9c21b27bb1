//! Temporal stability of a method, as part of its report.

use lovelock_metrics::{excess, flicker, pop};
use serde::{Deserialize, Serialize};

/// Temporal stability of a method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StabilityReport {
    /// Standard deviation of transmittance under shifts of the map by less than a texel, root mean square over points and
    /// over [`CompareReport::swim_frames`](crate::report::CompareReport::swim_frames); null in a quick comparison.
    pub swim: Option<f64>,
    /// 99th percentile over the points of each point's deviation over these frames.
    pub swim_p99: Option<f64>,
    /// Largest change of transmittance at a point from one frame to the next; null for a single frame.
    pub pop: Option<f64>,
    /// 99th percentile of that over points.
    pub pop_p99: Option<f64>,
    /// Root mean square difference between the frame-to-frame changes of the method and of the reference; null for a single frame.
    pub flicker: Option<f64>,
    /// Root mean square error of transmittance over all frames and points, against the method's own texels; null for a single frame.
    #[serde(default)]
    pub film_rmse: Option<f64>,
}

/// Changes from frame to frame in a test where little or nothing should change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ChangeReport {
    /// Number of steps from one frame to the next.
    pub steps: u32,
    /// Number of evaluated points.
    pub points: u64,
    /// The largest change of transmittance at a point from one frame to the next.
    pub pop: f64,
    /// The same for the ground truth; null if it is unknown, as all below.
    pub truth_pop: Option<f64>,
    /// Root mean square change of the ground truth, over points and steps.
    pub truth_rms: Option<f64>,
    /// The largest difference at a point between the changes of the method and of the ground truth.
    pub excess: Option<f64>,
    /// Root mean square of that, over points and steps.
    pub jitter: Option<f64>,
}

impl ChangeReport {
    /// Compares `frames` (transmittance of the same points in each) with the ground truth of the same frames.
    pub(crate) fn new(frames: &[Vec<f32>], truth: Option<&Vec<Vec<f32>>>) -> Self {
        let still = |frames: &[Vec<f32>]| vec![frames.first().cloned().unwrap_or_default(); frames.len()];
        Self {
            steps: frames.len().saturating_sub(1) as u32,
            points: frames.first().map_or(0, Vec::len) as u64,
            pop: pop(frames).max,
            truth_pop: truth.map(|truth| pop(truth).max),
            truth_rms: truth.map(|truth| flicker(truth, &still(truth)).rms),
            excess: truth.map(|truth| excess(frames, truth).max),
            jitter: truth.map(|truth| flicker(frames, truth).rms),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_compared_with_those_of_the_ground_truth() {
        // The ground truth falls by 0.1 per frame, the method by 0.1 and once by 0.3 at one of two points.
        let truth: Vec<Vec<f32>> = (0..5).map(|i| vec![0.9 - 0.1 * i as f32; 2]).collect();
        let mut test = truth.clone();
        test.iter_mut().skip(3).for_each(|values| values[1] -= 0.2);
        let found = ChangeReport::new(&test, Some(&truth));
        let close = |a: Option<f64>, b: f64| a.is_some_and(|a| (a - b).abs() < 1e-6);
        assert_eq!((found.steps, found.points), (4, 2));
        assert!(close(Some(found.pop), 0.3) && close(found.truth_pop, 0.1), "{found:?}");
        assert!(close(found.truth_rms, 0.1) && close(found.excess, 0.2), "{found:?}");
        // One of eight changes is off by 0.2.
        assert!(close(found.jitter, 0.2 / 8.0_f64.sqrt()), "{found:?}");
        // Negative control: the ground truth itself.
        let same = ChangeReport::new(&truth, Some(&truth));
        assert!(same.excess == Some(0.0) && same.jitter == Some(0.0) && same.pop > 0.09);
        let unknown = ChangeReport::new(&test, None);
        assert_eq!((unknown.pop, unknown.excess, unknown.truth_pop), (found.pop, None, None));
        assert_eq!(ChangeReport::new(&[], Some(&Vec::new())).steps, 0);
    }
}
