//! The guides that edits turn.

use glam::Vec3;
use lovelock_groom::{Guides, NoObstacle};

use crate::guides::{laid, length, lengthen, shape_of, turned};

/// The points of a guide whose links an edit turns: without the cut part, and with the length of the edit. `None` if fewer than two
/// points are left.
pub fn hand_input(guides: &Guides, guide: usize, factor: f32) -> Option<Vec<Vec3>> {
    let mut points = shape_of(guides, guide, 1.0, None)?.points;
    relength(&mut points, factor);
    Some(points)
}

/// Lengthens hair at its end or shortens it. It has as many links as before, of equal length.
pub fn relength(points: &mut Vec<Vec3>, factor: f32) {
    if factor == 1.0 || points.len() < 2 {
        return;
    }
    let before = points.clone();
    let links = (points.len() - 1) as f32;
    lengthen(points, factor);
    *points = laid(points, &before, length(points) / links, &NoObstacle);
}

/// A unit direction turned toward another by an angle, and not beyond it.
pub fn turned_toward(direction: Vec3, toward: Vec3, angle: f32) -> Vec3 {
    turned(direction, toward, angle, false)
}

/// A polyline with so many links of equal length up to a part of its length, 0 to 1.
pub fn resampled(points: &[Vec3], part: f32, links: usize) -> Vec<Vec3> {
    let whole: Vec<f32> = points.windows(2).map(|pair| pair[0].distance(pair[1])).collect();
    let end = whole.iter().sum::<f32>() * part.clamp(0.0, 1.0);
    let (mut link, mut before) = (0, 0.0);
    let at = |i: usize| {
        let metres = end * i as f32 / links as f32;
        while link + 1 < whole.len() && before + whole[link] < metres {
            before += whole[link];
            link += 1;
        }
        let t = if whole[link] > 0.0 { (metres - before) / whole[link] } else { 0.0 };
        points[link].lerp(points[link + 1], t.clamp(0.0, 1.0))
    };
    (0..=links).map(at).collect()
}
