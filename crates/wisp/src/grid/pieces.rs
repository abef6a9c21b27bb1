//! How hair is put into the grid: a row of points is placed side by side, and added piece by piece.
// Calls of functions that ask for features of the processor, made by the macro after it has asked for them.
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
    LANES, Lane, Lane3, Map, ZERO, ZERO3, at, direction_or, greater, lesser, put, row_done, transposed,
};
use crate::trilinear::weights;

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
    let (a, b) = (block.position[i.saturating_sub(1)], block.position[(i + 1).min(block.points() - 1)]);
    let mut out = ZERO3;
    for k in 0..LANES {
        put(&mut out, k, direction_or(at(&b, k) - at(&a, k), Vec3::ZERO).0);
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

/// Adds every `stride`-th row of points of `block` to `cells`: the middle of each run, and of an `odd` block its end. So the
/// whole chain is covered evenly, and where pieces lie side by side there are no gaps from block to block. A cell gets of a unit of mass 1, the velocity in units of the grid, and `t t^T`.
#[inline(always)]
fn add(lattice: &Lattice, source: &Source, block: &Block, odd: bool, cells: &mut Cells) {
    let Lattice { stride, units, .. } = *lattice;
    let first = 1 + (stride - 1) / 2 + if odd { stride / 2 } else { 0 };
    for i in (first..block.points()).step_by(stride) {
        let (mut p, mut v, mut t) = (block.rest.position[i], ZERO3, ZERO3);
        if let Source::Now { head_from_last, directed } = source {
            let (here, tangent) = (block.position[i], if *directed { tangents(block, i) } else { ZERO3 });
            v = block.velocity[i];
            for k in 0..LANES {
                put(&mut p, k, head_from_last.apply(at(&here, k)));
                put(&mut t, k, head_from_last.rotate(at(&tangent, k)));
            }
        }
        let corners = lattice.corners(&p);
        let (mut parts, mut masses) = ([ZERO; NUMBERS], ZERO);
        for k in 0..LANES {
            let (t, u) = (at(&t, k), at(&v, k));
            let finite = |v: Vec3| (v.x.abs() + v.y.abs() + v.z.abs()) <= f32::MAX;
            // Beyond the end of a guide that was cut there is no hair.
            let there = corners.inside[k] & (block.rest.inv_length[i][k] > 0.0);
            let sound = there & finite(t) & !(u.x + u.y + u.z).is_nan() & (k < block.used);
            let u = u.to_array().map(|u| lesser(greater(u, -FASTEST), FASTEST) * MOMENTUM);
            let directions = outer(t);
            parts[0][k] = 1.0;
            for axis in 0..3 {
                parts[1 + axis][k] = u[axis];
            }
            for n in 0..6 {
                parts[4 + n][k] = directions[n];
            }
            let mass = block.rest.mean_link[k] * stride as f32 * units;
            // What is not a number, or more than all hair, has no mass.
            masses[k] = if sound & (0.0..=FULL).contains(&mass) { mass } else { 0.0 };
        }
        let (weights, parts) = (corners.weights().map(|weight| masses.times(weight)), transposed(&parts));
        for k in 0..LANES {
            if masses[k] > 0.0 {
                let base = corners.base[k] as usize;
                cells.mark(base);
                for (offset, weight) in OFFSETS.into_iter().zip(&weights) {
                    // SAFETY: numbers, and none larger than the mass but for rounding: below 2^30.
                    unsafe { cells.cells[base + offset].add(weight[k], &parts[k]) };
                    row_done();
                }
            }
        }
    }
}

simd_versions! {
    /// [`add`].
    pub(super) fn add_block(lattice: &Lattice, source: &Source, block: &Block, odd: bool, cells: &mut Cells) -> () {
        add(lattice, source, block, odd, cells)
    }
}
