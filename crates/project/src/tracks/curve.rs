//! Interpolation between keys, thinning and smoothing.

use super::section::{Key, Track};

/// Tolerance of thinning, as a fraction of the range of the keys' values.
const THINNED: f64 = 0.002;
/// Standard deviation of the Gaussian window for smoothing, seconds.
const SMOOTH_SECS: f64 = 0.1;
/// Interval at which a track is sampled for smoothing, seconds.
const SAMPLE_SECS: f64 = 1.0 / 60.0;

/// The value at a time: that of the key before it if `held`, otherwise linear from key to key, which is also what thinning assumes.
pub(crate) fn value_at(keys: &[Key], secs: f64, held: bool) -> Option<Vec<f64>> {
    let (first, last) = (keys.first()?, keys.last()?);
    // NaN gives the first value.
    if secs.is_nan() || secs <= first.secs {
        return Some(first.value.clone());
    }
    if secs >= last.secs {
        return Some(last.value.clone());
    }
    let i = keys.partition_point(|key| key.secs <= secs) - 1;
    let (a, b) = (&keys[i], &keys[i + 1]);
    if held {
        return Some(a.value.clone());
    }
    let length = b.secs - a.secs;
    if length <= 0.0 {
        return Some(b.value.clone());
    }
    let t = (secs - a.secs) / length;
    Some(a.value.iter().zip(&b.value).map(|(from, to)| from + (to - from) * t).collect())
}

/// Removes keys that linear interpolation between their neighbours reproduces within [`THINNED`]
/// (Ramer 1972; Douglas and Peucker 1973, measured in value and not in distance).
pub(crate) fn thinned(keys: &[Key]) -> Vec<Key> {
    thinned_by(keys, THINNED)
}

/// As [`thinned`], but raises the tolerance until at most `most` keys are left (two or more).
pub(crate) fn thinned_to(keys: &[Key], most: usize) -> Vec<Key> {
    let mut share = THINNED;
    loop {
        let fewer = thinned_by(keys, share);
        // A tolerance of 1 is the whole range, so only the ends are left.
        if fewer.len() <= most || share > 1.0 {
            return fewer;
        }
        share *= 2.0;
    }
}

/// Thins with a tolerance of `share` times the range of the keys' values.
fn thinned_by(keys: &[Key], share: f64) -> Vec<Key> {
    let Some(width) = keys.first().map(|key| key.value.len()) else { return Vec::new() };
    let allowed: Vec<f64> = (0..width)
        .map(|n| {
            let values = || keys.iter().map(|key| key.value[n]);
            let (low, high) =
                (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
            (share * (high - low)).max(1e-9 * high.abs().max(low.abs()))
        })
        .collect();
    let mut keep = vec![false; keys.len()];
    (keep[0], keep[keys.len() - 1]) = (true, true);
    let mut open = vec![(0, keys.len() - 1)];
    while let Some((from, to)) = open.pop() {
        let (a, b) = (&keys[from], &keys[to]);
        let far = |key: &Key| {
            let t = (key.secs - a.secs) / (b.secs - a.secs).max(1e-12);
            let of = |n: usize| {
                (a.value[n] + t * (b.value[n] - a.value[n]) - key.value[n]).abs() / allowed[n].max(1e-300)
            };
            (0..width).map(of).fold(0.0, f64::max)
        };
        let worst = (from + 1..to).map(|i| (i, far(&keys[i]))).max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((i, far)) = worst
            && far > 1.0
        {
            keep[i] = true;
            open.extend([(from, i), (i, to)]);
        }
    }
    keys.iter().zip(keep).filter(|(_, keep)| *keep).map(|(key, _)| key.clone()).collect()
}

/// The track filtered with a Gaussian window; its ends stay unchanged.
pub(crate) fn smoothed(keys: &[Key]) -> Vec<Key> {
    let (Some(first), Some(last)) = (keys.first(), keys.last()) else { return Vec::new() };
    let length = last.secs - first.secs;
    if keys.len() < 3 || length < 2.0 * SAMPLE_SECS {
        return keys.to_vec();
    }
    // No more samples than a track may have keys: a long track is sampled in larger steps.
    let count = ((length / SAMPLE_SECS).ceil() as usize).min(Track::MAX_KEYS - 1);
    let step = length / count as f64;
    let at = |i: usize| first.secs + step * i as f64;
    let samples: Vec<Vec<f64>> = (0..=count).filter_map(|i| value_at(keys, at(i), false)).collect();
    let reach = ((3.0 * SMOOTH_SECS / step).ceil() as usize).min(count);
    let weight = |d: usize| (-0.5 * (d as f64 * step / SMOOTH_SECS).powi(2)).exp();
    let smooth = |i: usize| -> Vec<f64> {
        // Narrower near the ends, which stay unchanged.
        let reach = reach.min(i).min(count - i);
        let near = i - reach..=i + reach;
        let total: f64 = near.clone().map(|j| weight(j.abs_diff(i))).sum();
        let sum = |n: usize| near.clone().map(|j| weight(j.abs_diff(i)) * samples[j][n]).sum::<f64>();
        (0..first.value.len()).map(|n| sum(n) / total).collect()
    };
    let dense: Vec<Key> = (0..=count).map(|i| Key { secs: at(i), value: smooth(i) }).collect();
    thinned(&dense)
}
