//! The guides that edits turn.

use glam::Vec3;
use lovelock_groom::{Guides, NoObstacle};

use crate::guides::{laid, length, lengthen, shape_of};

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
