//! The pixels of a tile that a triangle covers.

use super::sink::Sink;
use crate::cpu::math::{max, min};
use crate::cpu::surface::raster::{SAMPLES, SurfaceSamples};
use crate::cpu::tile::{STRIDE, TILE};

/// Calls `visit` for each pixel of the tile of which a triangle covers samples that the body does not hide, and that is still open:
/// with the barycentric coordinates of its middle, those samples, and its index in the tile.
#[inline]
pub(super) fn each_pixel<S: Sink>(
    [a, b, c]: [[f32; 3]; 3],
    surface: &SurfaceSamples,
    sink: &mut S,
    mut visit: impl FnMut([f32; 3], u32, usize, &mut S),
) {
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
    for y in top as usize..=bottom as usize {
        let (mut from, mut to) = (left, right);
        for edge in &edges {
            edge.narrow(y as f32, &mut from, &mut to);
        }
        // Empty for NaN.
        let columns = if from <= to { from as usize..to as usize + 1 } else { 0..0 };
        for x in columns {
            let at = y * STRIDE + x;
            if !sink.is_open(at) {
                continue;
            }
            let weights = edges.map(|edge| edge.at(x as f32, y as f32));
            let mut covered = 0;
            for (s, [sx, sy]) in SAMPLES.into_iter().enumerate() {
                let inside = |k: usize| weights[k] + edges[k].x * sx + edges[k].y * sy >= 0.0;
                covered |= u32::from(inside(0) & inside(1) & inside(2)) << s;
            }
            if covered == 0 {
                continue;
            }
            let middle = [0, 1, 2].map(|k| max(weights[k] + 0.5 * (edges[k].x + edges[k].y), 0.0));
            let inverse = 1.0 / (middle[0] + middle[1] + middle[2]);
            let middle = middle.map(|w| w * inverse);
            let depth = middle[0] * a[2] + middle[1] * b[2] + middle[2] * c[2];
            for (s, body) in surface.depths(at).into_iter().enumerate() {
                covered &= !(u32::from(depth < body) << s);
            }
            if covered != 0 {
                visit(middle, covered, at, sink);
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
    fn new(p: [f32; 3], q: [f32; 3], area: f32) -> Self {
        let (x, y) = ((p[1] - q[1]) / area, (q[0] - p[0]) / area);
        Self { x, y, c: -(x * p[0] + y * p[1]) }
    }

    fn at(&self, x: f32, y: f32) -> f32 {
        self.x * x + self.y * y + self.c
    }

    /// Narrows the columns of row `y` to those of which the edge leaves a part inside.
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
