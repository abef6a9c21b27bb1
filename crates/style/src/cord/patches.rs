//! Divides the scalp into patches of about one size.

use glam::Vec3;

/// Rounds in which patches move to the middle of what is nearest to them (Lloyd 1982).
const ROUNDS: usize = 12;

/// Divides places into at most `count` groups of neighbours; each place is in one of them.
pub fn divide(places: &[Vec3], count: usize) -> Vec<Vec<usize>> {
    if count >= places.len() {
        return (0..places.len()).map(|i| vec![i]).collect();
    }
    let mut middles = spread(places, count.max(1));
    let mut groups = nearest(places, &middles);
    for _ in 0..ROUNDS {
        for (middle, group) in middles.iter_mut().zip(&groups) {
            if !group.is_empty() {
                *middle = group.iter().map(|&i| places[i]).sum::<Vec3>() / group.len() as f32;
            }
        }
        groups = nearest(places, &middles);
    }
    groups.retain(|group| !group.is_empty());
    groups
}

/// Places far from each other: each is the one furthest from those before it.
fn spread(places: &[Vec3], count: usize) -> Vec<Vec3> {
    let mut out = vec![places[0]];
    let mut away: Vec<f32> = vec![f32::MAX; places.len()];
    while out.len() < count {
        let last = out[out.len() - 1];
        for (away, place) in away.iter_mut().zip(places) {
            *away = away.min(place.distance_squared(last));
        }
        let furthest = (0..places.len()).max_by(|&a, &b| away[a].total_cmp(&away[b]));
        out.push(places[furthest.unwrap_or(0)]);
    }
    out
}

fn nearest(places: &[Vec3], middles: &[Vec3]) -> Vec<Vec<usize>> {
    let mut out = vec![Vec::new(); middles.len()];
    for (i, place) in places.iter().enumerate() {
        let away = |m: usize| middles[m].distance_squared(*place);
        let near = (0..middles.len()).min_by(|&a, &b| away(a).total_cmp(&away(b)));
        out[near.unwrap_or(0)].push(i);
    }
    out
}
