//! Shading of the visible body in a tile.

use lovelock_base::simd::Width;
use lovelock_motion::Body;

use super::PlacedSurface;
use super::raster::{Edges, NOTHING, SurfaceSamples};
use super::shading::{LANES, SurfaceBatch, shade_batch_simd};
use crate::cpu::tile::{HairPlanes, STRIDE, SurfacePlanes, TILE, UNSEEN};
use crate::cpu::view::View;

/// Two samples of a pixel whose depths differ by less than this fraction show the same surface.
const SAME_SURFACE: f32 = 0.004;

/// The positions of a tile that are collected for shading.
#[derive(Clone, Debug, Default)]
pub(crate) struct SurfaceLight {
    batch: SurfaceBatch,
    /// The last triangle, with its edges in this tile.
    last: Option<(u32, Edges)>,
}

/// The body: its placement in the picture, and its mesh.
type Surface<'a> = (&'a PlacedSurface, &'a Body);

impl SurfaceLight {
    /// Shades the visible body in a tile.
    pub fn shade_tile(
        &mut self,
        width: Width,
        view: &View,
        origin: [f32; 2],
        surface: Surface,
        (samples, hair): (&SurfaceSamples, &HairPlanes),
        out: &mut SurfacePlanes,
    ) {
        self.batch.count = 0;
        self.last = None;
        for y in 0..TILE {
            for x in 0..TILE {
                let at = y * STRIDE + x;
                if hair.through[at] <= UNSEEN {
                    continue;
                }
                let ids = samples.triangles(at);
                if ids[0] != NOTHING && ids == [ids[0]; 4] {
                    out.cover[at] = 1.0;
                    self.shade(width, view, surface, (ids[0], origin, x, y), 1.0, out);
                    continue;
                }
                let depths = samples.depths(at);
                let mut left = ids.map(|id| id != NOTHING);
                out.cover[at] = 0.25 * left.iter().filter(|left| **left).count() as f32;
                for s in 0..4 {
                    if !left[s] {
                        continue;
                    }
                    let mut weight = 0.0;
                    for other in s..4 {
                        let same = ids[other] == ids[s]
                            || (depths[other] - depths[s]).abs() <= SAME_SURFACE * depths[s];
                        if left[other] && same {
                            left[other] = false;
                            weight += 0.25;
                        }
                    }
                    self.shade(width, view, surface, (ids[s], origin, x, y), weight, out);
                }
            }
        }
        if self.batch.count > 0 {
            self.flush(width, view, out);
        }
    }

    /// Adds the position on a triangle at the centre of a pixel to the batch.
    fn shade(
        &mut self,
        width: Width,
        view: &View,
        surface: Surface,
        (triangle, origin, x, y): (u32, [f32; 2], usize, usize),
        weight: f32,
        out: &mut SurfacePlanes,
    ) {
        let edges = match self.last {
            Some((id, edges)) if id == triangle => edges,
            _ => {
                let (placed, body) = surface;
                let corners = body.mesh.triangles[triangle as usize].map(|i| placed.vertices[i as usize]);
                let Some(edges) = Edges::new(corners, origin) else { return };
                self.last = Some((triangle, edges));
                edges
            }
        };
        // The centre of a pixel may lie beside a triangle that covers some of its samples. Colours are not extrapolated there: across
        // a narrow triangle between two materials they change too fast.
        let shares = edges.shares(x as f32 + 0.5, y as f32 + 0.5).map(|share| share.max(0.0));
        let sum = shares[0] + shares[1] + shares[2];
        let shares = shares.map(|share| share / sum.max(1e-6));
        self.push(surface, triangle, shares, y * STRIDE + x, weight);
        if self.batch.count == LANES {
            self.flush(width, view, out);
        }
    }

    fn push(&mut self, surface: Surface, triangle: u32, shares: [f32; 3], pixel: usize, weight: f32) {
        let (placed, body) = surface;
        let batch = &mut self.batch;
        let lane = batch.count;
        let [a, b, c] = body.mesh.triangles[triangle as usize].map(|i| &placed.attributes[i as usize]);
        let mut mixed = [0.0; 16];
        for (i, mixed) in mixed.iter_mut().enumerate() {
            *mixed = a[i] * shares[0] + b[i] * shares[1] + c[i] * shares[2];
        }
        for axis in 0..3 {
            batch.position[axis][lane] = mixed[axis];
            batch.normal[axis][lane] = mixed[3 + axis];
            batch.albedo[axis][lane] = mixed[6 + axis];
        }
        batch.scalp[lane] = mixed[9];
        for (k, plane) in batch.hair.iter_mut().enumerate() {
            plane[lane] = mixed[10 + k];
        }
        (batch.pixel[lane], batch.weight[lane]) = (pixel, weight);
        batch.count += 1;
    }

    fn flush(&mut self, width: Width, view: &View, out: &mut SurfacePlanes) {
        shade_batch_simd(width, view, &mut self.batch);
        for lane in 0..self.batch.count {
            for (plane, color) in out.color.iter_mut().zip(&self.batch.color) {
                plane[self.batch.pixel[lane]] += self.batch.weight[lane] * color[lane];
            }
        }
        self.batch.count = 0;
    }
}
