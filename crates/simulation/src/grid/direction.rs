//! Which way the hair in a cell runs, and what that changes: hair pushes across itself, not along.
//!
//! Each piece of hair of length `l` and unit tangent `t` leaves `l t t^T` beside its mass. Around a point these sum
//! to `D = sum(l t t^T) / sum(l)`, of trace 1, and `c = 1 - t^T D t` says how much of the hair around crosses a piece
//! that runs along `t`: 0 where all is parallel to it, 2/3 where directions are any, 1 where all crosses.
//! With the anisotropy `a`:
//!
//! * repulsion acts across: `f - a t (t . f)`, times `1 + a (3/2 c - 1/2)`;
//! * friction acts on the velocity of the hair around relative to the piece's own, `u - v`, and of its part along
//!   `t` only `1 - 0.7 a` is left.

use glam::Vec3;

/// What of the friction along hair is lost at an anisotropy of 1.
const SLIDES: f32 = 0.7;

/// Sums of `l t t^T`: xx, yy, zz, xy, xz, yz.
pub(super) type Tensor<T> = [T; 6];

/// `t t^T`.
#[inline]
pub(super) fn outer(t: Vec3) -> Tensor<f32> {
    [t.x * t.x, t.y * t.y, t.z * t.z, t.x * t.y, t.x * t.z, t.y * t.z]
}

/// How much of the hair around crosses the direction `t`, 0 to 1; `sums` over hair of length `mass` in all.
#[inline]
pub(super) fn crossing(sums: &Tensor<f32>, mass: f32, t: Vec3) -> f32 {
    let [xx, yy, zz, xy, xz, yz] = outer(t);
    let along =
        sums[0] * xx + sums[1] * yy + sums[2] * zz + 2.0 * (sums[3] * xy + sums[4] * xz + sums[5] * yz);
    (1.0 - along / mass).clamp(0.0, 1.0)
}

/// The push of the grid on a piece of hair along `t`.
#[inline]
pub(super) fn push_across(push: Vec3, t: Vec3, crossing: f32, anisotropy: f32) -> Vec3 {
    (push - t * (anisotropy * t.dot(push))) * (1.0 + anisotropy * (1.5 * crossing - 0.5))
}

/// The velocity that friction draws a piece of hair along `t` to, that moves at `v`.
#[inline]
pub(super) fn drawn_to(mean: Vec3, v: Vec3, t: Vec3, anisotropy: f32) -> Vec3 {
    mean - t * (SLIDES * anisotropy * t.dot(mean - v))
}
