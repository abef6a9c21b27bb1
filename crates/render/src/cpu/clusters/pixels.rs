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
    let low = |k: usize| max(min(min(a[k], b[k]), c[k]), 0.0);
    let high = |k: usize| min(max(max(a[k], b[k]), c[k]), tile - 1.0);
    let (left, top, right, bottom) = (low(0), low(1), high(0), high(1));
    if !(left <= right && top <= bottom) {
        return;
    }
    // Edges in one direction, so that the neighbour on the other side of an edge finds the opposite sign.
    let edge = |p: [f32; 3], q: [f32; 3]| {
        let (dx, dy) = ((q[0] - p[0]) / area, (q[1] - p[1]) / area);
        move |x: f32, y: f32| dx * (y - p[1]) - dy * (x - p[0])
    };
    let edges = (edge(b, c), edge(c, a), edge(a, b));
    for y in top as usize..=bottom as usize {
        for x in left as usize..=right as usize {
            let weights = |x: f32, y: f32| [edges.0(x, y), edges.1(x, y), edges.2(x, y)];
            let at = y * STRIDE + x;
            if !sink.is_open(at) {
                continue;
            }
            let mut covered = 0;
            for (s, [sx, sy]) in SAMPLES.into_iter().enumerate() {
                let inside = weights(x as f32 + sx, y as f32 + sy).iter().all(|&w| w >= 0.0);
                covered |= u32::from(inside) << s;
            }
            if covered == 0 {
                continue;
            }
            let middle = weights(x as f32 + 0.5, y as f32 + 0.5).map(|w| max(w, 0.0));
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
