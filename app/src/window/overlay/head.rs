//! The head under the pointer: where a tie is dragged along.

use glam::Vec3;
use lovelock_studio::groom::Scalp;

/// By how much nearer the side of the head that is seen counts than the far one, metres.
const SEEN: f32 = 0.02;

/// A place of the head's surface, or over it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct OnHead {
    /// Where it is, head space, metres.
    pub(super) place: Vec3,
    /// The outward unit normal there.
    pub(super) normal: Vec3,
}

/// Where a ray meets the surface that lies `height` metres over the head, nearest to `near`; none where it passes by. All in head
/// space, `along` a unit vector.
pub(super) fn under(scalp: &Scalp, height: f32, eye: Vec3, along: Vec3, near: Vec3) -> Option<OnHead> {
    let mut best: Option<(f32, OnHead)> = None;
    for &triangle in &scalp.triangles {
        let corner = |i: usize| {
            let v = triangle[i] as usize;
            Some((*scalp.positions.get(v)? + *scalp.normals.get(v)? * height, *scalp.normals.get(v)?))
        };
        let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) else { continue };
        let Some([u, v, t]) = meets([a.0, b.0, c.0], eye, along) else { continue };
        let place = eye + along * t;
        let normal = (a.1 * (1.0 - u - v) + b.1 * u + c.1 * v).normalize_or(Vec3::Y);
        let far_side = if normal.dot(along) > 0.0 { SEEN } else { 0.0 };
        let cost = place.distance(near) + far_side;
        if cost.is_finite() && best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, OnHead { place, normal }));
        }
    }
    best.map(|(_, found)| found)
}

/// The vertex nearest to a place, and how far over the head the place is there, metres; none where there is no head.
pub(super) fn nearest(scalp: &Scalp, place: Vec3) -> Option<(OnHead, f32)> {
    let vertices = scalp.positions.iter().zip(&scalp.normals);
    let (p, n) = vertices
        .filter(|(p, n)| p.is_finite() && n.is_finite())
        .min_by(|(a, _), (b, _)| a.distance_squared(place).total_cmp(&b.distance_squared(place)))?;
    let normal = n.try_normalize()?;
    Some((OnHead { place: *p, normal }, (place - *p).dot(normal)))
}

/// Where a ray meets a triangle: shares of the second and third corner, and how far along it is (Möller and Trumbore 1997).
fn meets([a, b, c]: [Vec3; 3], eye: Vec3, along: Vec3) -> Option<[f32; 3]> {
    let (to_b, to_c) = (b - a, c - a);
    let p = along.cross(to_c);
    let determinant = to_b.dot(p);
    if !determinant.is_finite() || determinant == 0.0 {
        return None;
    }
    let from = (eye - a) / determinant;
    let u = from.dot(p);
    let q = from.cross(to_b);
    let (v, t) = (along.dot(q), to_c.dot(q));
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && t > 0.0).then_some([u, v, t])
}

#[cfg(test)]
mod tests {
    use super::*;
    use lovelock_studio::groom::PlainHead;

    #[test]
    fn a_ray_meets_the_head_where_the_tie_is_and_not_behind_it() {
        let scalp = PlainHead.scalp(32);
        let middle = 0.5
            * scalp
                .positions
                .iter()
                .fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[low, high], p| [low.min(*p), high.max(*p)])
                .into_iter()
                .sum::<Vec3>();
        let eye = middle - Vec3::Z * 2.0;
        for (near, back) in [(middle - Vec3::Z * 0.1, true), (middle + Vec3::Z * 0.1, false)] {
            for height in [0.0, 0.012] {
                let at = under(&scalp, height, eye, Vec3::Z, near).expect("it meets the head");
                assert_eq!(at.place.z < middle.z, back, "{at:?}");
                assert!(at.normal.z.abs() > 0.9 && (at.normal.z < 0.0) == back, "{at:?}");
                assert!((at.place - middle).truncate().length() < 1e-4, "{at:?} is on the ray");
                let (_, over) = nearest(&scalp, at.place).expect("a head");
                assert!((over - height).abs() < 2e-3, "{over} over the head, not {height}");
            }
        }
        assert_eq!(under(&scalp, 0.0, eye, Vec3::Y, middle), None, "it passes by");
        assert_eq!(nearest(&Scalp::default(), middle), None);
    }
}
