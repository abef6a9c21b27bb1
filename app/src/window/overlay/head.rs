//! The head under the pointer: what is dragged over it.

use egui::Pos2;
use glam::{Affine3A, Vec3};
use lovelock_groom::Scalp;

use super::View;

/// What is farther from the head than this is dragged through the air, metres.
const OFF_THE_HEAD: f32 = 0.05;

/// What faces the camera, or away from it by no more than this sine, is on the side that is seen.
const OUTLINE: f32 = 0.35;

/// The head of a picture.
#[derive(Clone, Copy)]
pub(crate) struct Head<'a> {
    pub(crate) world_from_head: &'a Affine3A,
    pub(crate) scalp: &'a Scalp,
}

impl Head<'_> {
    /// Where a place of head space is in the world.
    pub(super) fn world(self, place: Vec3) -> Vec3 {
        self.world_from_head.transform_point3(place)
    }

    /// Where the camera is and the unit vector along which it sees a place of the screen, head space.
    fn ray(self, view: View, at: Pos2) -> (Vec3, Vec3) {
        let head_from_world = self.world_from_head.inverse();
        let along = head_from_world.transform_vector3(view.ray(at)).normalize_or(Vec3::NEG_Z);
        (head_from_world.transform_point3(view.eye), along)
    }
}

/// How a place was taken hold of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hold {
    /// The head's normal there, how far over the head the place was, and on which side; none where it was in the air.
    over_head: Option<(Vec3, f32, Side)>,
}

impl Hold {
    /// Of a place of head space. One that is lower than `lowest` over the head comes up to that, metres.
    pub(super) fn new(view: View, head: Head<'_>, place: Vec3, lowest: f32) -> Self {
        let head_from_world = head.world_from_head.inverse();
        let along =
            head_from_world.transform_vector3((head.world(place) - view.eye).normalize_or(Vec3::NEG_Z));
        let over_head = nearest(head.scalp, place).filter(|(_, height)| *height < OFF_THE_HEAD);
        Self {
            over_head: over_head
                .map(|(OnHead { normal, .. }, height)| (normal, height.max(lowest), Side::of(normal, along))),
        }
    }

    /// Where what is at `place` goes as the pointer drags it: over the head, as far over it as it was and on the side where it was
    /// taken hold of; beside the head and in the air in the plane that faces the camera. With it the head's normals where it was
    /// taken hold of and where it goes. All in head space.
    pub(super) fn drag(
        self,
        view: View,
        head: Head<'_>,
        (place, pointer): (Vec3, Pos2),
    ) -> Option<(Vec3, Option<[Vec3; 2]>)> {
        let in_air = view.at_depth_of(pointer, head.world(place));
        let in_air = head.world_from_head.inverse().transform_point3(in_air);
        let on_head = self.over_head.and_then(|(from, height, side)| {
            let beside = || nearest(head.scalp, in_air).map(|(at, _)| OnHead { place: in_air, ..at });
            let to = under(head.scalp, height, head.ray(view, pointer), (place, side)).or_else(beside)?;
            Some((to.place, Some([from, to.normal])))
        });
        let (to, normals) = on_head.unwrap_or((in_air, None));
        to.is_finite().then(|| (to.clamp(Vec3::splat(-0.6), Vec3::splat(0.6)), normals))
    }
}

/// A place of the head's surface, or over it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct OnHead {
    /// Where it is, head space, metres.
    place: Vec3,
    /// The outward unit normal there.
    normal: Vec3,
}

/// Which side of the head, as the camera sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    /// Before the camera.
    Seen,
    /// Behind the head.
    Far,
}

impl Side {
    /// Of a place with that outward normal, which is looked at along `along`; both unit vectors of one space. On the outline of
    /// the head it is the side that is seen.
    fn of(normal: Vec3, along: Vec3) -> Self {
        if normal.dot(along) > OUTLINE { Self::Far } else { Self::Seen }
    }
}

