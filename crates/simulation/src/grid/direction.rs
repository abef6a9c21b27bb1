//! The direction of the hair in a cell, and its effects: hair repels across its direction, not along it.
//!
//! Each piece of hair of length `l` and unit tangent `t` deposits `l t t^T` besides its mass. Around a point
//! these sum to `D = sum(l t t^T) / sum(l)`, of trace 1, and `c = 1 - t^T D t` is the fraction of the
//! surrounding hair that crosses a piece along `t`: 0 if all hair is parallel to it, 2/3 for isotropic
//! directions, 1 if all hair crosses it. With the anisotropy `a`:
//!
//! * repulsion acts across the hair: `f - a t (t . f)`, times `1 + a (3/2 c - 1/2)`;
//! * friction acts on the velocity of the surrounding hair relative to the piece, `u - v`; of its component
//!   along `t` only `1 - 0.7 a` remains.

use glam::Vec3;

/// Fraction of the friction along the hair that is lost at an anisotropy of 1.
pub(super) const LOST_ALONG: f32 = 0.7;

/// Sums of `l t t^T`: xx, yy, zz, xy, xz, yz.
pub(super) type Tensor<T> = [T; 6];

/// `t t^T`.
#[inline]
pub(super) fn outer(t: Vec3) -> Tensor<f32> {
    [t.x * t.x, t.y * t.y, t.z * t.z, t.x * t.y, t.x * t.z, t.y * t.z]
}

/// Fraction of the surrounding hair that crosses the direction `t`, 0 to 1; `sums` is over hair of total
/// length `mass`.
#[inline]
pub(super) fn crossing(sums: &Tensor<f32>, mass: f32, t: Vec3) -> f32 {
    let [xx, yy, zz, xy, xz, yz] = outer(t);
    let along =
        sums[0] * xx + sums[1] * yy + sums[2] * zz + 2.0 * (sums[3] * xy + sums[4] * xz + sums[5] * yz);
    (1.0 - along / mass).clamp(0.0, 1.0)
}

/// The repulsion of a piece of hair along `t`.
#[inline]
pub(super) fn push_across(push: Vec3, t: Vec3, crossing: f32, anisotropy: f32) -> Vec3 {
    (push - t * (anisotropy * t.dot(push))) * (1.0 + anisotropy * (1.5 * crossing - 0.5))
}

/// The velocity toward which friction draws a piece of hair along `t` that moves at `v`.
#[inline]
pub(super) fn friction_target(mean: Vec3, v: Vec3, t: Vec3, anisotropy: f32) -> Vec3 {
    mean - t * (LOST_ALONG * anisotropy * t.dot(mean - v))
}
