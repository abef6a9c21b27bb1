//! Pieces of hair on their way into the grid: placed in parallel by block, added in parallel by layers of cells.
//!
//! Sums of integers come out the same in any order, so that threads change nothing.
// Calls of functions that ask for features of the processor, made by the macro after it has asked for them.
#![allow(unsafe_code)]

use glam::Vec3;
use lovelock_groom::simd::whole_part;
use lovelock_groom::simd_versions;

use super::cell::{Chunk, LAYERS, NUMBERS, PARTS};
use super::direction::outer;
use super::{DensityGrid, FASTEST, FULL, MOMENTUM, OFFSETS, SIDE};
use crate::block::Block;
use crate::lanes::{LANES, Lane3, Map, ZERO, ZERO3, at, direction_or, greater, lesser, put, row_done};
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

/// A piece of hair and where it lies, a line of the cache:
///
/// * what a cell gets of it for each unit of mass: 1, the velocity in units of the grid and below 1, and `t t^T`;
/// * where it is between the eight cells around it, from 0 to 1 along each axis;
/// * its mass, and the bits of the place of the first of those cells.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Piece([f32; NUMBERS]);

/// Where the last numbers of a piece stand.
const FRACTION: usize = PARTS;
const MASS: usize = PARTS + 3;
const BASE: usize = PARTS + 4;

/// The pieces of one block.
#[derive(Clone, Debug, Default)]
pub(super) struct Pieces {
    list: Vec<Piece>,
    /// The lowest and the highest layer that they touch.
    low: u32,
    high: u32,
}

impl Pieces {
    pub(super) fn clear(&mut self) {
        self.list.clear();
        (self.low, self.high) = (u32::MAX, 0);
    }

    /// Adds to the cells of `chunk` what lies there.
    #[inline(always)]
    fn add_to(&self, chunk: &mut Chunk) {
        let first = chunk.first;
        if (self.high as usize) < first || self.low as usize >= first + LAYERS {
            return;
        }
        let side = SIDE as usize;
        let start = first * side * side;
        for piece in &self.list {
            let base = piece.0[BASE].to_bits() as usize;
            let layer = base / (side * side);
            let below = layer.wrapping_sub(first) < LAYERS;
            let above = (layer + 1).wrapping_sub(first) < LAYERS;
            // The cells of the piece's own layer come first, then those of the next.
            let (from, to) = (if below { 0 } else { 4 }, if above { 8 } else { 4 });
            if from >= to {
                continue;
            }
            let (row, x) = (base / side, base % side);
            for layer in from / 4..to / 4 {
                let row = row + layer * side - first * side;
                for mask in &mut chunk.masks[row..row + 2] {
                    *mask |= 0b11 << x;
                }
            }
            let share = weights(Vec3::from_slice(&piece.0[FRACTION..]));
            let mass = piece.0[MASS];
            for n in from..to {
                let m = mass * share[n];
                let cell = &mut chunk.cells[base + OFFSETS[n] - start];
                let mut sum = *cell;
                for i in 0..NUMBERS {
                    let part = if i < PARTS { m * piece.0[i] } else { 0.0 };
                    // SAFETY: a number, and no larger than the mass but for rounding: below 2^30.
                    let part = unsafe { part.to_int_unchecked::<i32>() };
                    sum.0[i] = sum.0[i].wrapping_add(part);
                }
                *cell = sum;
                row_done();
            }
        }
    }
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

impl DensityGrid {
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

/// Puts every `stride`-th row of points of `block` on its way into `grid`: the middle of each run, so that the whole chain
/// is covered evenly.
#[inline(always)]
fn place(grid: &DensityGrid, source: &Source, block: &Block, out: &mut Pieces) {
    for i in (1 + (grid.stride - 1) / 2..block.points()).step_by(grid.stride) {
        let (mut p, mut v, mut t) = (block.rest.position[i], ZERO3, ZERO3);
        if let Source::Now { head_from_last, directed } = source {
            let (here, tangent) = (block.position[i], if *directed { tangents(block, i) } else { ZERO3 });
            v = block.velocity[i];
            for k in 0..LANES {
                put(&mut p, k, head_from_last.apply(at(&here, k)));
                put(&mut t, k, head_from_last.rotate(at(&tangent, k)));
            }
        }
        let corners = grid.corners(&p);
        let mut rows = [ZERO; MASS + 1];
        rows[FRACTION..MASS].copy_from_slice(&corners.fraction);
        let mut sound = [false; LANES];
        for k in 0..LANES {
            let (t, u) = (at(&t, k), at(&v, k));
            let finite = |v: Vec3| (v.x.abs() + v.y.abs() + v.z.abs()) <= f32::MAX;
            // Beyond the end of a guide that was cut there is no hair.
            let there = corners.inside[k] && block.rest.inv_length[i][k] > 0.0;
            sound[k] = there & finite(t) & !(u.x + u.y + u.z).is_nan();
            let u = u.to_array().map(|u| lesser(greater(u, -FASTEST), FASTEST) * MOMENTUM);
            let parts = outer(t);
            rows[0][k] = 1.0;
            for axis in 0..3 {
                rows[1 + axis][k] = u[axis];
            }
            for n in 0..6 {
                rows[4 + n][k] = parts[n];
            }
            let mass = block.rest.mean_link[k] * grid.stride as f32 * grid.units;
            // What is not a number, or more than all hair, has no mass.
            rows[MASS][k] = if (0.0..=FULL).contains(&mass) { mass } else { 0.0 };
        }
        for k in 0..block.used {
            if !sound[k] {
                continue;
            }
            let mut piece = Piece([0.0; NUMBERS]);
            for (to, from) in piece.0.iter_mut().zip(&rows) {
                *to = from[k];
            }
            let layer = corners.base[k] / (SIDE * SIDE) as u32;
            piece.0[BASE] = f32::from_bits(corners.base[k]);
            out.low = out.low.min(layer);
            out.high = out.high.max(layer + 1);
            out.list.push(piece);
        }
    }
}

simd_versions! {
    /// [`place`].
    pub(super) fn place_all(grid: &DensityGrid, source: &Source, block: &Block, out: &mut Pieces) -> () {
        place(grid, source, block, out)
    }
}

simd_versions! {
    /// [`Pieces::add_to`] of every block.
    pub(super) fn add_all(pieces: &[Pieces], chunk: &mut Chunk) -> () {
        for block in pieces {
            block.add_to(chunk);
        }
    }
}