/// Where a ray from `eye` along the unit vector `along` meets the surface that lies `height` metres over the head; none where it
/// passes by. Of the places on that side of the head it is the one nearest to `near`, and of all where that side has none. All in
/// head space, metres.
fn under(
    scalp: &Scalp,
    height: f32,
    (eye, along): (Vec3, Vec3),
    (near, side): (Vec3, Side),
) -> Option<OnHead> {
    let mut best: Option<((bool, f32), OnHead)> = None;
    for &triangle in &scalp.triangles {
        let corner = |i: usize| {
            let v = triangle[i] as usize;
            Some((*scalp.positions.get(v)? + *scalp.normals.get(v)? * height, *scalp.normals.get(v)?))
        };
        let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2)) else { continue };
        let Some([u, v, t]) = meets([a.0, b.0, c.0], eye, along) else { continue };
        let place = eye + along * t;
        let normal = (a.1 * (1.0 - u - v) + b.1 * u + c.1 * v).normalize_or(Vec3::Y);
        let faces = if normal.dot(along) > 0.0 { Side::Far } else { Side::Seen };
        let cost = (faces != side, place.distance(near));
        if cost.1.is_finite() && best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, OnHead { place, normal }));
        }
    }
    best.map(|(_, found)| found)
}

/// The vertex nearest to a place, and how far over the head the place is there, metres; none where there is no head.
fn nearest(scalp: &Scalp, place: Vec3) -> Option<(OnHead, f32)> {
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
    use lovelock_groom::PlainHead;

    use super::*;

    fn middle_of(scalp: &Scalp) -> Vec3 {
        let low = scalp.positions.iter().copied().reduce(Vec3::min).expect("a head");
        low.midpoint(scalp.positions.iter().copied().reduce(Vec3::max).expect("a head"))
    }

    #[test]
    fn a_ray_meets_the_head_on_the_side_that_is_asked_for() {
        let scalp = PlainHead.scalp(32);
        let middle = middle_of(&scalp);
        let eye = middle - Vec3::Z * 2.0;
        // Whichever side is nearer: beside the outline it is often the other one.
        for near in [middle - Vec3::Z * 0.1, middle, middle + Vec3::Z * 0.1] {
            for (side, back) in [(Side::Seen, true), (Side::Far, false)] {
                for height in [0.0, 0.012] {
                    let at = under(&scalp, height, (eye, Vec3::Z), (near, side)).expect("it meets the head");
                    assert_eq!(at.place.z < middle.z, back, "{at:?}");
                    assert!(at.normal.z.abs() > 0.9 && (at.normal.z < 0.0) == back, "{at:?}");
                    assert!((at.place - middle).truncate().length() < 1e-4, "{at:?} is on the ray");
                    let (_, over) = nearest(&scalp, at.place).expect("a head");
                    assert!((over - height).abs() < 2e-3, "{over} over the head, not {height}");
                }
            }
        }
        let by = under(&scalp, 0.0, (eye, Vec3::Y), (middle, Side::Seen));
        assert_eq!(by, None, "it passes by");
        assert_eq!(nearest(&Scalp::default(), middle), None);
    }

    #[test]
    fn a_side_that_is_not_there_is_the_other_one() {
        let mut scalp = PlainHead.scalp(32);
        let middle = middle_of(&scalp);
        let Scalp { positions, triangles, .. } = &mut scalp;
        triangles.retain(|t| t.iter().all(|v| positions[*v as usize].z > middle.z));
        let at = under(&scalp, 0.0, (middle - Vec3::Z * 2.0, Vec3::Z), (middle, Side::Seen));
        assert!(at.is_some_and(|at| at.place.z > middle.z), "{at:?}");
    }

    #[test]
    fn the_outline_belongs_to_the_side_that_is_seen() {
        for (normal, side) in [
            (Vec3::NEG_Z, Side::Seen),
            (Vec3::X, Side::Seen),
            (Vec3::new(0.9, 0.0, 0.3), Side::Seen),
            (Vec3::new(0.3, 0.0, 0.9), Side::Far),
            (Vec3::Z, Side::Far),
        ] {
            assert_eq!(Side::of(normal.normalize_or_zero(), Vec3::Z), side, "{normal}");
        }
    }
}
