//! The depths at which the pixels of a tile are opaque, found while fragments are listed.
//!
//! Fragments may come in any order: those that are in the list already make a pixel opaque together, so nothing behind the farthest of them
//! is seen. The nearer the first ones are, the more of the others can be left out.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use glam::Vec4;

use super::fragments::Span;
use crate::cpu::math::least;
use crate::cpu::tile::{BLOCK_LANES, BLOCKS, BLOCKS_IN_ROW, OPAQUE};

/// What listed fragments may let through together before those behind them are left out. Products of the same numbers in another order differ
/// by rounding: with half of [`OPAQUE`], blending from near to far always ends before a fragment that is left out.
const CLOSED: f32 = 0.5 * OPAQUE;

/// The depths from which the pixels of a tile are opaque. Depths fall with distance; 0 is infinitely far.
#[derive(Clone, Debug)]
pub(crate) struct OpaqueDepths {
    /// What the listed fragments of each pixel let through together.
    through: [[f32; BLOCK_LANES]; BLOCKS],
    /// The depth of the farthest of them.
    farthest: [[f32; BLOCK_LANES]; BLOCKS],
    /// The depth behind which nothing is seen in each block, each row of blocks and the tile; 0 until all of their pixels are opaque.
    of_block: [f32; BLOCKS],
    of_row: [f32; BLOCKS / BLOCKS_IN_ROW],
    of_tile: f32,
}

impl Default for OpaqueDepths {
    fn default() -> Self {
        Self {
            through: [[1.0; BLOCK_LANES]; BLOCKS],
            farthest: [[f32::INFINITY; BLOCK_LANES]; BLOCKS],
            of_block: [0.0; BLOCKS],
            of_row: [0.0; BLOCKS / BLOCKS_IN_ROW],
            of_tile: 0.0,
        }
    }
}

impl OpaqueDepths {
    /// Begins another tile.
    pub fn clear(&mut self) {
        self.through.fill([1.0; BLOCK_LANES]);
        self.farthest.fill([f32::INFINITY; BLOCK_LANES]);
        self.of_block.fill(0.0);
        self.of_row.fill(0.0);
        self.of_tile = 0.0;
    }

    /// Whether something at `depth` may be seen in the tile.
    #[inline(always)]
    pub(super) fn shows(&self, depth: f32) -> bool {
        depth >= self.of_tile
    }

    /// Whether something at `depth` may be seen in a row of blocks.
    #[inline(always)]
    pub(super) fn shows_in_row(&self, row: usize, depth: f32) -> bool {
        depth >= self.of_row[row]
    }

    /// Whether something at `depth` may be seen in a block.
    #[inline(always)]
    pub(super) fn shows_in_block(&self, block: usize, depth: f32) -> bool {
        depth >= self.of_block[block]
    }

    /// Adds the fragments of a span, whose opacities in front of the body are `alpha`, and clears the opacities of those that are not seen.
    #[inline(always)]
    pub(super) fn admit(&mut self, span: &Span, alpha: &mut [f32; BLOCK_LANES]) {
        let at = span.block;
        let (through, farthest) = (&mut self.through[at], &mut self.farthest[at]);
        let mut most = Vec4::ZERO;
        for from in (0..BLOCK_LANES).step_by(4) {
            let four = |of: &[f32; BLOCK_LANES]| Vec4::from_slice(&of[from..from + 4]);
            let (depth, before, far) = (four(&span.depth), four(through), four(farthest));
            let behind = Vec4::select(before.cmpgt(Vec4::splat(CLOSED)), Vec4::ZERO, far);
            let seen = Vec4::select(depth.cmpge(behind), four(alpha), Vec4::ZERO);
            let left = before - seen * before;
            // In an opaque pixel no fragment that is seen is farther.
            let taken = Vec4::select(seen.cmpgt(Vec4::ZERO), depth, Vec4::INFINITY);
            far.min(taken).write_to_slice(&mut farthest[from..from + 4]);
            left.write_to_slice(&mut through[from..from + 4]);
            seen.write_to_slice(&mut alpha[from..from + 4]);
            most = most.max(left);
        }
        if self.of_block[at] == 0.0 && most.max_element() <= CLOSED {
            self.close(at);
        }
    }

    /// Closes a block whose pixels are all opaque.
    fn close(&mut self, block: usize) {
        let row = block / BLOCKS_IN_ROW;
        self.of_block[block] = least(&self.farthest[block]);
        let blocks = &self.of_block[row * BLOCKS_IN_ROW..(row + 1) * BLOCKS_IN_ROW];
        self.of_row[row] = blocks.iter().copied().fold(f32::INFINITY, f32::min);
        self.of_tile = least(&self.of_row);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn span(block: usize, depth: f32) -> Span {
        let all = |value| [value; BLOCK_LANES];
        Span { block, alpha: all(0.0), depth: all(depth), along: all(0.0), gain: all(1.0) }
    }

    #[test]
    fn what_lies_behind_the_farthest_of_opaque_fragments_is_not_seen_whatever_their_order() {
        let mut depths = OpaqueDepths::default();
        // Three fragments of nine tenths let through a thousandth, four a ten-thousandth, five less than is seen.
        for depth in [0.5, 0.9, 0.3, 0.7, 0.6] {
            assert!(depths.shows_in_block(3, 0.01));
            let mut alpha = [0.9; BLOCK_LANES];
            depths.admit(&span(3, depth), &mut alpha);
            assert_eq!(alpha, [0.9; BLOCK_LANES], "{depth}");
        }
        assert!(depths.shows_in_block(3, 0.3) && !depths.shows_in_block(3, 0.29));
        assert!(depths.shows_in_block(4, 0.01) && depths.shows_in_row(0, 0.01) && depths.shows(0.01));
        for (depth, seen) in [(0.29, 0.0), (0.31, 0.5)] {
            let mut alpha = [0.5; BLOCK_LANES];
            depths.admit(&span(3, depth), &mut alpha);
            assert_eq!(alpha, [seen; BLOCK_LANES], "{depth}");
        }
        for block in 0..BLOCKS {
            let depth = if block == 20 { 0.2 } else { 0.4 };
            depths.admit(&span(block, depth), &mut [1.0; BLOCK_LANES]);
        }
        assert!(depths.shows_in_row(1, 0.2) && !depths.shows_in_row(1, 0.19));
        assert!(!depths.shows_in_row(2, 0.3) && depths.shows(0.2) && !depths.shows(0.19));
        depths.clear();
        assert!(depths.shows(0.01));
    }

    #[test]
    fn a_block_stays_open_for_one_of_its_pixels() {
        let mut depths = OpaqueDepths::default();
        let mut alpha = [1.0; BLOCK_LANES];
        alpha[5] = 0.99;
        depths.admit(&span(0, 0.5), &mut alpha);
        assert!(depths.shows_in_block(0, 0.1));
        let mut alpha = [0.2; BLOCK_LANES];
        depths.admit(&span(0, 0.1), &mut alpha);
        assert!(alpha.iter().enumerate().all(|(lane, &alpha)| (alpha > 0.0) == (lane == 5)), "{alpha:?}");
    }
}
