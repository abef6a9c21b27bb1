//! Medians and percentiles. Several definitions are in use, and each has its own function.

use std::cmp::Ordering;

/// The median, with the mean of the middle two for an even count; `None` without values. NaN counts as the largest value.
pub fn median(values: impl IntoIterator<Item = f64>) -> Option<f64> {
    let mut sorted: Vec<f64> = values.into_iter().collect();
    sorted.sort_unstable_by(f64::total_cmp);
    median_of_sorted(&sorted)
}

/// [`median`] of values that are sorted already.
pub fn median_of_sorted(sorted: &[f64]) -> Option<f64> {
    let middle = sorted.len() / 2;
    match sorted.len() {
        0 => None,
        n if n % 2 == 1 => Some(sorted[middle]),
        _ => Some(f64::midpoint(sorted[middle - 1], sorted[middle])),
    }
}

/// The median, with the larger of the middle two for an even count: always one of the values. `None` without values.
/// Reorders `values`.
pub fn upper_median_by<T: Copy>(values: &mut [T], compare: impl FnMut(&T, &T) -> Ordering) -> Option<T> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, compare).1)
}

/// The smallest finite value that at least the share `q` of all finite values does not exceed (nearest rank). `None` without
/// finite values. `q` is in 0..=1.
pub fn percentile(values: &[f32], q: f64) -> Option<f32> {
    let mut sorted: Vec<f32> = values.iter().copied().filter(|value| value.is_finite()).collect();
    let index = nearest_rank(sorted.len(), q)?;
    Some(*sorted.select_nth_unstable_by(index, f32::total_cmp).1)
}

/// The index of the share `q` among `count` sorted values, by nearest rank; `None` for a count of 0.
pub fn nearest_rank(count: usize, q: f64) -> Option<usize> {
    let rank = (q * count as f64).ceil() as usize;
    (count > 0).then(|| rank.clamp(1, count) - 1)
}

/// The value at the share `q` of the way from the smallest value (0) to the largest one (1), its index rounded down. `None`
/// without values. `q` is in 0..=1. Reorders `values`.
pub fn lower_quantile(values: &mut [f32], q: f32) -> Option<f32> {
    let last = values.len().checked_sub(1)?;
    let index = (last as f32 * q) as usize;
    Some(*values.select_nth_unstable_by(index, f32::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::{lower_quantile, median, percentile, upper_median_by};

    #[test]
    fn medians_by_hand() {
        assert_eq!(median([]), None);
        assert_eq!(median([3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median([4.0, 1.0, 2.0, 3.0]), Some(2.5));
        assert_eq!(median([f64::MAX, f64::MAX]), Some(f64::MAX));
    }

    #[test]
    fn the_upper_median_is_one_of_the_values() {
        assert_eq!(upper_median_by(&mut [], f32::total_cmp), None);
        assert_eq!(upper_median_by(&mut [3.0, 1.0, 2.0], f32::total_cmp), Some(2.0));
        assert_eq!(upper_median_by(&mut [4, 1, 2, 3], Ord::cmp), Some(3));
    }

    #[test]
    fn percentiles_by_nearest_rank_are_values_of_the_list() {
        let values: Vec<f32> = (1..=200).map(|i| i as f32).collect();
        assert_eq!(percentile(&values, 0.99), Some(198.0));
        assert_eq!(percentile(&values, 1.0), Some(200.0));
        assert_eq!(percentile(&values, 7.0), Some(200.0));
        assert_eq!(percentile(&values, -1.0), Some(1.0));
        assert_eq!(percentile(&[f32::NAN], 0.5), None);
    }

    #[test]
    fn the_lower_quantile_rounds_its_index_down() {
        let mut values = [5.0, 3.0, 1.0, 2.0, 4.0];
        assert_eq!(
            [0.0, 0.24, 0.25, 0.99, 1.0].map(|q| lower_quantile(&mut values, q)),
            [Some(1.0), Some(1.0), Some(2.0), Some(4.0), Some(5.0)]
        );
        assert_eq!(lower_quantile(&mut [], 0.5), None);
    }
}
