//! Every fragment of a tile, pixel by pixel.
// Compiled within the versions of `dispatch`.
#![allow(clippy::inline_always)]

use super::segment::{LANES, Span, SpanSink, each_span};
use crate::cpu::math::three;
use crate::cpu::points::ShadedPoint;
use crate::cpu::surface::raster::SurfaceSamples;
use crate::cpu::tile::{STRIDE, TILE};

/// What one segment leaves in one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Fragment {
    /// Depth, 1 at the near plane.
    pub depth: f32,
    /// Opacity times coverage of the pixel, before the body hides it.
    pub alpha: f32,
    /// Light, linear.
    pub color: [f32; 3],
    /// One bit for each sample of the pixel in which it lies before the body.
    pub seen: u32,
}

impl Fragment {
    /// Opacity with what the body hides taken off.
    pub fn opacity(&self) -> f32 {
        self.alpha * 0.25 * self.seen.count_ones() as f32
    }
}

/// The fragments of a tile.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fragments {
    found: Vec<(u32, Fragment)>,
    starts: Vec<u32>,
    by_pixel: Vec<Fragment>,
}

/// What to list.
pub(crate) struct ListTile<'a> {
    /// Pixels of the tile's corner.
    pub origin: [f32; 2],
    pub points: &'a [ShadedPoint],
    /// First point of each segment.
    pub segments: &'a [u32],
    /// For each of the indices in `segments`, the segment's first point.
    pub first_points: &'a [u32],
    pub samples: &'a SurfaceSamples,
    /// Opacity of a strand where it covers a pixel wholly.
    pub opacity: f32,
}

/// Lists what segments leave in the pixels of a tile.
#[inline(always)]
pub(crate) fn list_segments(input: &ListTile, out: &mut Fragments) {
    out.found.clear();
    let mut sink = List { samples: input.samples, found: &mut out.found };
    for &segment in input.segments {
        let first = input.first_points[segment as usize] as usize;
        let (a, b) = (&input.points[first], &input.points[first + 1]);
        each_span(a, b, input.origin, input.opacity, &mut sink);
    }
}

struct List<'a> {
    samples: &'a SurfaceSamples,
    found: &'a mut Vec<(u32, Fragment)>,
}

impl SpanSink for List<'_> {
    #[inline(always)]
    fn is_open(&self, _at: usize) -> bool {
        true
    }

    #[inline(always)]
    fn take(&mut self, a: &ShadedPoint, b: &ShadedPoint, span: &Span) {
        for lane in 0..LANES.min(TILE - span.x) {
            let alpha = span.alpha[lane];
            if alpha <= 0.0 {
                continue;
            }
            let (at, depth) = (span.at + lane, span.depth[lane]);
            let mut seen = 0;
            for (sample, body) in self.samples.depths(at).into_iter().enumerate() {
                seen |= u32::from(depth >= body) << sample;
            }
            if seen != 0 {
                let (t, gain) = (span.along[lane], span.gain[lane]);
                let color = three(|c| (a.color[c] + (b.color[c] - a.color[c]) * t) * gain);
                self.found.push((at as u32, Fragment { depth, alpha, color, seen }));
            }
        }
    }
}

impl Fragments {
    /// Groups the fragments by pixel and calls `visit` for each pixel that has any, with its place in the
    /// planes and its fragments in the order of their segments.
    pub fn each_pixel(&mut self, mut visit: impl FnMut(usize, &mut [Fragment])) {
        const PLACES: usize = TILE * STRIDE;
        if self.found.is_empty() {
            return;
        }
        self.starts.clear();
        self.starts.resize(PLACES + 1, 0);
        for (at, _) in &self.found {
            self.starts[*at as usize + 1] += 1;
        }
        for at in 0..PLACES {
            self.starts[at + 1] += self.starts[at];
        }
        self.by_pixel.resize(self.found.len(), Fragment::default());
        // Each start moves to its pixel's end, which is where the next one began.
        for (at, fragment) in &self.found {
            let slot = &mut self.starts[*at as usize];
            self.by_pixel[*slot as usize] = *fragment;
            *slot += 1;
        }
        let mut start = 0;
        for at in 0..PLACES {
            let end = self.starts[at] as usize;
            if end > start {
                visit(at, &mut self.by_pixel[start..end]);
            }
            start = end;
        }
    }
}
