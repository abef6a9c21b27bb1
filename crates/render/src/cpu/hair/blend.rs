//! Segments put together from near to far as they come: `Transparency::Sorted`.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use lovelock_groom::simd_versions;

use super::segment::{Span, SpanSink, each_span};
use crate::cpu::math::max;
use crate::cpu::points::ShadedPoint;
use crate::cpu::surface::raster::Occlusion;
use crate::cpu::tile::{
    BLOCK_LANES, BLOCK_WIDTH, BLOCKS, BLOCKS_IN_ROW, HairPlanes, STRIDE, UNSEEN, pixel_of,
};

/// What to draw into a tile.
pub(crate) struct BlendTile<'a> {
    /// Pixels of the tile's corner.
    pub origin: [f32; 2],
    /// Both ends of each segment, from near to far. Gathered, since its place in memory has nothing to do with
    /// its place in the order.
    pub segments: &'a [[ShadedPoint; 2]],
    pub hidden: &'a Occlusion,
    /// Opacity of a strand where it covers a pixel wholly.
    pub opacity: f32,
}

/// A tile on its way: by blocks, and how full it is.
#[derive(Clone, Debug)]
pub(crate) struct BlendState {
    color: [[[f32; BLOCK_LANES]; BLOCKS]; 3],
    through: [[f32; BLOCK_LANES]; BLOCKS],
    /// Blocks behind which nothing can be seen any more.
    closed: [bool; BLOCKS],
    /// How many others each row of blocks has, and the whole tile.
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
    /// Begins another tile.
    pub fn clear(&mut self) {
        self.color.iter_mut().for_each(|plane| plane.fill([0.0; BLOCK_LANES]));
        self.through.fill([1.0; BLOCK_LANES]);
        self.closed.fill(false);
        self.open_in_row.fill(BLOCKS_IN_ROW);
        self.open = BLOCKS;
    }

    /// Whether nothing more can be seen.
    pub fn is_full(&self) -> bool {
        self.open == 0
    }

    /// Lays the blocks out in rows of pixels.
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

/// Draws segments into a tile.
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
        // Blocks are copied, worked on and put back whole: the compiler cannot know that planes do not overlap.
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
