//! Determines which points of a set are inside, with few winding numbers.

use glam::Vec3;

use super::Exact;

/// A point and its distance to the surface; negative inside once the sign is known.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct MeasuredPoint {
    pub(super) at: Vec3,
    pub(super) distance: f32,
}

/// Whether a closed surface cannot pass between two points, because their distances to it add up to more than
/// the distance between them. The factor allows for rounding.
pub(super) fn on_same_side(a: &MeasuredPoint, b: &MeasuredPoint) -> bool {
    let reach = (a.distance.abs() + b.distance.abs()) * 0.999;
    reach > 0.0 && a.at.distance_squared(b.at) < reach * reach
}

/// Determines the signs of distances, from nearby `signed` points where possible. This also works for open
/// surfaces as far as the signed points are close: holes are closed up to about that distance.
pub(super) fn sign_points(exact: &Exact, signed: &[MeasuredPoint], points: &mut [MeasuredPoint]) {
    // Points far from the surface determine most of the others.
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_unstable_by(|&a, &b| points[b].distance.total_cmp(&points[a].distance).then(a.cmp(&b)));
    for (done, &i) in order.iter().enumerate() {
        let point = points[i];
        let away = |other: &MeasuredPoint| other.at.distance_squared(point.at);
        let nearest_signed = (signed.iter().filter(|other| on_same_side(&point, other)))
            .min_by(|a, b| away(a).total_cmp(&away(b)))
            .or_else(|| order[..done].iter().map(|&j| &points[j]).find(|other| on_same_side(&point, other)));
        let sign = nearest_signed
            .map_or_else(|| if exact.inside(point.at) { -1.0 } else { 1.0 }, |other| other.distance);
        points[i].distance = point.distance.copysign(sign);
    }
}
