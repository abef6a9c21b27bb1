//! Rigid links: the length constraints of a whole chain solved at once.
//!
//! The lengths of a chain couple only neighbours, so the multipliers solve a symmetric tridiagonal system
//! `A l = r` with `A_ii = w_(i-1) + w_i` and `A_i,i+1 = -w_i n_i . n_(i+1)`. One Thomas elimination replaces
//! tens of relaxation sweeps along the chain (fast projection, Goldenthal et al. 2007; tridiagonal hair, Han
//! and Harada 2013). `w` is 1 for a free point and 0 for a point that the scalp carries.

use crate::lanes::{LANES, Lane, Lane3, ZERO, ZERO3, at, inv_sqrt, put};

/// Working memory of the elimination: one row per point.
#[derive(Clone, Debug, Default)]
pub(crate) struct LengthScratch {
    /// Right-hand side on input, multipliers on output.
    pub(super) multiplier: Vec<Lane>,
    /// The upper diagonal after elimination.
    upper: Vec<Lane>,
    /// Unit directions of the links; link `i` ends at point `i`.
    pub(super) direction: Vec<Lane3>,
    /// 1 minus the last point's `w`: 0, or 1 where the tip is held too.
    tip_held: f32,
}

impl LengthScratch {
    #[cfg(test)]
    pub(crate) fn new(points: usize) -> Self {
        let mut scratch = Self::default();
        scratch.fit(points);
        scratch
    }

    /// Resizes the rows for guides of `points` points.
    pub(crate) fn fit(&mut self, points: usize) {
        self.multiplier.resize(points, ZERO);
        self.upper.resize(points, ZERO);
        self.direction.resize(points, ZERO3);
    }

    /// Computes the directions of the links from `first` on, and how much each is too short.
    #[inline(always)]
    pub(crate) fn errors(&mut self, first: usize, length: &[Lane], position: &[Lane3]) {
        for i in first..position.len() {
            let (a, b, wanted) = (&position[i - 1], &position[i], &length[i]);
            let (mut direction, mut rhs) = (ZERO3, ZERO);
            for k in 0..LANES {
                let link = at(b, k) - at(a, k);
                let squared = link.length_squared();
                let inv = inv_sqrt(squared);
                let now = squared * inv;
                // A zero-length link has no direction; the placement pass gives it one. A link whose rest
                // length is 0 lies beyond the end of a guide that was cut, and exerts no force.
                let there = wanted[k] > 0.0;
                put(&mut direction, k, link * if there { inv } else { 0.0 });
                rhs[k] = if there { wanted[k] - now } else { 0.0 };
            }
            self.direction[i] = direction;
            self.multiplier[i] = rhs;
        }
    }
}

/// Removes the part of `velocity` that would change the length of a link, conserving the momentum of the free
/// points, and writes the positions after `h` seconds to `next`.
///
/// `inv_length` is the inverse length of each link in `position`; points before `first_free` are carried by
/// the scalp.
#[inline(always)]
pub(crate) fn project_velocity(
    first_free: usize,
    position: &[Lane3],
    inv_length: &[Lane],
    velocity: &mut [Lane3],
    h: f32,
    next: &mut [Lane3],
    scratch: &mut LengthScratch,
) {
    for i in first_free.max(1)..position.len() {
        let (a, b, inv) = (&position[i - 1], &position[i], &inv_length[i]);
        let (va, vb) = (&velocity[i - 1], &velocity[i]);
        let (mut direction, mut rhs) = (ZERO3, ZERO);
        for k in 0..LANES {
            let n = (at(b, k) - at(a, k)) * inv[k];
            put(&mut direction, k, n);
            rhs[k] = -n.dot(at(vb, k) - at(va, k));
        }
        scratch.direction[i] = direction;
        scratch.multiplier[i] = rhs;
    }
    solve(first_free, scratch);
    for (i, ((x, v), next)) in position.iter().zip(velocity).zip(next).enumerate() {
        if i >= first_free {
            pull(i, v, scratch);
        }
        let (mut there, left) = (ZERO3, *v);
        for k in 0..LANES {
            put(&mut there, k, at(x, k) + at(&left, k) * h);
        }
        *next = there;
    }
}

/// One Newton step that brings the links of `position` to their lengths.
#[inline(always)]
pub(crate) fn project_position(
    first_free: usize,
    length: &[Lane],
    position: &mut [Lane3],
    scratch: &mut LengthScratch,
) {
    scratch.errors(first_free.max(1), length, position);
    solve(first_free, scratch);
    apply(first_free, position, scratch);
}

/// Thomas elimination in every lane. The matrix is weakly diagonally dominant, so no pivoting is needed.
#[inline(always)]
fn solve(first_free: usize, scratch: &mut LengthScratch) {
    let (first, count) = (first_free.max(1), scratch.direction.len());
    let (mut upper, mut rhs, mut off) = (ZERO, ZERO, ZERO);
    for i in first..count {
        // The carried end of the first link has no weight.
        let last = i + 1 == count;
        let diagonal =
            if i == first_free { 0.0 } else { 1.0 } + if last { 1.0 - scratch.tip_held } else { 1.0 };
        let n = &scratch.direction[i];
        let n_next = &scratch.direction[if last { i } else { i + 1 }];
        let mut r = scratch.multiplier[i];
        for k in 0..LANES {
            let pivot = 1.0 / (diagonal - off[k] * upper[k]);
            r[k] = (r[k] - off[k] * rhs[k]) * pivot;
            off[k] = if last { 0.0 } else { -at(n, k).dot(at(n_next, k)) };
            upper[k] = off[k] * pivot;
        }
        rhs = r;
        scratch.multiplier[i] = r;
        scratch.upper[i] = upper;
    }
    let mut after = ZERO;
    for i in (first..count).rev() {
        let (mut r, upper) = (scratch.multiplier[i], &scratch.upper[i]);
        for k in 0..LANES {
            r[k] -= upper[k] * after[k];
        }
        after = r;
        scratch.multiplier[i] = r;
    }
}

/// Moves every free point by the multipliers of its two links.
#[inline(always)]
fn apply(first_free: usize, rows: &mut [Lane3], scratch: &LengthScratch) {
    for (i, row) in rows.iter_mut().enumerate().skip(first_free) {
        pull(i, row, scratch);
    }
}

/// Moves the free point `i` by the multipliers of its two links.
#[inline(always)]
fn pull(i: usize, point: &mut Lane3, scratch: &LengthScratch) {
    let (mut row, count) = (*point, scratch.direction.len());
    if i > 0 {
        let (n, mut l) = (&scratch.direction[i], scratch.multiplier[i]);
        if i + 1 == count {
            l = Lane(l.map(|l| l * (1.0 - scratch.tip_held)));
        }
        for k in 0..LANES {
            let moved = at(&row, k) + at(n, k) * l[k];
            put(&mut row, k, moved);
        }
    }
    if i + 1 < count {
        let (n, l) = (&scratch.direction[i + 1], &scratch.multiplier[i + 1]);
        for k in 0..LANES {
            let moved = at(&row, k) - at(n, k) * l[k];
            put(&mut row, k, moved);
        }
    }
    *point = row;
}

#[cfg(test)]
mod tests;
