//! Depositing hair into the grid: a row of points is located at once and added piece by piece.
// `unsafe` is used by the macro, which calls functions that require CPU features after checking for them, and
// converts floats that are known to fit to integers.
#![allow(unsafe_code)]
// Lazy operators are branches, and the compiler does not vectorise loops over lanes that branch.
#![allow(clippy::needless_bitwise_bool)]

use glam::Vec3;
use lovelock_base::simd::whole_part;
use lovelock_base::simd_versions;

use super::cell::{Cells, NUMBERS};
use super::direction::outer;
use super::{Counting, FASTEST, FULL, Lattice, MOMENTUM, OFFSETS, SIDES};
use crate::block::Block;
use crate::lanes::{
    LANES, Lane, Lane3, Map, ZERO, ZERO3, at, choose, direction_or, greater, lesser, put, row_barrier,
    transposed,
};
use crate::trilinear::weights;

/// Upper limit of the squared length of a tangent.
pub(super) const UNIT: f32 = 1.01;

/// Which state of the hair is deposited.
pub(super) enum Source<'a> {
    /// The hair at rest, without velocities and directions.
    Rest,
    /// The current hair.
    Now {
        /// Maps positions to head space.
        head_from_last: &'a Map,
        /// Whether anything uses directions.
        directed: bool,
    },
}

/// Unit tangents at a row of points; 0 where there is none.
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

/// Takes the even lanes from one row and the odd lanes from another.
#[inline(always)]
fn interleave(rows: &[Lane3], even: usize, odd: usize) -> Lane3 {
    let (even, odd) = (rows[even], rows[odd]);
    let mut out = ZERO3;
    for k in 0..LANES {
        put(&mut out, k, choose(k % 2 == 0, at(&even, k), at(&odd, k)));
    }
    out
}

/// Positions of a row of points in the grid.
pub(super) struct Corners {
    /// Index of the first of the eight cells around each point.
    pub(super) base: [u32; LANES],
    /// Position between those cells, 0 to 1 along each axis.
    pub(super) fraction: Lane3,
    /// Whether the point is in the grid; if not, it is assigned to the first cell.
    pub(super) inside: [bool; LANES],
}

impl Corners {
    /// The fractions by which a deposit is shared: whole numbers put it into the cell that contains the point.
    #[inline(always)]
    fn counted(mut self, counting: Counting) -> Self {
        if counting == Counting::Nearest {
            for axis in &mut self.fraction {
                for k in 0..LANES {
                    axis[k] = if axis[k] < 0.5 { 0.0 } else { 1.0 };
                }
            }
        }
        self
    }

    /// Weights of the eight cells for each point.
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
    /// Locates the points `p`, in head space.
    #[inline(always)]
    pub(super) fn corners(&self, p: &Lane3) -> Corners {
        let mut out = Corners { base: [0; LANES], fraction: ZERO3, inside: [true; LANES] };
        let strides = [1, SIDES.x, SIDES.x * SIDES.y];
        for k in 0..LANES {
            let q = (at(p, k) - self.min) / self.cell - 0.5;
            // Written so that NaN is outside.
            let within = |q: f32, side: i32| q >= 0.0 && q < (side - 1) as f32;
            let inside = within(q.x, SIDES.x) & within(q.y, SIDES.y) & within(q.z, SIDES.z);
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

/// Adds every `stride`-th point of each guide of `block` to `cells`. In every second lane the points are
/// shifted by half a stride, so that neighbouring guides leave no gaps. Per unit of mass a cell receives 1,
/// the velocity in units of the grid, and `t t^T`.
#[inline(always)]
fn add(lattice: &Lattice, counting: Counting, source: &Source, block: &Block, cells: &mut Cells) {
    let Lattice { stride, units, .. } = *lattice;
    let (points, on) = (block.points(), stride / 2);
    let first = 1 + (stride - 1) / 2;
    // Each piece represents an equal share of the links.
    let share =
        |first: usize| (points - 1) as f32 / (first..points).step_by(stride).count().max(1) as f32 * units;
    let shares = [share(first), share(first + on)];
    for i in (first..points).step_by(stride) {
        let odd = (i + on).min(points - 1);
        let there = [true, i + on < points];
        let (mut p, mut v, mut t) = (interleave(&block.rest.position, i, odd), ZERO3, ZERO3);
        if let Source::Now { head_from_last, directed } = source {
            let here = interleave(&block.position, i, odd);
            v = interleave(&block.velocity, i, odd);
            if *directed {
                let before = interleave(&block.position, i.saturating_sub(1), odd.saturating_sub(1));
                let after = interleave(&block.position, (i + 1).min(points - 1), (odd + 1).min(points - 1));
                t = between(&before, &after);
            }
            for k in 0..LANES {
                let tangent = at(&t, k);
                put(&mut p, k, head_from_last.apply(at(&here, k)));
                put(&mut t, k, head_from_last.rotate(tangent));
            }
        }
        let corners = lattice.corners(&p).counted(counting);
        let (mut parts, mut masses) = ([ZERO; NUMBERS], ZERO);
        for k in 0..LANES {
            let (t, u) = (at(&t, k), at(&v, k));
            // There is no hair beyond the end of a guide that was cut.
            let inv_length =
                if k % 2 == 0 { block.rest.inv_length[i][k] } else { block.rest.inv_length[odd][k] };
            let hair = corners.inside[k] & (inv_length > 0.0) & there[k % 2] & (k < block.used);
            // Rejects NaN.
            let valid = hair & (t.length_squared() <= UNIT) & !(u.x + u.y + u.z).is_nan();
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
            // NaN, or more than all the hair, counts as no mass.
            masses[k] = if valid & (0.0..=FULL).contains(&mass) { mass } else { 0.0 };
        }
        let (weights, parts) = (corners.weights().map(|weight| masses.times(weight)), transposed(&parts));
        for k in 0..LANES {
            if masses[k] > 0.0 {
                let base = corners.base[k] as usize;
                let held = cells.mark(base);
                for ((offset, weight), held) in OFFSETS.into_iter().zip(&weights).zip(held) {
                    // SAFETY: finite numbers, none larger than the mass up to rounding, and the mass of all
                    // hair is 2^29.
                    unsafe { cells.each[base + offset].add(held, weight[k], &parts[k]) };
                    row_barrier();
                }
            }
        }
    }
}

simd_versions! {
    /// [`add`].
    pub(super) fn add_block(
        lattice: &Lattice, counting: Counting, source: &Source, block: &Block, cells: &mut Cells
    ) -> () {
        add(lattice, counting, source, block, cells)
    }
}
