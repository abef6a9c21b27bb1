//! Temporal stability of values that should not change, or should change only as the reference does.

use lovelock_base::statistics::percentile;
use serde::{Deserialize, Serialize};

/// How much values change over time, over all points and at each point.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stability {
    /// Root mean square over the points.
    pub rms: f64,
    /// Mean over the points.
    pub mean: f64,
    /// 99th percentile over the points, by nearest rank.
    pub p99: f64,
    /// Largest value of all points.
    pub max: f64,
    /// The number of each point; NaN if a value was not finite. Not serialised.
    #[serde(skip)]
    pub per_point: Vec<f32>,
}

impl Stability {
    fn of(per_point: Vec<f32>) -> Self {
        let finite = || per_point.iter().filter(|value| value.is_finite()).map(|&value| f64::from(value));
        let count = finite().count().max(1) as f64;
        Self {
            rms: (finite().map(|value| value * value).sum::<f64>() / count).sqrt(),
            mean: finite().sum::<f64>() / count,
            p99: percentile(&per_point, 0.99).map_or(0.0, f64::from),
            max: finite().fold(0.0, f64::max),
            per_point,
        }
    }
}

/// Number of points that all frames have.
fn points<'a>(frames: impl IntoIterator<Item = &'a Vec<f32>>) -> usize {
    frames.into_iter().map(Vec::len).min().unwrap_or(0)
}

