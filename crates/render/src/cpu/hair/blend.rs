//! Blends sorted segments from near to far: `Transparency::Sorted`.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use std::hint::black_box;

use glam::Vec4;
use lovelock_base::simd_versions;

use super::fragments::{Span, SpanSink, each_span};
use super::state::BlendState;
use crate::cpu::strand_points::ShadedPoint;
use crate::cpu::surface::raster::Occlusion;
use crate::cpu::tile::BLOCK_LANES;

/// The input of a tile.
pub(crate) struct BlendTile<'a> {
    /// The corner of the tile, pixels.
    pub origin: [f32; 2],
    pub points: &'a [ShadedPoint],
    /// The first point of each segment, from near to far, in the low 32 bits.
    pub order: &'a [u64],
    pub hidden: &'a Occlusion,
    /// Opacity of a strand where it covers a pixel completely.
    pub opacity: f32,
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
    for order in input.order.chunks(FETCHED) {
        // Points lie in the order of strands. These loads do not wait for each other, as those below would.
        let fetched = order.iter().filter_map(|&entry| ends_of(input, entry));
        black_box(fetched.map(|[a, b]| a.x + b.hash).sum::<f32>());
        for &entry in order {
            if sink.out.is_full() {
                return;
            }
            if let Some([a, b]) = ends_of(input, entry) {
                each_span(a, b, input.origin, input.opacity, &mut sink);
            }
        }
    }
}

/// Segments whose points are fetched together.
pub(super) const FETCHED: usize = 16;

/// The ends of a segment of the order.
#[inline(always)]
pub(super) fn ends_of<'a>(input: &BlendTile<'a>, entry: u64) -> Option<&'a [ShadedPoint; 2]> {
    input.points.get(entry as u32 as usize..).and_then(|points| points.first_chunk())
}

/// What the pixels of a block let through before a span, what they take of it, and what they let through afterwards, which is written to
/// `through`: four lanes from `from` on.
#[inline(always)]
pub(super) fn take_four(
    hidden: &Occlusion,
    through: &mut [f32; BLOCK_LANES],
    span: &Span,
    from: usize,
) -> [Vec4; 3] {
    let at = span.block;
    let Occlusion { near, far, share: hidden } = hidden;
    let four = |of: &[f32; BLOCK_LANES]| Vec4::from_slice(&of[from..from + 4]);
    let z = four(&span.depth);
    let seen = Vec4::select(z.cmpge(four(&near[at])), Vec4::ONE, Vec4::ONE - four(&hidden[at]));
    let alpha = Vec4::select(z.cmpge(four(&far[at])), four(&span.alpha) * seen, Vec4::ZERO);
    let before = four(through);
    let taken = alpha * before;
    let left = before - taken;
    left.write_to_slice(&mut through[from..from + 4]);
    [before, taken, left]
}

struct Blend<'a> {
    hidden: &'a Occlusion,
    out: &'a mut BlendState,
}

impl SpanSink for Blend<'_> {
    #[inline(always)]
    fn is_row_open(&self, row: usize) -> bool {
        self.out.is_row_open(row)
    }

    #[inline(always)]
    fn is_open(&self, block: usize) -> bool {
        self.out.is_open(block)
    }

    #[inline(always)]
    fn take(&mut self, a: &ShadedPoint, b: &ShadedPoint, span: &Span) {
        // In fours, because the compiler does not turn this into vectors by itself.
        let at = span.block;
        let mut most = Vec4::ZERO;
        for from in (0..BLOCK_LANES).step_by(4) {
            let four = |of: &[f32; BLOCK_LANES]| Vec4::from_slice(&of[from..from + 4]);
            let [_, taken, left] = take_four(self.hidden, &mut self.out.through[at], span, from);
            let share = taken * four(&span.gain);
            most = most.max(left);
            let along = four(&span.along);
            for (c, plane) in self.out.color.iter_mut().enumerate() {
                let (first, second) = (Vec4::splat(a.color[c]), Vec4::splat(b.color[c]));
                let color = &mut plane[at];
                let sum = four(color) + share * (first + (second - first) * along);
                sum.write_to_slice(&mut color[from..from + 4]);
            }
        }
        self.out.close_if_opaque(at, most);
    }
}
