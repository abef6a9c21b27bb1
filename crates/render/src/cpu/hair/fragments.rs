//! One segment as a ribbon over the pixels of a tile: the twin of `eye/fragments.wgsl`.
//!
//! Widths below a pixel become coverage: a strand of 0.2 pixels is drawn one pixel wide with a fifth of its opacity, so that it
//! neither breaks up nor becomes heavier with distance.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use crate::cpu::math::{max, min, saturate, sin, smoothstep};
use crate::cpu::strand_points::ShadedPoint;
use crate::cpu::tile::{BLOCK_HEIGHT, BLOCK_LANES, BLOCK_WIDTH, BLOCKS_IN_ROW, TILE};

type Lane = [f32; BLOCK_LANES];

/// A block of pixels that a segment may cover.
pub(crate) struct Span {
    /// Index of the block in the tile, row after row.
    pub block: usize,
    /// Opacity times coverage; 0 beside the segment. Lanes run along the rows of the block.
    pub alpha: Lane,
    /// Depth, 1 at the near plane.
    pub depth: Lane,
    /// Position along the segment, 0 to 1.
    pub along: Lane,
    /// Factor on the colour.
    pub gain: Lane,
}

/// Whether a segment is drawn at all.
#[inline(always)]
pub(crate) fn is_drawn(a: &ShadedPoint, b: &ShadedPoint) -> bool {
    a.half_width >= 0.0 && b.half_width >= 0.0
}

/// The largest distance from the middle line that a segment is drawn at, pixels.
#[inline(always)]
fn reach(a: &ShadedPoint, b: &ShadedPoint) -> f32 {
    max(max(a.half_width, b.half_width), 0.5) + 0.5
}

/// Left, top, right and bottom of the ribbon, pixels: its corners lie across the strand from its ends.
#[inline(always)]
pub(crate) fn bounds(a: &ShadedPoint, b: &ShadedPoint) -> [f32; 4] {
    let reach = reach(a, b);
    let (ax, ay) = (a.run_y.abs() * reach, a.run_x.abs() * reach);
    let (bx, by) = (b.run_y.abs() * reach, b.run_x.abs() * reach);
    [min(a.x - ax, b.x - bx), min(a.y - ay, b.y - by), max(a.x + ax, b.x + bx), max(a.y + ay, b.y + by)]
}

/// Receives the blocks of a segment. A trait, because closures are not always inlined.
pub(crate) trait SpanSink {
    /// Whether a block in a row of blocks may receive something.
    #[inline(always)]
    fn is_row_open(&self, _row: usize) -> bool {
        true
    }
    /// Whether a block may receive something.
    #[inline(always)]
    fn is_open(&self, _block: usize) -> bool {
        true
    }
    /// Receives a block of the segment from `a` to `b`.
    fn take(&mut self, a: &ShadedPoint, b: &ShadedPoint, span: &Span);
}

