//! What the points of a block have learnt of the field: each a plane near by, taken for the skin until the
//! point has moved too far from where it was measured.
//!
//! A step asks for the skin in every substep and in every round of a push-out. The way back to rest is
//! measured where a point wants to be in the first substep, for all points of a block together
//! ([`MovingField::foresee`]), and anew wherever it has left the place by [`NEAR`], or by half its distance
//! from contact where that is more and the skin is the head's alone; in between the skin is its tangent plane,
//! which moves with the drift. On which side of a fold of the skin a point is, is asked once a step. A plane is off
//! by `NEAR^2 / 2 R` at most over a surface of radius `R`: 0.01 mm over the skull, 0.1 mm at the rim of an ear.

use glam::Vec3;

use crate::lanes::{Lane, Lane3, ZERO, ZERO3, at, splat3};
use crate::motion::Substep;

/// So far from where it was measured a plane near contact serves, metres.
pub(crate) const NEAR: f32 = 0.0015;

/// The distance of a skin that is not there.
pub(super) const NONE: f32 = 1e9;

/// The planes of one row of points, in head space.
#[derive(Clone, Debug)]
pub(crate) struct PlaneRow {
    /// Where the points were measured, and the square of how far from there that serves; negative where none
    /// was.
    pub(super) place: Lane3,
    pub(super) serves: Lane,
    /// How much of the step had passed.
    pub(super) passed: Lane,
    /// Skin that goes with the head: distance at `place`, and normal.
    pub(super) head_distance: Lane,
    pub(super) head_normal: Lane3,
    /// Skin that other joints move too: the same, the head's share of it, and its velocity against the head.
    pub(super) skin_distance: Lane,
    pub(super) skin_normal: Lane3,
    pub(super) share: Lane,
    pub(super) drift: Lane3,
    /// 1 where that skin is a guess, else 0.
    pub(super) guess: Lane,
    /// Whether any lane has skin near by.
    pub(super) any: bool,
    /// Where the points were at rest when skin that other joints move too was last found near them;
    /// [`NOWHERE`] where it was not. Unlike the rest this is kept from step to step: where skin is folded
    /// there are several ways back, and what is near one side of the fold stays there.
    pub(crate) rest: Lane3,
}

/// No place at rest.
pub(super) const NOWHERE: Vec3 = Vec3::splat(f32::MAX);

impl PlaneRow {
    /// A row near which no skin has been found.
    pub(crate) const NO_SKIN: Lane3 = splat3(NOWHERE);

    /// Nothing has been measured yet; `rest` is what is known from the last step.
    pub(crate) const fn unknown(rest: Lane3) -> Self {
        Self {
            place: ZERO3,
            serves: Lane::splat(-1.0),
            passed: ZERO,
            head_distance: Lane::splat(NONE),
            head_normal: ZERO3,
            skin_distance: Lane::splat(NONE),
            skin_normal: ZERO3,
            share: ZERO,
            drift: ZERO3,
            guess: ZERO,
            any: false,
            rest,
        }
    }
}

/// What a row of points learns of the field, in working space; lanes far from it have a huge distance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FieldRow {
    pub(crate) distance: Lane,
    pub(crate) normal: Lane3,
    /// The head's share of the skin.
    pub(crate) head: Lane,
    /// Velocity of the skin against the head, metres per second.
    pub(super) drift: Lane3,
    /// 1 where the skin is a guess, else 0: it may push, and nobody knows how deep hair is in it.
    pub(crate) guess: Lane,
}

impl FieldRow {
    /// Velocity of the skin near lane `k`, a point of which is at `p`.
    #[inline(always)]
    pub(crate) fn velocity(&self, k: usize, p: Vec3, substep: &Substep) -> Vec3 {
        substep.rigid_velocity(p) + at(&self.drift, k)
    }
}
