//! Colliders during one step: their arrangement at rest, and their places at each substep.

pub(crate) mod boxes;
pub(crate) mod contact;
pub(crate) mod field;
pub(crate) mod shape;

use glam::{Affine3A, Mat3, Quat, Vec3};
use lovelock_motion::{ColliderShape, PlacedCollider};

use crate::lanes::Map;
use shape::Shape;

/// The constants of contacts by name, for other devices.
pub(crate) const CONSTANTS: [(&str, f64); 9] = {
    let ([a, b, c, d, e, f, g, h], [i]) = (contact::CONSTANTS, shape::CONSTANTS);
    [a, b, c, d, e, f, g, h, i]
};

/// A collider at one substep, in the step's working space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MovingShape {
    /// `None` if the collider is not usable.
    pub(crate) shape: Option<Shape>,
    pub(crate) min: Vec3,
    pub(crate) max: Vec3,
    /// Velocity of the surface at a point, metres per second.
    pub(crate) velocity_at: Map,
    /// Whether it moves rigidly with the head, so that layering applies above it.
    pub(crate) on_head: bool,
}

/// The colliders around the head in the rest pose.
#[derive(Clone, Debug, Default)]
pub(crate) struct RestColliders {
    /// In head space.
    pub(crate) shapes: Vec<ColliderShape>,
    pub(crate) on_head: Vec<bool>,
}

impl RestColliders {
    /// Finds the arrangement at rest from the current arrangement.
    ///
    /// At rest the head is at `head_at_rest` in the world, without rotation, if the field of the body
    /// provides that position. Otherwise a collider that moves with the head gives it: the head at rest is at
    /// `world_from_rest^-1 * world_from_head` of that collider, which must be a pure translation. All other
    /// colliders follow from there. If neither is available, the current arrangement is used as the rest
    /// arrangement.
    pub(crate) fn find(
        &mut self,
        world_from_head: Affine3A,
        colliders: &[PlacedCollider],
        head_at_rest: Option<Vec3>,
    ) {
        self.shapes.clear();
        self.on_head.clear();
        let on_head = || {
            colliders
                .iter()
                .map(|c| c.world_from_rest.inverse() * world_from_head)
                .find(|m| m.is_finite() && is_translation(m))
        };
        let rest_from_head = head_at_rest.map(Affine3A::from_translation).or_else(on_head);
        for c in colliders {
            let head_from_world = world_from_head.inverse();
            let (head_from_now, on_head) = match rest_from_head {
                Some(rest_from_head) => {
                    let here = c.world_from_rest.inverse() * world_from_head;
                    let same = is_translation(&here)
                        && (here.translation - rest_from_head.translation).length() < 2e-3;
                    (rest_from_head.inverse() * c.world_from_rest.inverse(), same)
                }
                None => (head_from_world, false),
            };
            self.shapes.push(transformed(&c.shape, &head_from_now));
            self.on_head.push(on_head);
        }
    }
}

/// Whether `m` neither rotates nor scales, within the single-precision error of a chain of joints.
fn is_translation(m: &Affine3A) -> bool {
    m.is_finite() && m.matrix3.abs_diff_eq(glam::Mat3A::IDENTITY, 2e-3)
}

/// Fills `out` with the colliders interpolated by `t` from `before` to `now`, in the space whose origin is at
/// `origin`. `world_from_head` is the head at the same time.
pub(crate) fn place(
    rest: &RestColliders,
    before: &[PlacedCollider],
    now: &[PlacedCollider],
    t: f32,
    dt_secs: f32,
    origin: Vec3,
    world_from_head: &Affine3A,
    out: &mut Vec<MovingShape>,
) {
    for (i, collider) in now.iter().enumerate() {
        let was = before.get(i).unwrap_or(collider);
        let on_head = rest.on_head.get(i).copied().unwrap_or(false);
        let world = if on_head {
            transformed(&rest.shapes[i], world_from_head)
        } else {
            interpolated(&was.shape, &collider.shape, t)
        };
        let local = transformed(&world, &Affine3A::from_translation(-origin));
        let shape = Shape::new(&local);
        let (min, max) = shape.map_or((Vec3::INFINITY, Vec3::NEG_INFINITY), |s| s.bounds());
        let velocity_at = surface_velocity(was, collider, dt_secs, origin);
        out.push(MovingShape { shape, min, max, velocity_at, on_head });
    }
}

/// Maps a point to the velocity of the collider's surface there.
fn surface_velocity(was: &PlacedCollider, now: &PlacedCollider, dt_secs: f32, origin: Vec3) -> Map {
    let before_from_now = was.world_from_rest * now.world_from_rest.inverse();
    if !before_from_now.is_finite() || dt_secs <= 0.0 {
        return Map { turn: Mat3::ZERO, shift: Vec3::ZERO };
    }
    let turn = Mat3::from(before_from_now.matrix3);
    let rate = 1.0 / dt_secs;
    let still = origin - (turn * origin + Vec3::from(before_from_now.translation));
    Map { turn: (Mat3::IDENTITY - turn) * rate, shift: still * rate }
}

