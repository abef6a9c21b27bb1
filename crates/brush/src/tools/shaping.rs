//! Tools that change the shape of hair where it is.

use glam::Vec3;
use lovelock_style::hand::{hand_input, turned_toward};
use rayon::prelude::*;

use super::Stamp;
use crate::chain::{along, directions, lengths};
use crate::touch::TouchedGuide;

/// Guides whose course a guide takes over while it is smoothed.
const NEIGHBOURS: usize = 6;
/// The fraction of the way that smoothing moves per dab.
const SMOOTH: f32 = 0.35;
/// The fraction of the way that straightening moves per dab.
const STRAIGHTEN: f32 = 0.25;

/// The nearest roots to each.
pub(crate) fn neighbours(roots: &[Vec3]) -> Vec<Vec<u32>> {
    let of = |own: usize| {
        let mut near: Vec<(f32, u32)> = (0..roots.len())
            .filter(|other| *other != own)
            .map(|other| (roots[other].distance_squared(roots[own]), other as u32))
            .collect();
        if near.len() > NEIGHBOURS {
            near.select_nth_unstable_by(NEIGHBOURS, |a, b| a.0.total_cmp(&b.0));
            near.truncate(NEIGHBOURS);
        }
        near.into_iter().map(|(_, other)| other).collect()
    };
    (0..roots.len()).into_par_iter().map(of).collect()
}

impl Stamp<'_> {
    pub(super) fn smoothed(&self, touched: &TouchedGuide) -> Vec<Vec3> {
        let before = &touched.points;
        let last = before.len() - 1;
        let own = before[last] - before[0];
        let near: Vec<(f32, Vec<Vec3>)> = (self.neighbours.get(touched.guide).into_iter().flatten())
            .filter_map(|other| hand_input(self.seen, *other as usize, 1.0))
            .map(|points| {
                let way = points[points.len() - 1] - points[0];
                // Hair that goes another way, as across a parting, counts less.
                let alike = way.normalize_or_zero().dot(own.normalize_or_zero()).max(0.0).powi(4);
                (alike, directions(&points))
            })
            .collect();
        let ways = directions(before);
        let mut out = ways.clone();
        for (i, way) in out.iter_mut().enumerate() {
            let weight = touched.weights[i].max(touched.weights[i + 1]) * SMOOTH;
            if weight == 0.0 {
                continue;
            }
            let even = 0.5 * (ways[i.saturating_sub(1)] + ways[(i + 1).min(last - 1)]);
            let (mut common, mut all) = (ways[i], 1.0);
            for (alike, other) in &near {
                common += other[i * other.len() / last] * *alike;
                all += alike;
            }
            *way = (*way + ((even - *way) + 0.5 * (common / all - *way)) * weight).normalize_or(*way);
        }
        from_first_change(before, &ways, &out)
    }

    pub(super) fn straightened(touched: &TouchedGuide) -> Vec<Vec3> {
        let before = &touched.points;
        let last = before.len() - 1;
        let from = touched.weights.iter().position(|w| *w > 0.0).unwrap_or(0).saturating_sub(1);
        let until = touched.weights.iter().rposition(|w| *w > 0.0).unwrap_or(last).max(from + 1).min(last);
        let Some(target) = (before[until] - before[from]).try_normalize() else { return before.clone() };
        let ways = directions(before);
        let mut out = ways.clone();
        for (i, way) in out.iter_mut().enumerate().skip(from) {
            let weight = touched.weights[i].max(touched.weights[i + 1]) * STRAIGHTEN;
            if weight > 0.0 {
                *way = turned_toward(*way, target, weight * way.angle_between(target));
            }
        }
        from_first_change(before, &ways, &out)
    }
}

/// The guide with other directions of its links; the points before the first change stay.
fn from_first_change(before: &[Vec3], ways: &[Vec3], new: &[Vec3]) -> Vec<Vec3> {
    let Some(first) = ways.iter().zip(new).position(|(a, b)| a != b) else { return before.to_vec() };
    let mut out = before[..first].to_vec();
    out.extend(along(before[first], &new[first..], &lengths(before)[first..]));
    out
}
