//! What lies between keys, and keys that say the same in fewer.

use super::{Key, Track};

/// How far a thinned track may be from what was moved, as a share of the range that it moves over.
const THINNED: f64 = 0.002;
/// Half the width of the window that smooths, as the deviation of a Gaussian, seconds.
const SMOOTH_SECS: f64 = 0.1;
/// Distance of the points at which a track is read to be smoothed, seconds.
const SAMPLE_SECS: f64 = 1.0 / 60.0;

/// The value at a time: straight from key to key, so that a track is what the hand did and what thinning keeps.
pub(super) fn value_at(keys: &[Key], secs: f64) -> Option<Vec<f64>> {
    let (first, last) = (keys.first()?, keys.last()?);
    // Not a number goes to the start.
    if secs.is_nan() || secs <= first.secs {
        return Some(first.value.clone());
    }
    if secs >= last.secs {
        return Some(last.value.clone());
    }
    let i = keys.partition_point(|key| key.secs <= secs) - 1;
    let (a, b) = (&keys[i], &keys[i + 1]);
    let length = b.secs - a.secs;
    if length <= 0.0 {
        return Some(b.value.clone());
    }
    let t = (secs - a.secs) / length;
    Some(a.value.iter().zip(&b.value).map(|(from, to)| from + (to - from) * t).collect())
}

/// Fewer keys that say the same: a key goes where the way between its neighbours passes it by closely
/// (Ramer 1972; Douglas and Peucker 1973, in value and not in distance).
pub(super) fn thinned(keys: &[Key]) -> Vec<Key> {
    thinned_by(keys, THINNED)
}

/// As [`thinned`], and as much further as it takes to have `most` keys at most, two or more.
pub(super) fn thinned_to(keys: &[Key], most: usize) -> Vec<Key> {
    let mut share = THINNED;
    loop {
        let fewer = thinned_by(keys, share);
        // A share of one is the whole range: only the ends are left.
        if fewer.len() <= most || share > 1.0 {
            return fewer;
        }
        share *= 2.0;
    }
}

/// `share` of the range that the keys move over is what they may be off.
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

/// The track after a Gaussian window; its ends stay where they are.
pub(super) fn smoothed(keys: &[Key]) -> Vec<Key> {
    let (Some(first), Some(last)) = (keys.first(), keys.last()) else { return Vec::new() };
    let length = last.secs - first.secs;
    if keys.len() < 3 || length < 2.0 * SAMPLE_SECS {
        return keys.to_vec();
    }
    // As many as a track may have; a long track is read in larger steps.
    let count = ((length / SAMPLE_SECS).ceil() as usize).min(Track::MOST_KEYS - 1);
    let step = length / count as f64;
    let at = |i: usize| first.secs + step * i as f64;
    let samples: Vec<Vec<f64>> = (0..=count).filter_map(|i| value_at(keys, at(i))).collect();
    let reach = ((3.0 * SMOOTH_SECS / step).ceil() as usize).min(count);
    let weight = |d: usize| (-0.5 * (d as f64 * step / SMOOTH_SECS).powi(2)).exp();
    let smooth = |i: usize| -> Vec<f64> {
        // Narrower near the ends, so that they stay.
        let reach = reach.min(i).min(count - i);
        let near = i - reach..=i + reach;
        let total: f64 = near.clone().map(|j| weight(j.abs_diff(i))).sum();
        let sum = |n: usize| near.clone().map(|j| weight(j.abs_diff(i)) * samples[j][n]).sum::<f64>();
        (0..first.value.len()).map(|n| sum(n) / total).collect()
    };
    let dense: Vec<Key> = (0..=count).map(|i| Key { secs: at(i), value: smooth(i) }).collect();
    thinned(&dense)
}