/// A shape transformed by the rigid map `m`.
pub(crate) fn transformed(shape: &ColliderShape, m: &Affine3A) -> ColliderShape {
    match *shape {
        ColliderShape::Capsule { a, b, radius_a, radius_b } => {
            ColliderShape::Capsule { a: m.transform_point3(a), b: m.transform_point3(b), radius_a, radius_b }
        }
        ColliderShape::Ellipsoid { from_unit } => ColliderShape::Ellipsoid { from_unit: *m * from_unit },
    }
}

/// Interpolates the shape of a collider between two times.
fn interpolated(was: &ColliderShape, now: &ColliderShape, t: f32) -> ColliderShape {
    match (*was, *now) {
        (
            ColliderShape::Capsule { a, b, radius_a, radius_b },
            ColliderShape::Capsule { a: a1, b: b1, radius_a: ra1, radius_b: rb1 },
        ) => ColliderShape::Capsule {
            a: a.lerp(a1, t),
            b: b.lerp(b1, t),
            radius_a: radius_a + (ra1 - radius_a) * t,
            radius_b: radius_b + (rb1 - radius_b) * t,
        },
        (ColliderShape::Ellipsoid { from_unit: m0 }, ColliderShape::Ellipsoid { from_unit: m1 }) => {
            let (s0, r0, t0) = m0.to_scale_rotation_translation();
            let (s1, r1, t1) = m1.to_scale_rotation_translation();
            let turn = normalized_or_identity(r0).slerp(normalized_or_identity(r1), t);
            let from_unit = Affine3A::from_scale_rotation_translation(s0.lerp(s1, t), turn, t0.lerp(t1, t));
            ColliderShape::Ellipsoid { from_unit }
        }
        _ => *now,
    }
}

fn normalized_or_identity(q: Quat) -> Quat {
    if q.is_finite() && q.length_squared() > 1e-6 { q.normalize() } else { Quat::IDENTITY }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sphere(c: Vec3, r: f32) -> ColliderShape {
        ColliderShape::Capsule { a: c, b: c, radius_a: r, radius_b: r }
    }

    #[test]
    fn the_rest_arrangement_is_found_in_any_pose() {
        let head_at_rest = Vec3::new(0.0, 1.5, 0.02);
        let skull = sphere(Vec3::new(0.0, 1.58, 0.02), 0.1);
        let shoulder = sphere(Vec3::new(0.18, 1.35, 0.0), 0.06);
        // A pose in which the head has turned and nodded, and the arm has moved.
        let head_now = Affine3A::from_rotation_translation(
            Quat::from_euler(glam::EulerRot::XYZ, 0.4, -1.0, 0.2),
            Vec3::new(1.0, 1.2, -0.5),
        );
        let world_from_rest_head = head_now * Affine3A::from_translation(-head_at_rest);
        let world_from_rest_arm =
            Affine3A::from_rotation_translation(Quat::from_rotation_x(1.2), Vec3::new(0.3, 0.1, 0.9));
        let placed = [(shoulder, world_from_rest_arm), (skull, world_from_rest_head)]
            .map(|(s, m)| PlacedCollider { shape: transformed(&s, &m), world_from_rest: m });
        let mut rest = RestColliders::default();
        rest.find(head_now, &placed, None);
        assert_eq!(rest.on_head, [false, true]);
        let centre = |s: &ColliderShape| match *s {
            ColliderShape::Capsule { a, .. } => a,
            ColliderShape::Ellipsoid { .. } => unreachable!(),
        };
        // Two rotations and their inverses in f32 over a metre.
        assert!((centre(&rest.shapes[0]) - (Vec3::new(0.18, 1.35, 0.0) - head_at_rest)).length() < 1e-5);
        assert!((centre(&rest.shapes[1]) - Vec3::new(0.0, 0.08, 0.0)).length() < 1e-5);
        // A field that replaces the skull provides the position of the head.
        let mut arm_alone = RestColliders::default();
        arm_alone.find(head_now, &placed[..1], Some(head_at_rest));
        assert!((centre(&arm_alone.shapes[0]) - centre(&rest.shapes[0])).length() < 1e-5);
        // Control: an arm alone does not determine it.
        arm_alone.find(head_now, &placed[..1], None);
        assert!((centre(&arm_alone.shapes[0]) - centre(&rest.shapes[0])).length() > 0.1);
    }

    #[test]
    fn a_rotating_surface_has_the_velocity_of_its_rim() {
        let at = |angle: f32| PlacedCollider {
            shape: sphere(Vec3::ZERO, 1.0),
            world_from_rest: Affine3A::from_rotation_y(angle),
        };
        let v = surface_velocity(&at(0.0), &at(0.001), 0.001, Vec3::new(5.0, 0.0, 0.0));
        // One radian per second: the rim at +X moves toward -Z at 1 m/s.
        let rim = v.apply(Vec3::X - Vec3::new(5.0, 0.0, 0.0));
        assert!((rim - Vec3::NEG_Z).length() < 2e-3, "{rim}");
    }
}
