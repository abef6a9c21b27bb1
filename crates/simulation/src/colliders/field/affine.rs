//! Affine maps of weighted joints, and interpolation between the nodes around a point.

use glam::{Vec3, Vec4};

use crate::lanes::Lane;

/// A matrix by columns and a translation, four numbers each; the last number of the translation is the head's
/// weight.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub(super) struct Affine([f32; 16]);

impl Affine {
    pub(super) const IDENTITY: Self =
        Self([1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);

    /// The neutral element of a sum.
    pub(super) const ZERO: Self = Self([0.0; 16]);

    /// The image of a point; the last component has no meaning.
    #[inline(always)]
    pub(super) fn apply(&self, p: Vec3) -> Vec4 {
        let column = |i: usize| Vec4::from_slice(&self.0[4 * i..4 * i + 4]);
        column(0) * p.x + column(1) * p.y + (column(2) * p.z + column(3))
    }

    /// All numbers in order; the last is the head's weight.
    #[inline(always)]
    pub(super) fn numbers(&self) -> [f32; 16] {
        self.0
    }

    /// Adds `weight` times `other`.
    #[inline(always)]
    pub(super) fn plus(&self, other: &Self, weight: f32) -> Self {
        let mut out = [0.0; 16];
        for i in 0..16 {
            out[i] = self.0[i] + other.0[i] * weight;
        }
        Self(out)
    }

    /// Interpolates by the fraction `t` toward `other`.
    #[inline(always)]
    pub(super) fn toward(&self, other: &Self, t: f32) -> Self {
        let mut out = [0.0; 16];
        for i in 0..16 {
            out[i] = self.0[i] + (other.0[i] - self.0[i]) * t;
        }
        Self(out)
    }
}

impl From<Lane> for Affine {
    #[inline(always)]
    fn from(numbers: Lane) -> Self {
        Self(numbers.0)
    }
}

/// Trilinear interpolation of eight values, x fastest, at the fractions `f`, and its derivatives along the
/// axes.
#[inline(always)]
pub(super) fn trilinear(q: &[Vec4; 8], f: Vec3) -> (Vec4, [Vec4; 3]) {
    let mix = |a: Vec4, b: Vec4, t: f32| a + (b - a) * t;
    let edge: [Vec4; 4] = std::array::from_fn(|i| mix(q[2 * i], q[2 * i + 1], f.x));
    let step: [Vec4; 4] = std::array::from_fn(|i| q[2 * i + 1] - q[2 * i]);
    let (low, high) = (mix(edge[0], edge[1], f.y), mix(edge[2], edge[3], f.y));
    let x = mix(mix(step[0], step[1], f.y), mix(step[2], step[3], f.y), f.z);
    let y = mix(edge[1] - edge[0], edge[3] - edge[2], f.z);
    (mix(low, high, f.z), [x, y, high - low])
}
