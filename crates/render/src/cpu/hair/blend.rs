//! Segments put together from near to far as they come: `Transparency::Sorted`.
// Compiled within the versions of `dispatch`.
#![allow(clippy::inline_always)]

use super::segment::{LANES, Span, SpanSink, each_span};
use crate::cpu::math::max;
use crate::cpu::points::ShadedPoint;
use crate::cpu::surface::raster::Occlusion;
use crate::cpu::tile::{HairPlanes, Plane, STRIDE, TILE, UNSEEN};

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

/// Draws segments into a tile.
#[inline(always)]
pub(crate) fn blend_segments(input: &BlendTile, out: &mut HairPlanes) {
    let mut sink = Blend { hidden: input.hidden, out, closed: [false; RUNS], open: TILE * TILE / LANES };
    for [a, b] in input.segments {
        if sink.open == 0 {
            break;
        }
        each_span(a, b, input.origin, input.opacity, &mut sink);
    }
}

struct Blend<'a> {
    hidden: &'a Occlusion,
    out: &'a mut HairPlanes,
    /// Runs of pixels behind which nothing can be seen any more, and how many others the tile has.
    closed: [bool; RUNS],
    open: usize,
}

const RUNS: usize = TILE * STRIDE / LANES;

impl SpanSink for Blend<'_> {
    #[inline(always)]
    fn is_open(&self, at: usize) -> bool {
        !self.closed[at / LANES]
    }

    #[inline(always)]
    fn take(&mut self, a: &ShadedPoint, b: &ShadedPoint, span: &Span) {
        // Runs are copied, worked on and put back whole: the compiler cannot know that planes do not overlap.
        let at = span.at;
        let Occlusion { near, far, share: hidden } = self.hidden;
        let (near, far, hidden) = (run_of(near, at), run_of(far, at), run_of(hidden, at));
        let mut through = run_of(&self.out.through, at);
        let mut share = [0.0; LANES];
        for lane in 0..LANES {
            let z = span.depth[lane];
            let seen = if z >= near[lane] { 1.0 } else { 1.0 - hidden[lane] };
            let alpha = if z >= far[lane] { span.alpha[lane] * seen } else { 0.0 };
            share[lane] = alpha * through[lane] * span.gain[lane];
            through[lane] -= alpha * through[lane];
        }
        self.out.through[at..at + LANES].copy_from_slice(&through);
        for (c, plane) in self.out.color.iter_mut().enumerate() {
            let mut color = run_of(plane, at);
            let (from, to) = (a.color[c], b.color[c]);
            for lane in 0..LANES {
                color[lane] += share[lane] * (from + (to - from) * span.along[lane]);
            }
            plane[at..at + LANES].copy_from_slice(&color);
        }
        let mut most = 0.0;
        for lane in 0..LANES {
            most = max(through[lane], most);
        }
        if most <= UNSEEN {
            self.closed[at / LANES] = true;
            self.open -= 1;
        }
    }
}

#[inline(always)]
fn run_of(plane: &Plane, at: usize) -> [f32; LANES] {
    let mut run = [0.0; LANES];
    run.copy_from_slice(&plane[at..at + LANES]);
    run
}
