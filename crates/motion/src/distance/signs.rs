//! Which points of a set are inside, by few winding numbers.

use glam::Vec3;

use super::Exact;

/// A point and its distance to the surface, negative inside once that is known.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Known {
    pub(super) at: Vec3,
    pub(super) distance: f32,
}

/// Whether a closed surface cannot pass between two points: it is farther from one or the other than they are from
/// each other. The thousandth is for rounding.
pub(super) fn on_one_side(a: &Known, b: &Known) -> bool {
    let reach = (a.distance.abs() + b.distance.abs()) * 0.999;
    reach > 0.0 && a.at.distance_squared(b.at) < reach * reach
}

/// Gives the distances of some points their signs, from `signed` points near by where these tell. That holds for
/// open surfaces too as far as the signed points are close: it closes their holes within a distance like that.
pub(super) fn sign_points(exact: &Exact, signed: &[Known], points: &mut [Known]) {
    // What is far from the surface tells most about the others.
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_unstable_by(|&a, &b| points[b].distance.total_cmp(&points[a].distance).then(a.cmp(&b)));
    for (done, &i) in order.iter().enumerate() {
        let point = points[i];
        let away = |other: &Known| other.at.distance_squared(point.at);
        let told = (signed.iter().filter(|other| on_one_side(&point, other)))
            .min_by(|a, b| away(a).total_cmp(&away(b)))
            .or_else(|| order[..done].iter().map(|&j| &points[j]).find(|other| on_one_side(&point, other)));
        let sign =
            told.map_or_else(|| if exact.inside(point.at) { -1.0 } else { 1.0 }, |other| other.distance);
        points[i].distance = point.distance.copysign(sign);
    }
}
