//! Strands whose points are relative to their roots, as Perm stores them.

use glam::Vec3;
use lovelock_base::statistics::upper_median_by;

use crate::io::file::RawHair;

/// Strands are relative to their roots if they begin nearer to zero than this part of the extent of the roots.
const NEAR: f32 = 0.15;
/// What is said of strands that all begin in one place.
pub(super) const NOTE: &str = "All strands begin in one place. Strands relative to their roots need the roots in an archive (.npz), as an array \
     of strands × 3 with `roots` in its name.";

/// The first points of the strands.
fn firsts(raw: &RawHair) -> impl Iterator<Item = Option<Vec3>> {
    let mut at = 0;
    raw.point_counts.iter().map(move |&count| {
        let first = raw.points.get(at).copied().filter(|_| count > 0);
        at += count as usize;
        first
    })
}

/// Whether there are several strands, which all begin in the same point.
pub(super) fn begin_in_one_place(raw: &RawHair) -> bool {
    let mut known = firsts(raw).flatten();
    let Some(first) = known.next() else { return false };
    let mut others = known.peekable();
    others.peek().is_some() && others.all(|other| other == first)
}

/// Moves strands that are relative to `roots` there, and returns whether they are. Strands that begin beside their root get it as their first
/// point.
pub(super) fn move_to(raw: &mut RawHair, roots: &[Vec3]) -> bool {
    if roots.len() != raw.point_counts.len() || roots.len() < 2 {
        return false;
    }
    let median = |distance: &dyn Fn(Vec3, Vec3) -> f32| {
        let pairs = firsts(raw).zip(roots).filter_map(|(first, &root)| Some((first?, root)));
        let mut all: Vec<f32> =
            pairs.map(|(first, root)| distance(first, root)).filter(|d| d.is_finite()).collect();
        upper_median_by(&mut all, f32::total_cmp).unwrap_or(f32::INFINITY)
    };
    let (low, high) = roots
        .iter()
        .filter(|root| root.is_finite())
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), &root| (low.min(root), high.max(root)));
    let from_zero = median(&|first, _| first.length());
    if from_zero > NEAR * (high - low).length() || median(&|first, root| first.distance(root)) <= from_zero {
        return false;
    }
    let begin_at_root = from_zero <= 1e-6 * (high - low).length();
    let mut points = Vec::with_capacity(raw.points.len() + roots.len());
    let mut at = 0;
    for (count, &root) in raw.point_counts.iter_mut().zip(roots) {
        let own = &raw.points[at..at + *count as usize];
        at += own.len();
        if !begin_at_root && !own.is_empty() {
            points.push(root);
            *count += 1;
        }
        points.extend(own.iter().map(|&point| root + point));
    }
    raw.points = points;
    true
}
