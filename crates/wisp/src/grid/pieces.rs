//! Pieces of hair on their way into the grid: placed in parallel by block, added in parallel by layers of cells.
//!
//! Sums of integers come out the same in any order, so that threads change nothing.

use glam::{IVec3, Vec3};

use super::direction::{Tensor, outer};
use super::{OFFSETS, SIDE, weights};

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
    /// Its velocity in the units of the grid.
    pub(super) velocity: Vec3,
    /// Its tangent; zero where none is wanted.
    pub(super) tangent: Vec3,
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
    pub(super) fn add_to(&self, chunk: usize, cells: &mut [[i32; 4]], directions: &mut [Tensor<i32>]) {
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
            let (share, v, tt) = (weights(piece.fraction), piece.velocity, outer(piece.tangent));
            let directed = piece.tangent != Vec3::ZERO;
            for n in from..to {
                let at = piece.base as usize + OFFSETS[n] - start;
                let m = piece.mass * share[n];
                if directed {
                    for (sum, part) in directions[at].iter_mut().zip(tt) {
                        *sum = sum.wrapping_add((m * part) as i32);
                    }
                }
                let add = [m as i32, (m * v.x) as i32, (m * v.y) as i32, (m * v.z) as i32];
                for (sum, add) in cells[at].iter_mut().zip(add) {
                    *sum = sum.wrapping_add(add);
                }
            }
        }
    }
}
