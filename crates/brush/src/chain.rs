//! Laying the links of a guide after its points were moved.

use glam::{Quat, Vec3};
use lovelock_groom::{Bounded, Obstacle};
use lovelock_style::hand::{smallest_turn, turned_toward};

/// Clearance between the body and guides that had more of it before, metres.
const CLEAR: f32 = 0.003;
/// Links turn from one to the next by this angle at most, radians, unless they did before.
const MAX_BEND: f32 = 0.6;
/// Weights of the turns of the links around a link: binomial, so that a change to alternate sides cancels out.
const EVENED: [f32; 5] = [1.0, 4.0, 6.0, 4.0, 1.0];

/// A chain from the first of `before` along `targets`, with links of the given lengths, outside the body as far as it was before.
pub(crate) fn lay(before: &[Vec3], targets: &[Vec3], lengths: &[f32], obstacle: &dyn Obstacle) -> Vec<Vec3> {
    let obstacle = Bounded(obstacle);
    let mut out = Vec::with_capacity(before.len());
    out.push(before[0]);
    let mut moved = false;
    let mut last: Option<Vec3> = None;
    for (i, length) in lengths.iter().enumerate() {
        let from = out[i];
        let old = before[i + 1] - before[i];
        moved |= targets[i + 1] != before[i + 1] || *length != old.length();
        if !moved {
            out.push(before[i + 1]);
            last = Some(old.normalize_or(Vec3::NEG_Y));
            continue;
        }
        let mut along = (targets[i + 1] - from).normalize_or(old.normalize_or(Vec3::NEG_Y));
        if let Some(last) = last {
            let bend = (before[i] - before[i - 1]).angle_between(old);
            let most = if bend.is_finite() { bend.max(MAX_BEND) } else { MAX_BEND };
            if last.angle_between(along) > most {
                along = turned_toward(last, along, most);
            }
        }
        let mut p = from + along * *length;
        let mut clear = None;
        for _ in 0..3 {
            let (distance, normal) = obstacle.distance(p);
            // Most points are far from the body: where they were before does not matter then.
            if distance >= CLEAR {
                break;
            }
            let clear = *clear.get_or_insert_with(|| obstacle.distance(before[i + 1]).0.clamp(0.0, CLEAR));
            if distance >= clear {
                break;
            }
            p += normal * (clear - distance);
            p = from + (p - from).normalize_or(along) * *length;
        }
        last = Some((p - from).normalize_or(along));
        out.push(p);
    }
    out
}

/// The chain `after` with the turn of each link since `before` averaged with those of the links beside it: hair that is pushed toward its
/// root bends as a whole, and does not fold into a zigzag of links.
pub(crate) fn evened(before: &[Vec3], after: &[Vec3]) -> Vec<Vec3> {
    let (ways, new) = (directions(before), directions(after));
    let turns: Vec<Quat> = ways.iter().zip(&new).map(|(from, to)| smallest_turn(*from, *to)).collect();
    let count = turns.len();
    let reach = EVENED.len() / 2;
    let Some(moved) = (0..count).find(|i| after[i + 1] != before[i + 1]) else { return before.to_vec() };
    let first = moved.saturating_sub(reach);
    let of = |i: usize| {
        // The link at the scalp takes no part in what is beyond it.
        if i == 0 {
            return turns[0] * ways[0];
        }
        let near =
            (0..EVENED.len()).filter_map(|k| Some((EVENED[k], *turns.get((i + k).checked_sub(reach)?)?)));
        mean_turn(near) * ways[i]
    };
    let ways: Vec<Vec3> = (first..count).map(of).collect();
    let mut out = before[..first].to_vec();
    out.extend(along(before[first], &ways, &lengths(after)[first..]));
    out
}

