//! What is known of the field around the points of a block: for each point a nearby plane, which approximates
//! the skin until the point has moved too far from where it was measured.
//!
//! A step needs the skin in every substep and in every iteration of a push-out. The rest position is computed
//! at the point's unconstrained position in the first substep, for all points of a block together
//! ([`MovingField::prefetch_planes`](super::MovingField::prefetch_planes)), and again when the point has
//! moved away by [`NEAR`], or by half its distance from contact where that is larger and only the head moves
//! the skin. In between the skin is approximated by its tangent plane, which moves with the drift. The side
//! of a fold that a point is on is determined once per step. Over a surface of radius `R` a plane is off by
//! at most `NEAR^2 / 2 R`: 0.01 mm over the skull, 0.1 mm at the rim of an ear.

use glam::Vec3;

use crate::lanes::{Lane, Lane3, ZERO, ZERO3, at, splat3};
use crate::motion::Substep;

/// Distance from the measured position within which a plane near contact is valid, metres.
pub(crate) const NEAR: f32 = 0.0015;

/// Distance of missing skin.
pub(super) const NONE: f32 = 1e9;

/// The planes of one row of points, in head space.
#[derive(Clone, Debug)]
pub(crate) struct PlaneRow {
    /// Where the points were measured, and the squared distance from there within which that is valid;
    /// negative if nothing was measured.
    pub(super) place: Lane3,
    pub(super) valid_squared: Lane,
    /// The fraction of the step that had passed.
    pub(super) passed: Lane,
    /// Skin that moves with the head: distance at `place`, and normal.
    pub(super) head_distance: Lane,
    pub(super) head_normal: Lane3,
    /// Skin that other joints move too: distance, normal, the head's weight, and velocity relative to the
    /// head.
    pub(super) skin_distance: Lane,
    pub(super) skin_normal: Lane3,
    pub(super) share: Lane,
    pub(super) drift: Lane3,
    /// 1 if that skin is a guess, otherwise 0.
    pub(super) guess: Lane,
    /// Whether any lane has skin nearby.
    pub(super) any: bool,
    /// Rest positions of the points when skin that other joints move was last found near them; [`NOWHERE`] if
    /// it was not. Unlike the other fields this is kept from step to step: folded skin has several rest
    /// positions, and a point stays on its side of the fold.
    pub(crate) rest: Lane3,
}

/// Marks a missing rest position.
pub(super) const NOWHERE: Vec3 = Vec3::splat(f32::MAX);

impl PlaneRow {
    /// A row without any skin nearby.
    pub(crate) const NO_SKIN: Lane3 = splat3(NOWHERE);

    /// Nothing has been measured yet; `rest` is taken over from the last step.
    pub(crate) const fn unknown(rest: Lane3) -> Self {
        Self {
            place: ZERO3,
            valid_squared: Lane::splat(-1.0),
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

/// The field around a row of points, in working space; lanes far from it have a huge distance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FieldRow {
    pub(crate) distance: Lane,
    pub(crate) normal: Lane3,
    /// The head's weight at the skin.
    pub(crate) head: Lane,
    /// Velocity of the skin relative to the head, metres per second.
    pub(super) drift: Lane3,
    /// 1 if the skin is a guess, otherwise 0: it may push, but the penetration depth is unknown.
    pub(crate) guess: Lane,
}

impl FieldRow {
    /// Velocity of the skin near lane `k`, for a point at `p`.
    #[inline(always)]
    pub(crate) fn velocity(&self, k: usize, p: Vec3, substep: &Substep) -> Vec3 {
        substep.rigid_velocity(p) + at(&self.drift, k)
    }
}
