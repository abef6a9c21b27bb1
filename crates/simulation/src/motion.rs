//! Interpolation of the head between two inputs, and detection of jumps.

use glam::{Affine3A, Mat3, Mat3A, Quat, Vec3};

use crate::lanes::{Map, Turn};

/// A larger movement in one step is a jump: metres and radians.
const JUMP: (f32, f32) = (0.5, 1.0);

/// When the clock jumps, as at the end of a loop, a larger movement than this counts as a jump too: metres
/// and radians.
const CUT: (f32, f32) = (0.05, 0.15);

/// A longer time between two inputs is a jump of the clock, seconds.
const PAUSE_SECS: f64 = 0.5;

/// A rigid transform of the head: translation and rotation, without scale.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HeadPose {
    pub(crate) turn: Quat,
    pub(crate) place: Vec3,
}

impl HeadPose {
    pub(crate) const IDENTITY: Self = Self { turn: Quat::IDENTITY, place: Vec3::ZERO };

    /// `None` if the transform is not finite or has no rotation.
    pub(crate) fn new(world_from_head: &Affine3A) -> Option<Self> {
        let m = world_from_head.matrix3;
        let unit = |v: glam::Vec3A| v.try_normalize();
        let (x, y, z) = (unit(m.x_axis)?, unit(m.y_axis)?, unit(m.z_axis)?);
        let turn = Quat::from_mat3a(&Mat3A::from_cols(x, y, z));
        let place = Vec3::from(world_from_head.translation);
        let turn = if turn.length_squared() > 0.5 { turn.normalize() } else { return None };
        (turn.is_finite() && place.is_finite()).then_some(Self { turn, place })
    }

    pub(crate) fn affine(&self) -> Affine3A {
        Affine3A::from_rotation_translation(self.turn, self.place)
    }

    /// Maps head space to the space whose origin is at `origin`.
    pub(crate) fn map_from_head(&self, origin: Vec3) -> Map {
        Map { turn: Mat3::from_quat(self.turn), shift: self.place - origin }
    }

    /// Interpolates by the fraction `t` toward `to`, along the shorter arc.
    pub(crate) fn interpolate(&self, to: &Self, t: f32) -> Self {
        if t >= 1.0 {
            return *to;
        }
        Self { turn: self.turn.slerp(to.turn, t).normalize(), place: self.place.lerp(to.place, t) }
    }

    /// Whether the head went from `self` to `to` by a jump.
    pub(crate) fn jumps_to(&self, to: &Self, time_before: f64, time_now: f64, dt_secs: f32) -> bool {
        let (moved, turned) = ((to.place - self.place).length(), self.turn.angle_between(to.turn));
        let passed = time_now - time_before;
        let cut = !(0.0..=PAUSE_SECS.max(4.0 * f64::from(dt_secs))).contains(&passed);
        moved > JUMP.0 || turned > JUMP.1 || (cut && (moved > CUT.0 || turned > CUT.1))
    }
}

/// The head at one substep, in working space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Substep {
    /// Carries head space to working space.
    pub(crate) head: Map,
    pub(crate) head_turn: Turn,
    /// Maps the position of a point that moves rigidly with the head to its velocity.
    pub(crate) rigid: Map,
}

impl Substep {
    #[inline(always)]
    pub(crate) fn rigid_velocity(&self, p: Vec3) -> Vec3 {
        self.rigid.apply(p)
    }
}

/// The rigid map that takes the head from `a` to `b`, relative to `origin`.
pub(crate) fn rigid_between(a: &HeadPose, b: &HeadPose, origin: Vec3) -> Map {
    let turn = Mat3::from_quat((b.turn * a.turn.inverse()).normalize());
    Map { turn, shift: (b.place - origin) - turn * (a.place - origin) }
}

/// The head at `now`, one substep of `h` seconds after `before`.
pub(crate) fn substep(before: &HeadPose, now: &HeadPose, origin: Vec3, h: f32) -> Substep {
    let carry = rigid_between(before, now, origin);
    let rate = 1.0 / h;
    // Velocity of the point that is at p before the substep.
    let rigid = Map { turn: (carry.turn - Mat3::IDENTITY) * rate, shift: carry.shift * rate };
    Substep { head: now.map_from_head(origin), head_turn: Turn::new(now.turn), rigid }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rigid_maps_carry_the_head() {
        let a = HeadPose { turn: Quat::from_rotation_x(0.3), place: Vec3::new(1.0, 2.0, 3.0) };
        let b = HeadPose { turn: Quat::from_rotation_y(-0.8), place: Vec3::new(1.2, 2.1, 2.9) };
        let origin = Vec3::new(1.0, 2.0, 2.5);
        let p = Vec3::new(0.1, 0.2, -0.1);
        let carried = rigid_between(&a, &b, origin).apply(a.map_from_head(origin).apply(p));
        assert!((carried - b.map_from_head(origin).apply(p)).length() < 1e-6);
        assert!((a.affine().transform_point3(p) - origin - a.map_from_head(origin).apply(p)).length() < 1e-6);
    }

    #[test]
    fn a_seek_is_a_jump_and_a_dance_is_not() {
        let a = HeadPose::IDENTITY;
        let near = HeadPose { turn: Quat::from_rotation_y(0.2), place: Vec3::new(0.06, 0.0, 0.0) };
        assert!(!a.jumps_to(&near, 1.0, 1.0 + 1.0 / 60.0, 1.0 / 60.0));
        assert!(a.jumps_to(&near, 8.0, 0.0, 1.0 / 60.0), "the same move across a cut is a jump");
        assert!(!a.jumps_to(&a, 8.0, 0.0, 1.0 / 60.0), "a loop that fits is none");
        let far = HeadPose { place: Vec3::new(0.6, 0.0, 0.0), ..a };
        assert!(a.jumps_to(&far, 1.0, 1.0, 1.0 / 60.0));
        let spun = HeadPose { turn: Quat::from_rotation_y(1.2), ..a };
        assert!(a.jumps_to(&spun, 1.0, 1.0, 1.0 / 60.0));
    }

    #[test]
    fn invalid_transforms_give_no_pose() {
        assert!(HeadPose::new(&Affine3A::NAN).is_none());
        assert!(HeadPose::new(&Affine3A::ZERO).is_none());
        let scaled = Affine3A::from_scale(Vec3::splat(2.0));
        assert!(HeadPose::new(&scaled).expect("a pose").turn.abs_diff_eq(Quat::IDENTITY, 1e-6));
    }
}
