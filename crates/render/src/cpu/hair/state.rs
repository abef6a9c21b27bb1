//! What the pixels of a tile hold while segments are blended from near to far, and which blocks are opaque already.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use glam::Vec4;

use crate::cpu::tile::{
    BLOCK_LANES, BLOCK_WIDTH, BLOCKS, BLOCKS_IN_ROW, HairPlanes, STRIDE, UNSEEN, pixel_of,
};

/// The state of a tile during blending, in blocks.
#[derive(Clone, Debug)]
pub(crate) struct BlendState {
    pub(super) color: [[[f32; BLOCK_LANES]; BLOCKS]; 3],
    pub(super) through: [[f32; BLOCK_LANES]; BLOCKS],
    /// Blocks that are opaque: nothing behind them is visible.
    closed: [bool; BLOCKS],
    /// The number of other blocks in each row of blocks, and in the tile.
    open_in_row: [usize; BLOCKS / BLOCKS_IN_ROW],
    open: usize,
}

impl Default for BlendState {
    fn default() -> Self {
        Self {
            color: [[[0.0; BLOCK_LANES]; BLOCKS]; 3],
            through: [[1.0; BLOCK_LANES]; BLOCKS],
            closed: [false; BLOCKS],
            open_in_row: [BLOCKS_IN_ROW; BLOCKS / BLOCKS_IN_ROW],
            open: BLOCKS,
        }
    }
}

impl BlendState {
    /// Clears the state for another tile.
    pub fn clear(&mut self) {
        self.color.iter_mut().for_each(|plane| plane.fill([0.0; BLOCK_LANES]));
        self.through.fill([1.0; BLOCK_LANES]);
        self.closed.fill(false);
        self.open_in_row.fill(BLOCKS_IN_ROW);
        self.open = BLOCKS;
    }

    /// Whether all blocks are opaque.
    pub fn is_full(&self) -> bool {
        self.open == 0
    }

    /// Whether a row of blocks is not yet opaque.
    #[inline(always)]
    pub(super) fn is_row_open(&self, row: usize) -> bool {
        self.open_in_row[row] > 0
    }

    /// Whether a block is not yet opaque.
    #[inline(always)]
    pub(super) fn is_open(&self, block: usize) -> bool {
        !self.closed[block]
    }

    /// Closes a block that was open, if no pixel of it lets through more than is seen. `most` has the largest transmittance.
    #[inline(always)]
    pub(super) fn close_if_opaque(&mut self, block: usize, most: Vec4) {
        if most.max_element() <= UNSEEN {
            self.closed[block] = true;
            self.open_in_row[block / BLOCKS_IN_ROW] -= 1;
            self.open -= 1;
        }
    }

    /// Copies the blocks into rows of pixels.
    pub fn write(&self, out: &mut HairPlanes) {
        let planes = out.color.iter_mut().zip(&self.color).chain([(&mut out.through, &self.through)]);
        for (plane, blocks) in planes {
            for (block, lanes) in blocks.iter().enumerate() {
                let (x, y) = pixel_of(block, 0);
                for (row, lanes) in lanes.as_chunks::<BLOCK_WIDTH>().0.iter().enumerate() {
                    let at = (y + row) * STRIDE + x;
                    plane[at..at + BLOCK_WIDTH].copy_from_slice(lanes);
                }
            }
        }
    }
}
