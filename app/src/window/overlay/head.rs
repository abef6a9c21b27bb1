//! Dragging things over the head.

use egui::Pos2;
use glam::{Affine3A, Vec3};
use lovelock_base::triangle::ray_meets;
use lovelock_groom::Scalp;

use super::View;

/// Points farther from the head than this are dragged in a plane instead of over the surface, metres.
const OFF_THE_HEAD: f32 = 0.05;

/// Points whose normal is turned away from the camera by no more than this sine count as visible.
const OUTLINE: f32 = 0.35;

/// The head in an image.
#[derive(Clone, Copy)]
pub(crate) struct Head<'a> {
    pub(crate) world_from_head: &'a Affine3A,
    pub(crate) scalp: &'a Scalp,
}

impl Head<'_> {
    /// A point of head space in world space.
    pub(super) fn world(self, place: Vec3) -> Vec3 {
        self.world_from_head.transform_point3(place)
    }

    /// The point of the surface under a point of the screen and the normal there, head space.
    pub(crate) fn hit(self, view: View, at: Pos2) -> Option<(Vec3, Vec3)> {
        let ray = self.ray(view, at);
        let found = under(self.scalp, 0.0, ray, (ray.0, Side::Seen))?;
        Some((found.place, found.normal))
    }

    /// The normal of the vertex that is nearest to a point, head space.
    pub(super) fn normal_near(self, place: Vec3) -> Option<Vec3> {
        nearest(self.scalp, place).map(|(found, _)| found.normal)
    }

    /// Size of the head in the world as a multiple of head space.
    pub(super) fn scale(self) -> f32 {
        Vec3::from(self.world_from_head.matrix3.x_axis).length()
    }

    /// The place of the head's visible surface under a point of the screen, head space; `None` beside the head. Of several, the one nearest
    /// to `near`.
    pub(super) fn under(self, view: View, at: Pos2, near: Vec3) -> Option<Vec3> {
        under(self.scalp, 0.0, self.ray(view, at), (near, Side::Seen)).map(|at| at.place)
    }

    /// The camera's position in head space.
    pub(super) fn eye(self, view: View) -> Vec3 {
        self.world_from_head.inverse().transform_point3(view.eye)
    }

    /// The camera's position and the unit vector toward a point of the screen, head space.
    fn ray(self, view: View, at: Pos2) -> (Vec3, Vec3) {
        let head_from_world = self.world_from_head.inverse();
        let along = head_from_world.transform_vector3(view.ray(at)).normalize_or(Vec3::NEG_Z);
        (head_from_world.transform_point3(view.eye), along)
    }
}

/// How a point was grabbed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hold {
    /// The head's normal there, the height over the head and the side; `None` for a point away from the head.
    over_head: Option<(Vec3, f32, Side)>,
}

impl Hold {
    /// Grabs a point of head space. A height over the head below `lowest` is raised to it, metres.
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

    /// Where an object at `place` moves as the pointer drags it: over the head, at the same height and on the side where the drag
    /// began; beside the head and in the air in the plane that faces the camera. Also returns the head's normals at the start and at
    /// the end. All in head space.
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

/// A point on the head's surface or above it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct OnHead {
    /// Its position, head space, metres.
    place: Vec3,
    /// The outward unit normal there.
    normal: Vec3,
}

/// A side of the head, as seen by the camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    /// The visible side.
    Seen,
    /// The hidden side.
    Far,
}

impl Side {
    /// The side of a point with that outward normal, seen along `along`; both are unit vectors of one space. The outline of the head
    /// counts as visible.
    fn of(normal: Vec3, along: Vec3) -> Self {
        if normal.dot(along) > OUTLINE { Self::Far } else { Self::Seen }
    }
}

/// The intersection of a ray from `eye` along the unit vector `along` with the surface `height` metres over the head; `None` if it
/// misses. Among the intersections on the given side, or among all if that side has none, the one nearest to `near` is returned.
/// All in head space, metres.
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
        let Some([u, v, t]) = ray_meets([a.0, b.0, c.0], eye, along) else { continue };
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

/// The vertex nearest to a point, and the height of the point over the head, metres; `None` if there is no head.
fn nearest(scalp: &Scalp, place: Vec3) -> Option<(OnHead, f32)> {
    let vertices = scalp.positions.iter().zip(&scalp.normals);
    let (p, n) = vertices
        .filter(|(p, n)| p.is_finite() && n.is_finite())
        .min_by(|(a, _), (b, _)| a.distance_squared(place).total_cmp(&b.distance_squared(place)))?;
    let normal = n.try_normalize()?;
    Some((OnHead { place: *p, normal }, (place - *p).dot(normal)))
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
        // Near the outline the other side is often nearer.
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
