//! How hair is put into the grid: a row of points is placed side by side, and added piece by piece.
// Calls of functions that ask for features of the processor, made by the macro after it has asked for them; and integers of
// numbers that are known to fit.
#![allow(unsafe_code)]
// Lazy operators are branches, and loops over lanes with branches stay loops.
#![allow(clippy::needless_bitwise_bool)]

use glam::Vec3;
use lovelock_groom::simd::whole_part;
use lovelock_groom::simd_versions;

use super::cell::{Cells, NUMBERS};
use super::direction::outer;
use super::{FASTEST, FULL, Lattice, MOMENTUM, OFFSETS, SIDE};
use crate::block::Block;
use crate::lanes::{
    LANES, Lane, Lane3, Map, ZERO, ZERO3, at, choose, direction_or, greater, lesser, put, row_done,
    transposed,
};
use crate::trilinear::weights;

/// The square of the longest tangent that is one.
const UNIT: f32 = 1.01;

/// Which hair is put into the grid.
pub(super) enum Source<'a> {
    /// The hair at rest, without motion and directions.
    Rest,
    /// The hair as it is.
    Now {
        /// To head space.
        head_from_last: &'a Map,
        /// Whether anything heeds directions.
        directed: bool,
    },
}

/// Unit directions of the hair at a row of points; 0 where it has none.
#[inline(always)]
pub(super) fn tangents(block: &Block, i: usize) -> Lane3 {
    between(&block.position[i.saturating_sub(1)], &block.position[(i + 1).min(block.points() - 1)])
}

/// Unit directions from one row of points to another; 0 where there is none.
#[inline(always)]
fn between(from: &Lane3, to: &Lane3) -> Lane3 {
    let mut out = ZERO3;
    for k in 0..LANES {
        put(&mut out, k, direction_or(at(to, k) - at(from, k), Vec3::ZERO).0);
    }
    out
}

/// Every second lane of one of two rows, beginning with the first, and the others of the other.
#[inline(always)]
fn alternate(rows: &[Lane3], even: usize, odd: usize) -> Lane3 {
    let (even, odd) = (rows[even], rows[odd]);
    let mut out = ZERO3;
    for k in 0..LANES {
        put(&mut out, k, choose(k % 2 == 0, at(&even, k), at(&odd, k)));
    }
    out
}

/// Where a row of points lies in the grid.
pub(super) struct Corners {
    /// The first of the eight cells around each point.
    pub(super) base: [u32; LANES],
    /// Where it is between them, from 0 to 1 along each axis.
    pub(super) fraction: Lane3,
    /// Whether it is in the grid at all; if not, it is given the first cell.
    pub(super) inside: [bool; LANES],
}

impl Corners {
    /// What each of the eight cells has of each point.
    #[inline(always)]
    pub(super) fn weights(&self) -> [Lane; 8] {
        let mut out = [ZERO; 8];
        for k in 0..LANES {
            for (row, weight) in out.iter_mut().zip(weights(at(&self.fraction, k))) {
                row[k] = weight;
            }
        }
        out
    }
}

impl Lattice {
    /// Finds the points `p`, in head space.
    #[inline(always)]
    pub(super) fn corners(&self, p: &Lane3) -> Corners {
        let mut out = Corners { base: [0; LANES], fraction: ZERO3, inside: [true; LANES] };
        let strides = [1, SIDE, SIDE * SIDE];
        for k in 0..LANES {
            let q = (at(p, k) - self.min) / self.cell - 0.5;
            // Written so that what is not a number is outside.
            let within = |q: f32| q >= 0.0 && q < (SIDE - 1) as f32;
            let inside = within(q.x) & within(q.y) & within(q.z);
            let mut base = 0;
            for (axis, q) in q.to_array().into_iter().enumerate() {
                let q = if inside { q } else { 0.0 };
                let first = whole_part(q);
                base += first * strides[axis];
                out.fraction[axis][k] = q - first as f32;
            }
            (out.base[k], out.inside[k]) = (base as u32, inside);
        }
        out
    }
}

/// Adds to `cells` every `stride`-th point of each guide of `block`, in every second lane half a run further on: where pieces
/// lie side by side there are no gaps. A cell gets of a unit of mass 1, the velocity in units of the grid, and `t t^T`.
#[inline(always)]
fn add(lattice: &Lattice, source: &Source, block: &Block, cells: &mut Cells) {
    let Lattice { stride, units, .. } = *lattice;
    let (points, on) = (block.points(), stride / 2);
    let first = 1 + (stride - 1) / 2;
    // A piece stands for its share of the links, however they divide.
    let share =
        |first: usize| (points - 1) as f32 / (first..points).step_by(stride).count().max(1) as f32 * units;
    let shares = [share(first), share(first + on)];
    for i in (first..points).step_by(stride) {
        let odd = (i + on).min(points - 1);
        let there = [true, i + on < points];
        let (mut p, mut v, mut t) = (alternate(&block.rest.position, i, odd), ZERO3, ZERO3);
        if let Source::Now { head_from_last, directed } = source {
            let here = alternate(&block.position, i, odd);
            v = alternate(&block.velocity, i, odd);
            if *directed {
                let before = alternate(&block.position, i.saturating_sub(1), odd.saturating_sub(1));
                let after = alternate(&block.position, (i + 1).min(points - 1), (odd + 1).min(points - 1));
                t = between(&before, &after);
            }
            for k in 0..LANES {
                let tangent = at(&t, k);
                put(&mut p, k, head_from_last.apply(at(&here, k)));
                put(&mut t, k, head_from_last.rotate(tangent));
            }
        }
        let corners = lattice.corners(&p);
        let (mut parts, mut masses) = ([ZERO; NUMBERS], ZERO);
        for k in 0..LANES {
            let (t, u) = (at(&t, k), at(&v, k));
            // Beyond the end of a guide that was cut there is no hair.
            let inv_length =
                if k % 2 == 0 { block.rest.inv_length[i][k] } else { block.rest.inv_length[odd][k] };
            let hair = corners.inside[k] & (inv_length > 0.0) & there[k % 2] & (k < block.used);
            // What is not a number is none.
            let sound = hair & (t.length_squared() <= UNIT) & !(u.x + u.y + u.z).is_nan();
            let u = u.to_array().map(|u| lesser(greater(u, -FASTEST), FASTEST) * MOMENTUM);
            let directions = outer(t);
            parts[0][k] = 1.0;
            for axis in 0..3 {
                parts[1 + axis][k] = u[axis];
            }
            for n in 0..6 {
                parts[4 + n][k] = directions[n];
            }
            let mass = block.rest.mean_link[k] * shares[k % 2];
            // What is not a number, or more than all hair, has no mass.
            masses[k] = if sound & (0.0..=FULL).contains(&mass) { mass } else { 0.0 };
        }
        let (weights, parts) = (corners.weights().map(|weight| masses.times(weight)), transposed(&parts));
        for k in 0..LANES {
            if masses[k] > 0.0 {
                let base = corners.base[k] as usize;
                let held = cells.mark(base);
                for ((offset, weight), held) in OFFSETS.into_iter().zip(&weights).zip(held) {
                    // SAFETY: numbers, and none larger than the mass but for rounding, the mass of all hair being 2^29.
                    unsafe { cells.each[base + offset].add(held, weight[k], &parts[k]) };
                    row_done();
                }
            }
        }
    }
}

simd_versions! {
    /// [`add`].
    pub(super) fn add_block(lattice: &Lattice, source: &Source, block: &Block, cells: &mut Cells) -> () {
        add(lattice, source, block, cells)
    }
}