/// The mean of some rotations with their weights.
pub(crate) fn mean_turn(turns: impl Iterator<Item = (f32, Quat)>) -> Quat {
    let mut first = None;
    let sum = turns.fold(Quat::from_xyzw(0.0, 0.0, 0.0, 0.0), |sum, (weight, turn)| {
        let sign = if turn.dot(*first.get_or_insert(turn)) < 0.0 { -weight } else { weight };
        sum + turn * sign
    });
    if sum.length_squared() > 1e-6 { sum.normalize() } else { first.unwrap_or_default() }
}

/// The length of each link.
pub(crate) fn lengths(points: &[Vec3]) -> Vec<f32> {
    points.windows(2).map(|pair| pair[0].distance(pair[1])).collect()
}

/// Unit direction of each link.
pub(crate) fn directions(points: &[Vec3]) -> Vec<Vec3> {
    let mut last = Vec3::NEG_Y;
    let mut next = |pair: &[Vec3]| {
        last = (pair[1] - pair[0]).normalize_or(last);
        last
    };
    points.windows(2).map(&mut next).collect()
}

/// A chain from a point with links of these directions and lengths.
pub(crate) fn along(root: Vec3, directions: &[Vec3], lengths: &[f32]) -> Vec<Vec3> {
    let mut at = root;
    let steps = directions.iter().zip(lengths).map(|(direction, length)| {
        at += *direction * *length;
        at
    });
    std::iter::once(root).chain(steps).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use lovelock_groom::NoObstacle;

    #[test]
    fn links_keep_their_lengths_and_do_not_fold() {
        let before: Vec<Vec3> = (0..20).map(|i| Vec3::NEG_Y * 0.01 * i as f32).collect();
        let mut targets = before.clone();
        // Pushed back toward the root.
        targets[8..].iter_mut().for_each(|p| *p += Vec3::Y * 0.1);
        let after = lay(&before, &targets, &lengths(&before), &NoObstacle);
        assert_eq!(after[..8], before[..8]);
        for link in lengths(&after) {
            assert!((link - 0.01).abs() < 1e-6, "{link}");
        }
        for pair in directions(&after).windows(2) {
            assert!(pair[0].angle_between(pair[1]) < MAX_BEND + 1e-3);
        }
    }

    #[test]
    fn hair_that_is_pushed_toward_its_root_does_not_become_a_zigzag() {
        // A guide with the slightest waves, which folding makes larger.
        let start: Vec<Vec3> =
            (0..31_i16).map(|i| Vec3::new(0.0004 * f32::from(i % 2), -0.01 * f32::from(i), 0.0)).collect();
        let links = lengths(&start);
        // The sharpest bend of two links to opposite sides.
        let zigzag = |even: bool| {
            let mut points = start.clone();
            for _ in 0..25 {
                let pushed: Vec<Vec3> = (0..31_u8)
                    .map(|i| points[usize::from(i)] + Vec3::Y * (0.002 * f32::from(i.clamp(8, 16) - 8)))
                    .collect();
                let mut after = lay(&points, &pushed, &links, &NoObstacle);
                if even {
                    after = lay(&points, &evened(&points, &after), &links, &NoObstacle);
                }
                points = after;
            }
            let ways = directions(&points);
            let bends: Vec<Vec3> = ways.windows(2).map(|pair| pair[0].cross(pair[1])).collect();
            bends.windows(2).map(|pair| (-pair[0].dot(pair[1])).max(0.0).sqrt()).fold(0.0, f32::max)
        };
        let (even, folded) = (zigzag(true), zigzag(false));
        println!("evened {even}, else {folded}");
        assert!(even < 0.12 && folded > 0.3, "{even} {folded}");
    }

    #[test]
    fn a_turn_of_the_whole_chain_stays_as_it_is() {
        let before: Vec<Vec3> = (0..20_u8).map(|i| Vec3::NEG_Y * (0.01 * f32::from(i))).collect();
        let turn = Quat::from_rotation_x(0.4);
        let after: Vec<Vec3> = before.iter().map(|p| turn * *p).collect();
        for (a, b) in evened(&before, &after).into_iter().zip(&after) {
            assert!(a.distance(*b) < 1e-6);
        }
        assert_eq!(evened(&before, &before), before);
    }
}
