//! The spread of measurements.

use lovelock_base::statistics::{median_of_sorted, nearest_rank};
use serde::{Deserialize, Serialize};

/// Median and spread of measurements.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// The median.
    pub median: f64,
    /// The 10th percentile.
    pub low: f64,
    /// The 90th percentile.
    pub high: f64,
    /// Number of values.
    pub count: usize,
}

impl Spread {
    /// The spread of all finite values; `None` if there are none.
    pub fn of(values: &[f64]) -> Option<Self> {
        let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let at = |q| nearest_rank(sorted.len(), q).map(|index| sorted[index]);
        Some(Self { median: median_of_sorted(&sorted)?, low: at(0.1)?, high: at(0.9)?, count: sorted.len() })
    }
}

#[cfg(test)]
mod tests {
    use super::Spread;

    #[test]
    fn spreads_by_hand() {
        let values: Vec<f64> = (1..=30).rev().map(f64::from).collect();
        assert_eq!(Spread::of(&values), Some(Spread { median: 15.5, low: 3.0, high: 27.0, count: 30 }));
        assert_eq!(Spread::of(&[7.0, f64::NAN]), Some(Spread { median: 7.0, low: 7.0, high: 7.0, count: 1 }));
        assert_eq!(Spread::of(&[]), None);
        // A single outlier changes the mean, but not the median.
        assert_eq!(Spread::of(&[1.0, 1.0, 1e9]).unwrap().median, 1.0);
    }
}
