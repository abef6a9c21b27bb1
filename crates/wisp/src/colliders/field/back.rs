//! The way back to rest of a weighting of joints, and of all the weightings around a place.

use glam::{Affine3A, Mat3A, Vec3, Vec3A};

/// A matrix by columns and a shift, four numbers each; the last of the shift is the head's share of the weights.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(align(64))]
pub(super) struct Back([f32; 16]);

impl Back {
    pub(super) const IDENTITY: Self =
        Self([1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);

    /// What is added up to others.
    pub(super) const NOTHING: Self = Self([0.0; 16]);

    pub(super) fn new(m: &Affine3A, head: f32) -> Self {
        let mut out = [0.0; 16];
        for (column, from) in out.as_chunks_mut::<4>().0.iter_mut().zip(m.to_cols_array_2d()) {
            column[..3].copy_from_slice(&from);
        }
        out[15] = head;
        Self(out)
    }

    #[inline(always)]
    fn column(&self, i: usize) -> Vec3A {
        Vec3A::from_slice(&self.0[4 * i..4 * i + 3])
    }

    /// The map of a point.
    #[inline(always)]
    pub(super) fn apply(&self, p: Vec3) -> Vec3A {
        self.column(0) * p.x + self.column(1) * p.y + self.column(2) * p.z + self.column(3)
    }

    /// The transpose of the matrix times a vector: gradients at rest become gradients now.
    #[inline(always)]
    pub(super) fn turn_forth(&self, v: Vec3A) -> Vec3 {
        Vec3::new(self.column(0).dot(v), self.column(1).dot(v), self.column(2).dot(v))
    }

    /// The head's share of the weights.
    #[inline(always)]
    pub(super) fn head(&self) -> f32 {
        self.0[15]
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

    #[inline(always)]
    pub(super) fn less(&self, other: &Self) -> Self {
        let mut out = [0.0; 16];
        for i in 0..16 {
            out[i] = self.0[i] - other.0[i];
        }
        Self(out)
    }

    /// A fraction `t` of the way to `other`.
    #[inline(always)]
    pub(super) fn toward(&self, other: &Self, t: f32) -> Self {
        let mut out = [0.0; 16];
        for i in 0..16 {
            out[i] = self.0[i] + (other.0[i] - self.0[i]) * t;
        }
        Self(out)
    }
}

/// The map between the eight nodes around a place, and how it changes along the axes, per cell.
pub(super) struct Around {
    pub(super) back: Back,
    along: [Back; 3],
}

impl Around {
    /// Between the maps of the nodes, x fastest, at the fractions `f`.
    #[inline(always)]
    pub(super) fn new(corners: &[Back; 8], f: Vec3) -> Self {
        let edge = |i: usize| corners[2 * i].toward(&corners[2 * i + 1], f.x);
        let (a, b, c, d) = (edge(0), edge(1), edge(2), edge(3));
        let (low, high) = (a.toward(&b, f.y), c.toward(&d, f.y));
        let step = |i: usize| corners[2 * i + 1].less(&corners[2 * i]);
        let x = step(0).toward(&step(1), f.y).toward(&step(2).toward(&step(3), f.y), f.z);
        let y = b.less(&a).toward(&d.less(&c), f.z);
        Self { back: low.toward(&high, f.z), along: [x, y, high.less(&low)] }
    }

    /// Columns: how what the maps make of `p` changes along the axes, per cell.
    #[inline(always)]
    pub(super) fn slope(&self, p: Vec3) -> Mat3A {
        let [x, y, z] = &self.along;
        Mat3A::from_cols(x.apply(p), y.apply(p), z.apply(p))
    }
}