/// Passes each block of a tile that the segment from `a` to `b` may cover to `sink`.
///
/// A pixel belongs to the segment between the lines across the strand through its two ends. Neighbouring
/// segments share those lines, so that no pixel is drawn twice or left out.
#[inline(always)]
pub(crate) fn each_span(
    a: &ShadedPoint,
    b: &ShadedPoint,
    origin: [f32; 2],
    opacity: f32,
    sink: &mut impl SpanSink,
) {
    let (ax, ay) = (a.x - origin[0], a.y - origin[1]);
    let (bx, by) = (b.x - origin[0], b.y - origin[1]);
    let (dx, dy) = (bx - ax, by - ay);
    let length = (dx * dx + dy * dy).sqrt();
    if length < 1e-4 {
        return;
    }
    let inverse = 1.0 / length;
    let (nx, ny) = (-dy * inverse, dx * inverse);
    let reach = reach(a, b);
    let [left, top, right, bottom] = bounds(a, b);
    let (left, right) = (left - origin[0], right - origin[0]);
    // Rows whose centres may lie inside.
    let (top, bottom) = (max(top - origin[1] - 0.5, 0.0), min(bottom - origin[1] + 0.5, TILE as f32 - 0.5));
    if top > bottom || left >= TILE as f32 || right < 0.0 {
        return;
    }
    let (half_a, half_b) = (max(a.half_width, 0.5), max(b.half_width, 0.5));
    let (opacity_a, opacity_b) =
        (opacity * min(a.half_width * 2.0, 1.0), opacity * min(b.half_width * 2.0, 1.0));
    let streaked = max(half_a, half_b) > 0.8;
    // The intersection of a row with the ribbon: a middle that moves from row to row, and half a width.
    let steep = nx.abs() > 0.05;
    let (slope, half_run) = if steep { (ny / nx, reach / nx.abs()) } else { (0.0, f32::INFINITY) };
    let wander = slope.abs() * (0.5 * (BLOCK_HEIGHT - 1) as f32);
    for row in top as usize / BLOCK_HEIGHT..=bottom as usize / BLOCK_HEIGHT {
        if !sink.is_row_open(row) {
            continue;
        }
        let y = row * BLOCK_HEIGHT;
        let middle = ax - slope * (y as f32 + 0.5 * BLOCK_HEIGHT as f32 - ay);
        let (from, to) = (max(left, middle - wander - half_run), min(right, middle + wander + half_run));
        let (from, to) = (max(from - 0.5, 0.0), min(to + 0.5, TILE as f32 - 0.5));
        if from > to {
            continue;
        }
        for column in from as usize / BLOCK_WIDTH..=to as usize / BLOCK_WIDTH {
            let block = row * BLOCKS_IN_ROW + column;
            if !sink.is_open(block) {
                continue;
            }
            let (x, y) = ((column * BLOCK_WIDTH) as f32, y as f32);
            let mut span = Span {
                block,
                alpha: [0.0; BLOCK_LANES],
                depth: [0.0; BLOCK_LANES],
                along: [0.0; BLOCK_LANES],
                gain: [1.0; BLOCK_LANES],
            };
            for lane in 0..BLOCK_LANES {
                let (cx, cy) = (x + CENTRES[0][lane], y + CENTRES[1][lane]);
                let (px, py) = (cx - ax, cy - ay);
                let after_a = px * a.run_x + py * a.run_y;
                let after_b = (cx - bx) * b.run_x + (cy - by) * b.run_y;
                let inside = (after_a >= 0.0) & (after_b < 0.0);
                let along = saturate(after_a / max(after_a - after_b, 1e-6));
                let offset = px * nx + py * ny;
                let half = half_a + (half_b - half_a) * along;
                let coverage = saturate(half + 0.5 - offset.abs());
                let opacity = opacity_a + (opacity_b - opacity_a) * along;
                span.alpha[lane] = if inside { opacity * coverage } else { 0.0 };
                span.depth[lane] = a.depth + (b.depth - a.depth) * along;
                span.along[lane] = along;
            }
            if streaked {
                // A strand represents many hairs: where it is wide enough to show them, it is streaked.
                for lane in 0..BLOCK_LANES {
                    let (px, py) = (x + CENTRES[0][lane] - ax, y + CENTRES[1][lane] - ay);
                    let half = half_a + (half_b - half_a) * span.along[lane];
                    let across = (px * nx + py * ny) / half;
                    let wide = smoothstep(0.8, 2.0, half);
                    let wave = wide
                        * (sin(across * 5.0 + a.hash * 41.0) * 0.6
                            + sin(across * 11.0 - a.hash * 73.0) * 0.4);
                    span.alpha[lane] = saturate(span.alpha[lane] * (1.0 + 0.22 * wave));
                    span.gain[lane] = 1.0 + 0.18 * wave;
                }
            }
            sink.take(a, b, &span);
        }
    }
}

/// Centres of the pixels of a block, relative to its corner.
const CENTRES: [Lane; 2] = {
    let mut centres = [[0.0; BLOCK_LANES]; 2];
    let mut lane = 0;
    while lane < BLOCK_LANES {
        centres[0][lane] = (lane % BLOCK_WIDTH) as f32 + 0.5;
        centres[1][lane] = (lane / BLOCK_WIDTH) as f32 + 0.5;
        lane += 1;
    }
    centres
};
