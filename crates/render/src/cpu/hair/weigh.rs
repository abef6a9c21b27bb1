//! Blends sorted segments before their light is known: first what each pixel takes of them, from near to far, and their light afterwards.
//!
//! Only segments of which a pixel takes something that can be seen are kept, so only the light of their points need be computed.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use std::hint::black_box;

use glam::Vec4;
use lovelock_base::memory::list_bytes;
use lovelock_base::simd_versions;

use super::blend::{BlendTile, FETCHED, ends_of, take_four};
use super::fragments::{Span, SpanSink, each_span};
use super::state::BlendState;
use crate::cpu::strand_points::ShadedPoint;
use crate::cpu::surface::raster::Occlusion;
use crate::cpu::tile::{BLOCK_LANES, UNSEEN};

/// Spans that are weighed before their light is added. So many that points whose light is missing fill their vectors, and so few that they
/// stay in the cache: 72 bytes each.
const ENOUGH: usize = 1024;

/// Light is added to pixels that let through more than this before: a sixteenth of what a closed block may let through, so that at most
/// 1/16,384 of the brightest light behind is left out. A block stays open
/// for its most transparent pixel, at the outline of hair to the end, while others of its pixels are as good as opaque.
const LEAST: f32 = UNSEEN / 16.0;

/// Segments of which pixels of a tile take something, and what they take.
#[derive(Clone, Debug, Default)]
pub(crate) struct Weighed {
    /// The first points of the segments, from near to far.
    pub segments: Vec<u32>,
    /// The light of both ends of each segment, which must be known before it is added.
    pub lights: Vec<[[f32; 3]; 2]>,
    spans: Vec<WeighedSpan>,
}

/// What the pixels of a block take of a segment.
#[derive(Clone, Copy, Debug)]
struct WeighedSpan {
    block: u32,
    /// Its place in the list of segments.
    segment: u32,
    /// Factor on its light.
    share: [f32; BLOCK_LANES],
    /// Position along the segment, 0 to 1.
    along: [f32; BLOCK_LANES],
}

impl Weighed {
    /// Its memory, bytes.
    pub fn bytes(&self) -> u64 {
        list_bytes(&self.segments) + list_bytes(&self.lights) + list_bytes(&self.spans)
    }

    /// Forgets all segments.
    pub fn clear(&mut self) {
        self.segments.clear();
        self.lights.clear();
        self.spans.clear();
    }

    /// Whether nothing is weighed.
    pub fn is_empty(&self) -> bool {
        self.spans.is_empty()
    }

    /// Whether the light of what is weighed should be added before more is.
    pub fn is_full(&self) -> bool {
        self.spans.len() >= ENOUGH
    }
}

simd_versions! {
    /// [`weigh_segments`] for the vectors of `width`.
    pub(crate) fn weigh_segments_simd(input: &BlendTile, out: &mut BlendState, weighed: &mut Weighed) -> usize {
        weigh_segments(input, out, weighed)
    }
}

/// Blends segments into a tile as [`blend_segments_simd`](super::blend::blend_segments_simd) does, except for their light. Returns how many
/// segments of the order are done: all, unless `weighed` is full.
#[inline(always)]
fn weigh_segments(input: &BlendTile, out: &mut BlendState, weighed: &mut Weighed) -> usize {
    let mut sink = Weigh { hidden: input.hidden, out, weighed, first: 0 };
    for (group, order) in input.order.chunks(FETCHED).enumerate() {
        // As there, these loads do not wait for each other.
        let fetched = order.iter().filter_map(|&entry| ends_of(input, entry));
        black_box(fetched.map(|[a, b]| a.x + b.hash).sum::<f32>());
        for (k, &entry) in order.iter().enumerate() {
            if sink.out.is_full() {
                return input.order.len();
            }
            if sink.weighed.is_full() {
                return group * FETCHED + k;
            }
            if let Some([a, b]) = ends_of(input, entry) {
                sink.first = entry as u32;
                each_span(a, b, input.origin, input.opacity, &mut sink);
            }
        }
    }
    input.order.len()
}

struct Weigh<'a> {
    hidden: &'a Occlusion,
    out: &'a mut BlendState,
    weighed: &'a mut Weighed,
    /// The first point of the segment.
    first: u32,
}

impl SpanSink for Weigh<'_> {
    #[inline(always)]
    fn is_row_open(&self, row: usize) -> bool {
        self.out.is_row_open(row)
    }

    #[inline(always)]
    fn is_open(&self, block: usize) -> bool {
        self.out.is_open(block)
    }

    #[inline(always)]
    fn take(&mut self, _: &ShadedPoint, _: &ShadedPoint, span: &Span) {
        let at = span.block;
        let (mut most, mut largest) = (Vec4::ZERO, Vec4::ZERO);
        let mut share = [0.0; BLOCK_LANES];
        for from in (0..BLOCK_LANES).step_by(4) {
            let [before, taken, left] = take_four(self.hidden, &mut self.out.through[at], span, from);
            most = most.max(left);
            largest = largest.max(Vec4::select(before.cmpgt(Vec4::splat(LEAST)), taken, Vec4::ZERO));
            (taken * Vec4::from_slice(&span.gain[from..from + 4])).write_to_slice(&mut share[from..from + 4]);
        }
        if largest.max_element() > 0.0 {
            let Weighed { segments, spans, .. } = &mut *self.weighed;
            if segments.last() != Some(&self.first) {
                segments.push(self.first);
            }
            let segment = segments.len() as u32 - 1;
            spans.push(WeighedSpan { block: at as u32, segment, share, along: span.along });
        }
        self.out.close_if_opaque(at, most);
    }
}

