//! Pieces of hair on their way into the grid: placed in parallel by block, added in parallel by layers of cells.
//!
//! Sums of integers come out the same in any order, so that threads change nothing.
// Calls of functions that ask for features of the processor, made by the macro after it has asked for them.
#![allow(unsafe_code)]

use glam::{IVec3, Vec3};
use lovelock_groom::simd_versions;

use super::direction::{Tensor, outer};
use super::{FULL, OFFSETS, SIDE, index, weights};
use crate::lanes::row_done;

/// Numbers of a cell: mass, momentum along each axis, sums of directions, and what fills a line of the cache.
const NUMBERS: usize = 16;

/// What lies in a cell, in fixed point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(align(64))]
pub(super) struct Cell([i32; NUMBERS]);

impl Cell {
    pub(super) const EMPTY: Self = Self([0; NUMBERS]);

    #[inline(always)]
    pub(super) fn mass(&self) -> i32 {
        self.0[0]
    }

    /// Mass, and momentum along each axis.
    #[inline(always)]
    pub(super) fn motion(&self) -> [i32; 4] {
        let [mass, x, y, z, ..] = self.0;
        [mass, x, y, z]
    }

    #[inline(always)]
    pub(super) fn directions(&self) -> Tensor<i32> {
        let [_, _, _, _, xx, yy, zz, xy, xz, yz, ..] = self.0;
        [xx, yy, zz, xy, xz, yz]
    }
}

/// Layers of cells that one task adds to.
const LAYERS: usize = 8;

/// The cells of as many layers.
pub(super) const CHUNK: usize = LAYERS * (SIDE * SIDE) as usize;

/// A piece of hair and where it lies.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    /// The first of the eight cells around it, and its layer.
    pub(super) base: u32,
    pub(super) layer: u32,
    /// Where it is between them.
    pub(super) fraction: Vec3,
    pub(super) mass: f32,
    /// What a cell gets of it for each unit of mass: the numbers of [`Cell`].
    parts: Parts,
}

/// See [`Piece::parts`].
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Parts([f32; NUMBERS]);

impl Piece {
    /// A piece of `mass` that moves at `velocity`, in units of the grid and below 1, and runs along the unit vector
    /// `tangent`, zero where that is not wanted. What is not a number, or more than [`FULL`], has no mass.
    #[inline(always)]
    pub(super) fn new(corner: IVec3, fraction: Vec3, mass: f32, velocity: Vec3, tangent: Vec3) -> Self {
        let [xx, yy, zz, xy, xz, yz] = outer(tangent);
        let v = velocity;
        let parts = Parts([1.0, v.x, v.y, v.z, xx, yy, zz, xy, xz, yz, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let mass = if (0.0..=FULL).contains(&mass) { mass } else { 0.0 };
        Self { base: index(corner) as u32, layer: corner.z as u32, fraction, mass, parts }
    }
}

/// The pieces of one block.
#[derive(Clone, Debug, Default)]
pub(super) struct Pieces {
    pub(super) list: Vec<Piece>,
    /// The box of cells that they touch, inclusive.
    pub(super) low: IVec3,
    pub(super) high: IVec3,
}

impl Pieces {
    pub(super) fn clear(&mut self) {
        self.list.clear();
        (self.low, self.high) = (IVec3::MAX, IVec3::MIN);
    }

    pub(super) fn push(&mut self, corner: IVec3, piece: Piece) {
        self.low = self.low.min(corner);
        self.high = self.high.max(corner + 1);
        self.list.push(piece);
    }

    /// Adds to the cells of the `chunk`-th run of layers what lies there.
    #[inline(always)]
    pub(super) fn add_to(&self, chunk: usize, cells: &mut [Cell]) {
        let first = chunk * LAYERS;
        if self.high.z < first as i32 || self.low.z >= (first + LAYERS) as i32 {
            return;
        }
        let start = chunk * CHUNK;
        for piece in &self.list {
            let below = (piece.layer as usize).wrapping_sub(first) < LAYERS;
            let above = (piece.layer as usize + 1).wrapping_sub(first) < LAYERS;
            // The cells of the piece's own layer come first, then those of the next.
            let (from, to) = (if below { 0 } else { 4 }, if above { 8 } else { 4 });
            if from >= to {
                continue;
            }
            let share = weights(piece.fraction);
            for n in from..to {
                let m = piece.mass * share[n];
                let cell = &mut cells[piece.base as usize + OFFSETS[n] - start];
                let (mut sum, parts) = (*cell, piece.parts);
                for i in 0..NUMBERS {
                    // SAFETY: a number, and no larger than the mass but for rounding: below 2^30.
                    let part = unsafe { (m * parts.0[i]).to_int_unchecked::<i32>() };
                    sum.0[i] = sum.0[i].wrapping_add(part);
                }
                *cell = sum;
                row_done();
            }
        }
    }
}

simd_versions! {
    /// [`Pieces::add_to`] of every block.
    pub(super) fn add_all(pieces: &[Pieces], chunk: usize, cells: &mut [Cell]) -> () {
        for block in pieces {
            block.add_to(chunk, cells);
        }
    }
}
