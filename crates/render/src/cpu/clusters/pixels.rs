//! The pixels of a tile that a layer covers.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use lovelock_base::simd_versions;

use super::sink::Sink;
use crate::cpu::math::{max, min, saturate, three};
use crate::cpu::surface::raster::{SAMPLES, SurfaceSamples};
use crate::cpu::tile::{STRIDE, TILE};

/// Pixels of a row that are tested together, and of a layer that are shaded together. Not more than rows have unused items.
pub(super) const LANES: usize = 8;
/// A pixel may be in both triangles of a layer. The last lanes may be unused.
const MAX: usize = 2 * TILE * TILE + LANES;

/// The pixels of a layer in a tile.
pub(super) struct Covered {
    pub len: usize,
    /// Indices in the tile.
    pub at: Vec<u32>,
    /// One bit per sample that the layer covers and the body does not hide.
    pub samples: Vec<u32>,
    /// The place in the layer between its ribs and between its sections, 0 to 1.
    pub u: Vec<f32>,
    pub t: Vec<f32>,
    pub depth: Vec<f32>,
}

impl Default for Covered {
    fn default() -> Self {
        let (words, numbers) = (|| vec![0; MAX], || vec![0.0; MAX]);
        Self { len: 0, at: words(), samples: words(), u: numbers(), t: numbers(), depth: numbers() }
    }
}

/// A triangle of a layer.
pub(super) struct Triangle {
    /// Pixels from the corner of the tile, and depths.
    pub corners: [[f32; 3]; 3],
    /// Where the corners lie between ribs and between sections.
    pub places: [[f32; 2]; 3],
}

simd_versions! {
    /// [`cover`] for the vectors of `width`.
    pub(super) fn cover_simd<S: Sink>(
        triangle: &Triangle, surface: &SurfaceSamples, sink: &S, out: &mut Covered
    ) -> () {
        cover(triangle, surface, sink, out)
    }
}

/// Adds the pixels of the tile of which a triangle covers samples that the body does not hide, and that are still open. Values are
/// those in the middle of a pixel.
#[inline(always)]
fn cover<S: Sink>(triangle: &Triangle, surface: &SurfaceSamples, sink: &S, out: &mut Covered) {
    let [a, b, c] = triangle.corners;
    let area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1]);
    if area == 0.0 || !area.is_finite() {
        return;
    }
    let tile = TILE as f32;
    // Whole pixels: the last one of a tile begins at `tile - 1`.
    let low = |k: usize| max(min(min(a[k], b[k]), c[k]), 0.0).floor();
    let high = |k: usize| min(max(max(a[k], b[k]), c[k]), tile - 1.0);
    let (left, top, right, bottom) = (low(0), low(1), high(0), high(1));
    if !(left <= right && top <= bottom) {
        return;
    }
    if !sink.is_open_in([left as usize, right as usize], [top as usize, bottom as usize]) {
        return;
    }
    let edges = [Edge::new(b, c, area), Edge::new(c, a, area), Edge::new(a, b, area)];
    let steps = three(|k| 0.5 * (edges[k].x + edges[k].y));
    let [pa, pb, pc] = triangle.places;
    for y in top as usize..=bottom as usize {
        let (mut from, mut to) = (left, right);
        for edge in &edges {
            edge.narrow(y as f32, &mut from, &mut to);
        }
        // Empty for NaN.
        let columns = if from <= to { from as usize..to as usize + 1 } else { 0..0 };
        for x in columns.clone().step_by(LANES) {
            let first = y * STRIDE + x;
            let used = LANES.min(columns.end - x);
            if !(first..first + used).any(|at| sink.is_open(at)) {
                continue;
            }
            let Some(bodies) = surface.depth[first * SAMPLES.len()..].first_chunk::<{ 4 * LANES }>() else {
                continue;
            };
            let mut samples = [0; LANES];
            let [mut u, mut t, mut depth] = [[0.0; LANES]; 3];
            let mut weights = [[0.0; LANES]; 3];
            let mut body = [[0.0; LANES]; SAMPLES.len()];
            for lane in 0..LANES {
                for s in 0..SAMPLES.len() {
                    body[s][lane] = bodies[lane * SAMPLES.len() + s];
                }
            }
            for lane in 0..LANES {
                let at = three(|k| edges[k].at((x + lane) as f32, y as f32));
                let middle = three(|k| max(at[k] + steps[k], 0.0));
                let inverse = 1.0 / (middle[0] + middle[1] + middle[2]);
                let middle = three(|k| middle[k] * inverse);
                depth[lane] = middle[0] * a[2] + middle[1] * b[2] + middle[2] * c[2];
                u[lane] = saturate(middle[0] * pa[0] + middle[1] * pb[0] + middle[2] * pc[0]);
                t[lane] = saturate(middle[0] * pa[1] + middle[1] * pb[1] + middle[2] * pc[1]);
                (weights[0][lane], weights[1][lane], weights[2][lane]) = (at[0], at[1], at[2]);
            }
            for s in 0..SAMPLES.len() {
                let [sx, sy] = SAMPLES[s];
                let step = three(|k| edges[k].x * sx + edges[k].y * sy);
                for lane in 0..LANES {
                    let inside = three(|k| weights[k][lane] + step[k]);
                    let nearest = min(min(inside[0], inside[1]), inside[2]);
                    let is_seen = (nearest >= 0.0) & (depth[lane] >= body[s][lane]);
                    samples[lane] |= u32::from(is_seen) << s;
                }
            }
            for lane in 0..used {
                let n = out.len;
                if samples[lane] != 0 && sink.is_open(first + lane) && n < MAX {
                    out.at[n] = (first + lane) as u32;
                    out.samples[n] = samples[lane];
                    (out.u[n], out.t[n], out.depth[n]) = (u[lane], t[lane], depth[lane]);
                    out.len = n + 1;
                }
            }
        }
    }
}

/// An edge of a triangle: the barycentric coordinate of the corner beside it is `x * px + y * py + c`.
#[derive(Clone, Copy)]
struct Edge {
    x: f32,
    y: f32,
    c: f32,
}

impl Edge {
    #[inline(always)]
    fn new(p: [f32; 3], q: [f32; 3], area: f32) -> Self {
        let (x, y) = ((p[1] - q[1]) / area, (q[0] - p[0]) / area);
        Self { x, y, c: -(x * p[0] + y * p[1]) }
    }

    #[inline(always)]
    fn at(&self, x: f32, y: f32) -> f32 {
        self.x * x + self.y * y + self.c
    }

    /// Narrows the columns of row `y` to those of which the edge leaves a part inside.
    #[inline(always)]
    fn narrow(&self, y: f32, from: &mut f32, to: &mut f32) {
        let inside = max(self.at(0.0, y), self.at(0.0, y + 1.0));
        if self.x > 0.0 {
            *from = max(*from, -inside / self.x - 1.0);
        } else if self.x < 0.0 {
            *to = min(*to, -inside / self.x);
        } else if inside < 0.0 {
            *to = -1.0;
        }
    }
}
