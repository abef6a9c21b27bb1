//! Errors of values against a reference.

use lovelock_base::statistics::percentile;
use serde::{Deserialize, Serialize};

/// Errors of values against a reference, in the unit of the values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// Number of values compared. If it is 0, all other fields except `left_out` are 0 too.
    pub count: usize,
    /// Root mean square of the differences.
    pub rmse: f64,
    /// Mean difference, test minus reference: positive if the test is too large.
    pub bias: f64,
    /// 99th percentile of the absolute differences, by nearest rank.
    pub p99: f64,
    /// Largest absolute difference.
    pub max: f64,
    /// Number of values that could not be compared, because one of the two is missing or not finite. Values above 0 should be
    /// investigated.
    pub left_out: usize,
}

/// Errors of `test` against `truth`, value by value.
pub fn errors(test: &[f32], truth: &[f32]) -> Errors {
    let longest = test.len().max(truth.len());
    errors_of(test, truth, 0..longest)
}

/// As [`errors`], for the values with the indices `chosen` only.
pub fn errors_of(test: &[f32], truth: &[f32], chosen: impl IntoIterator<Item = usize>) -> Errors {
    let mut found = Errors::default();
    let mut sizes = Vec::new();
    let (mut sum, mut squares) = (0.0, 0.0);
    for index in chosen {
        let difference = match (test.get(index), truth.get(index)) {
            (Some(&test), Some(&truth)) => f64::from(test) - f64::from(truth),
            _ => f64::NAN,
        };
        if !difference.is_finite() {
            found.left_out += 1;
            continue;
        }
        sum += difference;
        squares += difference * difference;
        sizes.push(difference.abs() as f32);
        found.max = found.max.max(difference.abs());
    }
    found.count = sizes.len();
    let count = found.count.max(1) as f64;
    found.bias = sum / count;
    found.rmse = (squares / count).sqrt();
    found.p99 = percentile(&sizes, 0.99).map_or(0.0, f64::from);
    found
}

#[cfg(test)]
mod tests {
    use super::{Errors, errors, errors_of};

    #[test]
    fn a_ramp_of_errors_by_hand() {
        // Differences 0.01, 0.02 … 1.00 with alternating signs.
        let truth = vec![0.5; 100];
        let test: Vec<f32> =
            (1..=100).map(|i| 0.5 + if i % 2 == 0 { 0.01 } else { -0.01 } * i as f32).collect();
        let found = errors(&test, &truth);
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-6, "{a} is not {b}");
        assert_eq!((found.count, found.left_out), (100, 0));
        // The sum of squares of 1 to 100 is 338350; the alternating sum is 50.
        near(found.rmse, 33.835_f64.sqrt() / 10.0);
        near(found.bias, 0.5 / 100.0);
        near(found.p99, 0.99);
        near(found.max, 1.0);
        let even = errors_of(&test, &truth, (0..100).filter(|i| i % 2 == 1));
        near(even.bias, 0.51);
        assert_eq!(even.count, 50);
    }

    #[test]
    fn an_offset_is_bias_and_noise_is_not() {
        let truth: Vec<f32> = (0..64).map(|i| i as f32 / 64.0).collect();
        let offset: Vec<f32> = truth.iter().map(|t| t - 0.25).collect();
        let found = errors(&offset, &truth);
        assert!((found.bias + 0.25).abs() < 1e-6 && (found.rmse - 0.25).abs() < 1e-6, "{found:?}");
        let noise: Vec<f32> =
            truth.iter().enumerate().map(|(i, t)| t + if i % 2 == 0 { 0.25 } else { -0.25 }).collect();
        let found = errors(&noise, &truth);
        assert!(found.bias.abs() < 1e-6 && (found.rmse - 0.25).abs() < 1e-6, "{found:?}");
        // Negative control: the reference has no error.
        assert_eq!(errors(&truth, &truth), Errors { count: 64, ..Errors::default() });
    }

    #[test]
    fn what_cannot_be_compared_is_counted() {
        let found = errors(&[0.0, f32::NAN, 1.0, 4.0], &[1.0, 0.0, f32::INFINITY]);
        assert_eq!((found.count, found.left_out, found.rmse), (1, 3, 1.0));
        assert_eq!(errors(&[], &[]), Errors::default());
    }
}
