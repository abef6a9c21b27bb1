//! Medians and percentiles.

use serde::{Deserialize, Serialize};

/// The middle of many measurements and how far they spread.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Half of the values lie on either side.
    pub median: f64,
    /// The 10th percentile.
    pub low: f64,
    /// The 90th percentile.
    pub high: f64,
    /// How many values there were.
    pub count: usize,
}

impl Spread {
    /// The spread of all finite values; `None` where there is none.
    pub fn of(values: &[f64]) -> Option<Self> {
        let mut sorted: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let at = |q| nearest_rank(sorted.len(), q).map(|index| sorted[index]);
        let middle = sorted.len() / 2;
        let median = if sorted.len() % 2 == 1 {
            sorted[middle]
        } else {
            // Halved before they are added: the sum of the largest numbers is not finite.
            sorted.get(middle.wrapping_sub(1))? / 2.0 + sorted[middle] / 2.0
        };
        Some(Self { median, low: at(0.1)?, high: at(0.9)?, count: sorted.len() })
    }
}

/// The finite value that the share `q` of all finite values does not exceed, by nearest rank; `None` where there is
/// none. `q` is in 0..=1.
pub fn percentile(values: &[f32], q: f64) -> Option<f32> {
    let mut sorted: Vec<f32> = values.iter().copied().filter(|value| value.is_finite()).collect();
    let index = nearest_rank(sorted.len(), q)?;
    Some(*sorted.select_nth_unstable_by(index, f32::total_cmp).1)
}

/// The index of the share `q` among `count` sorted values.
pub(crate) fn nearest_rank(count: usize, q: f64) -> Option<usize> {
    let rank = (q * count as f64).ceil() as usize;
    (count > 0).then(|| rank.clamp(1, count) - 1)
}

#[cfg(test)]
mod tests {
    use super::{Spread, percentile};

    #[test]
    fn spreads_by_hand() {
        let values: Vec<f64> = (1..=30).rev().map(f64::from).collect();
        assert_eq!(Spread::of(&values), Some(Spread { median: 15.5, low: 3.0, high: 27.0, count: 30 }));
        assert_eq!(Spread::of(&[7.0, f64::NAN]), Some(Spread { median: 7.0, low: 7.0, high: 7.0, count: 1 }));
        assert_eq!(Spread::of(&[]), None);
        // A single stray value moves the mean, not the median.
        assert_eq!(Spread::of(&[1.0, 1.0, 1e9]).unwrap().median, 1.0);
    }

    #[test]
    fn percentiles_take_a_value_that_is_there() {
        let values: Vec<f32> = (1..=200).map(|i| i as f32).collect();
        assert_eq!(percentile(&values, 0.99), Some(198.0));
        assert_eq!(percentile(&values, 1.0), Some(200.0));
        assert_eq!(percentile(&values, 7.0), Some(200.0));
        assert_eq!(percentile(&values, -1.0), Some(1.0));
        assert_eq!(percentile(&[f32::NAN], 0.5), None);
    }
}