/// Swim: at each point the standard deviation of its values when the map is shifted by less than a texel; one list of
/// values per shift. The hair is the same for all shifts, so an ideal method has 0. The number to quote is `rms`.
pub fn swim(shifts: &[Vec<f32>]) -> Stability {
    let count = shifts.len().max(1) as f64;
    let deviation = |point: usize| {
        let values = || shifts.iter().map(|values| f64::from(values[point]));
        let mean = values().sum::<f64>() / count;
        (values().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt() as f32
    };
    Stability::of((0..points(shifts)).map(deviation).collect())
}

impl Stability {
    /// Combines the results of several frames: at each point the root mean square of its numbers.
    pub fn over_frames(frames: &[Self]) -> Self {
        let count = frames.len().max(1) as f64;
        let squared =
            |point: usize| frames.iter().map(move |frame| f64::from(frame.per_point[point]).powi(2));
        let points = points(frames.iter().map(|frame| &frame.per_point));
        Self::of((0..points).map(|point| (squared(point).sum::<f64>() / count).sqrt() as f32).collect())
    }
}

/// Pop: at each point the largest change from one frame to the next. The number to quote is `max`, or `p99` if the hair
/// itself moves.
pub fn pop(frames: &[Vec<f32>]) -> Stability {
    let largest = |point: usize| {
        let steps = frames.windows(2).map(|pair| (pair[1][point] - pair[0][point]).abs());
        steps.fold(0.0, nan_or_larger)
    };
    Stability::of((0..points(frames)).map(largest).collect())
}

/// Flicker: at each point the root mean square, over all steps from frame to frame, of the difference between its change and
/// the reference's change. The number to quote is `rms`.
pub fn flicker(test: &[Vec<f32>], reference: &[Vec<f32>]) -> Stability {
    let frames = test.len().min(reference.len());
    let (test, reference) = (&test[..frames], &reference[..frames]);
    let steps = frames.saturating_sub(1).max(1) as f64;
    let own = |point: usize| {
        let change = |pair: &[Vec<f32>]| f64::from(pair[1][point]) - f64::from(pair[0][point]);
        let both = test.windows(2).zip(reference.windows(2));
        (both.map(|(test, truth)| (change(test) - change(truth)).powi(2)).sum::<f64>() / steps).sqrt() as f32
    };
    Stability::of((0..points(test.iter().chain(reference))).map(own).collect())
}

/// Excess: at each point the largest difference, over all steps from frame to frame, between its change and the
/// reference's change. The number to quote is `max`.
pub fn excess(test: &[Vec<f32>], reference: &[Vec<f32>]) -> Stability {
    let largest = |point: usize| {
        let both = test.windows(2).zip(reference.windows(2));
        let change = |pair: &[Vec<f32>]| pair[1][point] - pair[0][point];
        both.map(|(test, truth)| (change(test) - change(truth)).abs()).fold(0.0, nan_or_larger)
    };
    let frames = test.len().min(reference.len());
    Stability::of((0..points(test[..frames].iter().chain(&reference[..frames]))).map(largest).collect())
}

/// The larger of two numbers, or NaN if either is NaN, which `f32::max` would hide.
fn nan_or_larger(a: f32, b: f32) -> f32 {
    if a.is_nan() || b.is_nan() { f32::NAN } else { a.max(b) }
}

#[cfg(test)]
mod tests {
    use super::{Stability, excess, flicker, pop, swim};

    #[test]
    fn swim_is_the_deviation_under_shifts() {
        // Two values at distance d have the standard deviation d / 2.
        let found = swim(&[vec![0.2, 0.5, 0.9], vec![0.6, 0.5, 0.3]]);
        let expected = [0.2, 0.0, 0.3];
        assert!((0..3).all(|i| (found.per_point[i] - expected[i]).abs() < 1e-6), "{found:?}");
        assert!((found.rms - (0.13_f64 / 3.0).sqrt()).abs() < 1e-7, "{found:?}");
        assert!((found.max - 0.3).abs() < 1e-7);
        // Negative control: nothing changes.
        assert_eq!(swim(&[vec![0.3; 4], vec![0.3; 4]]).max, 0.0);
    }

    #[test]
    fn swim_of_a_sine_is_its_amplitude_over_the_root_of_two() {
        let shift = |i: i32| vec![0.5 + 0.1 * (std::f32::consts::TAU * i as f32 / 6.0).sin()];
        let found = swim(&(0..6).map(shift).collect::<Vec<_>>());
        assert!((found.rms - 0.1 / 2.0_f64.sqrt()).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn pop_is_the_largest_step_and_not_the_whole_way() {
        let ramp: Vec<_> = (0..11).map(|i| vec![i as f32 * 0.1, if i < 5 { 0.0 } else { 0.7 }]).collect();
        let found = pop(&ramp);
        assert!((found.per_point[0] - 0.1).abs() < 1e-6 && (found.per_point[1] - 0.7).abs() < 1e-6);
        assert!((found.max - 0.7).abs() < 1e-6);
        assert_eq!(pop(&ramp[..1]).max, 0.0);
    }

    #[test]
    fn flicker_is_the_change_that_the_reference_lacks() {
        let truth: Vec<_> = (0..9).map(|i| vec![(i as f32 * 0.7).sin(); 3]).collect();
        // A constant offset is an error, but not flicker.
        let offset: Vec<_> = truth.iter().map(|v| v.iter().map(|t| t + 0.2).collect()).collect();
        assert!(flicker(&offset, &truth).max < 1e-6);
        // Alternating by 0.1 up and down: each step differs by 0.2 from the reference's.
        let shaken: Vec<Vec<f32>> = (truth.iter().enumerate())
            .map(|(i, v)| v.iter().map(|t| t + if i % 2 == 0 { 0.1 } else { -0.1 }).collect())
            .collect();
        assert!((flicker(&shaken, &truth).rms - 0.2).abs() < 1e-6);
        // Constant values flicker too if the reference changes.
        let still = vec![vec![0.0; 3]; 9];
        assert!(flicker(&still, &truth).rms > 0.3);
    }

    #[test]
    fn excess_is_the_largest_step_that_the_reference_lacks() {
        let truth: Vec<_> = (0..9).map(|i| vec![(i as f32 * 0.7).sin(); 2]).collect();
        let mut test = truth.clone();
        // A constant error is a step only where it begins; the second point follows the reference.
        test.iter_mut().skip(4).for_each(|values| values[0] += 0.2);
        let found = excess(&test, &truth);
        assert!((found.per_point[0] - 0.2).abs() < 1e-6 && found.per_point[1] < 1e-6, "{found:?}");
        // Negative control: the largest change alone does not separate the two points as clearly.
        assert!(pop(&test).per_point[1] > 0.5);
        assert!(pop(&truth).max > 0.5 && excess(&truth, &truth).max < 1e-9);
    }

    #[test]
    fn frames_have_equal_weight() {
        let frame = |a: f32| swim(&[vec![0.0, 0.3], vec![2.0 * a, 0.3]]);
        // Deviations of 0.3 and 0.4 at the first point and none at the second.
        let found = Stability::over_frames(&[frame(0.3), frame(0.4)]);
        let expected = 0.125_f64.sqrt();
        assert!(
            (f64::from(found.per_point[0]) - expected).abs() < 1e-6 && found.per_point[1] == 0.0,
            "{found:?}"
        );
        assert!((found.rms - expected / 2.0_f64.sqrt()).abs() < 1e-6);
        // A single frame stays as it is; without frames the result is empty.
        assert_eq!(Stability::over_frames(&[frame(0.3)]), frame(0.3));
        assert_eq!(Stability::over_frames(&[]), Stability::default());
    }

    #[test]
    fn ragged_empty_and_broken_frames() {
        assert_eq!(swim(&[]), Stability::default());
        assert_eq!(flicker(&[vec![1.0]], &[]), Stability::default());
        assert_eq!(swim(&[vec![0.0, 1.0], vec![0.0]]).per_point.len(), 1);
        let found = pop(&[vec![0.0, f32::NAN], vec![0.5, 0.0], vec![0.5, 0.0]]);
        assert!(found.per_point[1].is_nan() && found.max == 0.5 && found.rms == 0.5, "{found:?}");
    }
}