simd_versions! {
    /// [`add_light`] for the vectors of `width`.
    pub(crate) fn add_light_simd(weighed: &Weighed, out: &mut BlendState) -> () {
        add_light(weighed, out)
    }
}

/// Adds the light of what was weighed, in the same order.
#[inline(always)]
fn add_light(weighed: &Weighed, out: &mut BlendState) {
    for span in &weighed.spans {
        let [a, b] = &weighed.lights[span.segment as usize];
        for (c, plane) in out.color.iter_mut().enumerate() {
            let (first, second) = (Vec4::splat(a[c]), Vec4::splat(b[c]));
            let color = &mut plane[span.block as usize];
            for from in (0..BLOCK_LANES).step_by(4) {
                let four = |of: &[f32; BLOCK_LANES]| Vec4::from_slice(&of[from..from + 4]);
                let sum = four(color) + four(&span.share) * (first + (second - first) * four(&span.along));
                sum.write_to_slice(&mut color[from..from + 4]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use lovelock_base::simd::Width;

    use super::*;
    use crate::cpu::hair::blend::blend_segments_simd;

    /// Strands of two points across a tile, at seeded places and in depths that fall from the first to the last.
    fn strands(count: u32) -> Vec<ShadedPoint> {
        let noise = |i: u32, salt: u32| {
            let bits =
                (i.wrapping_mul(0x9e37_79b9) ^ salt.wrapping_mul(0x85eb_ca6b)).wrapping_mul(0xc2b2_ae35);
            (bits >> 8) as f32 / (1 << 24) as f32
        };
        let point = |i: u32| {
            let strand = i / 2;
            ShadedPoint {
                x: 36.0 * noise(i, 1) - 2.0,
                y: 36.0 * (i % 2) as f32 - 2.0,
                depth: 0.9 - 0.8 * strand as f32 / count as f32,
                half_width: 0.1 + 1.5 * noise(strand, 2),
                run_x: 0.0,
                run_y: 1.0,
                color: [noise(i, 3), noise(i, 4), noise(i, 5)],
                hash: noise(strand, 6),
            }
        };
        (0..2 * count).map(point).collect()
    }

    #[test]
    fn light_that_is_added_later_is_that_of_segments_blended_at_once_and_what_is_hidden_needs_none() {
        let points = strands(2000);
        let order: Vec<u64> = (0..2000).map(|strand| 2 * strand).collect();
        // A wall behind the first half of the strands in some blocks, and behind half of the samples of others.
        let mut hidden = Occlusion::default();
        for block in 20..40 {
            hidden.near[block].fill(0.5);
            hidden.far[block].fill(if block < 30 { 0.5 } else { 0.0 });
            hidden.share[block].fill(0.5);
        }
        let tile =
            |order| BlendTile { origin: [0.0, 0.0], points: &points, order, hidden: &hidden, opacity: 0.4 };
        for &width in Width::ALL.iter().filter(|width| width.is_available()) {
            let width = width.for_eight();
            let (mut at_once, mut later) = (BlendState::default(), BlendState::default());
            blend_segments_simd(width, &tile(&order), &mut at_once);
            let (mut weighed, mut seen, mut parts) = (Weighed::default(), 0, 0);
            let mut rest = &order[..];
            while !rest.is_empty() {
                let done = weigh_segments_simd(width, &tile(rest), &mut later, &mut weighed);
                rest = &rest[done..];
                let ends = weighed
                    .segments
                    .iter()
                    .map(|&first| [points[first as usize].color, points[first as usize + 1].color]);
                weighed.lights = ends.collect();
                add_light_simd(width, &weighed, &mut later);
                (seen, parts) = (seen + weighed.segments.len(), parts + 1);
                weighed.clear();
            }
            assert!(at_once.through == later.through, "{width:?}");
            let lights = at_once.color.as_flattened().iter().zip(later.color.as_flattened());
            for (at_once, later) in lights.flat_map(|(a, b)| a.iter().zip(b)) {
                // What is left out is at most this, of light up to 1.
                assert!((at_once - later).abs() <= LEAST + 1e-6, "{width:?}: {at_once} {later}");
            }
            assert!(at_once.color[0].iter().flatten().any(|&light| light > 0.1), "control: there is light");
            assert!(parts > 1 && seen > 20 && seen < 1500, "{seen} segments of 2000, in {parts} parts");
        }
    }
}
