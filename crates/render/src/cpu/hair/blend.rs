//! Blends sorted segments from near to far: `Transparency::Sorted`.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use lovelock_base::simd_versions;

use super::fragments::{Span, SpanSink, each_span};
use crate::cpu::math::max;
use crate::cpu::strand_points::ShadedPoint;
use crate::cpu::surface::raster::Occlusion;
use crate::cpu::tile::{
    BLOCK_LANES, BLOCK_WIDTH, BLOCKS, BLOCKS_IN_ROW, HairPlanes, STRIDE, UNSEEN, pixel_of,
};

/// The input of a tile.
pub(crate) struct BlendTile<'a> {
    /// The corner of the tile, pixels.
    pub origin: [f32; 2],
    /// Both ends of each segment, from near to far. Gathered, because the order in memory differs from the order of depth.
    pub segments: &'a [[ShadedPoint; 2]],
    pub hidden: &'a Occlusion,
    /// Opacity of a strand where it covers a pixel completely.
    pub opacity: f32,
}

/// The state of a tile during blending, in blocks.
#[derive(Clone, Debug)]
pub(crate) struct BlendState {
    color: [[[f32; BLOCK_LANES]; BLOCKS]; 3],
    through: [[f32; BLOCK_LANES]; BLOCKS],
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

simd_versions! {
    /// [`blend_segments`] for the vectors of `width`.
    pub(crate) fn blend_segments_simd(input: &BlendTile, out: &mut BlendState) -> () {
        blend_segments(input, out)
    }
}

/// Blends segments into a tile.
#[inline(always)]
fn blend_segments(input: &BlendTile, out: &mut BlendState) {
    let mut sink = Blend { hidden: input.hidden, out };
    for [a, b] in input.segments {
        if sink.out.is_full() {
            break;
        }
        each_span(a, b, input.origin, input.opacity, &mut sink);
    }
}

struct Blend<'a> {
    hidden: &'a Occlusion,
    out: &'a mut BlendState,
}

impl SpanSink for Blend<'_> {
    #[inline(always)]
    fn is_row_open(&self, row: usize) -> bool {
        self.out.open_in_row[row] > 0
    }

    #[inline(always)]
    fn is_open(&self, block: usize) -> bool {
        !self.out.closed[block]
    }

    #[inline(always)]
    fn take(&mut self, a: &ShadedPoint, b: &ShadedPoint, span: &Span) {
        // Blocks are copied, modified and written back: the compiler cannot prove that planes do not overlap.
        let at = span.block;
        let Occlusion { near, far, share: hidden } = self.hidden;
        let (near, far, hidden) = (near[at], far[at], hidden[at]);
        let mut through = self.out.through[at];
        let mut share = [0.0; BLOCK_LANES];
        for lane in 0..BLOCK_LANES {
            let z = span.depth[lane];
            let seen = if z >= near[lane] { 1.0 } else { 1.0 - hidden[lane] };
            let alpha = if z >= far[lane] { span.alpha[lane] * seen } else { 0.0 };
            share[lane] = alpha * through[lane] * span.gain[lane];
            through[lane] -= alpha * through[lane];
        }
        self.out.through[at] = through;
        for (c, plane) in self.out.color.iter_mut().enumerate() {
            let mut color = plane[at];
            let (from, to) = (a.color[c], b.color[c]);
            for lane in 0..BLOCK_LANES {
                color[lane] += share[lane] * (from + (to - from) * span.along[lane]);
            }
            plane[at] = color;
        }
        let mut most = 0.0;
        for lane in 0..BLOCK_LANES {
            most = max(through[lane], most);
        }
        if most <= UNSEEN {
            self.out.closed[at] = true;
            self.out.open_in_row[at / BLOCKS_IN_ROW] -= 1;
            self.out.open -= 1;
        }
    }
}
