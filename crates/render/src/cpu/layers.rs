//! The layers of a picture on the CPU: the twin of `layers.wgsl`, `value_points.wgsl` and `eye/near/`.
//!
//! The hair is drawn a second time with transmittance in place of colour, so that every transparency mode weights it like light; and
//! a third time for the nearest depth.

use lovelock_base::memory::list_bytes;
use rayon::prelude::*;

use super::finish::{PixelsIn, compose_row, noise_at, show_over};
use super::hair::fragments::{Span, SpanSink, each_span};
use super::math::{clamp, floor, index_of};
use super::placed::{PlacedScene, PosedBody, TileScratch, copy_rows, posed_body};
use super::pool::Pool;
use super::strand_points::ShadedPoint;
use super::surface::raster::SurfaceSamples;
use super::tile::{BLOCK_LANES, Grid, STRIDE, TILE, pixel_of};
use super::tone_map::encode;
use super::view::View;
use crate::backdrop::LaidBackdrop;
use crate::camera::NEAR_METRES;
use crate::{FrameInput, Layers};

/// The least coverage of hair with which a pixel has a mean; less is rounding.
const LEAST_SHARE: f32 = 1e-6;

/// Finished tiles, kept from frame to frame.
#[derive(Debug, Default)]
pub(super) struct LayerTiles {
    pub light: Vec<[f32; 4]>,
    depth: Vec<f32>,
    transmittance: Vec<f32>,
    scratch: Pool<TileScratch>,
}

impl LayerTiles {
    /// Resizes the buffers for a picture.
    pub fn fit(&mut self, grid: &Grid) {
        let places = grid.columns * grid.rows * TILE * TILE;
        self.light.resize(places, [0.0; 4]);
        self.depth.resize(places, 0.0);
        self.transmittance.resize(places, 0.0);
    }

    /// Memory in use, bytes.
    pub fn bytes(&self) -> u64 {
        list_bytes(&self.light)
            + list_bytes(&self.depth)
            + list_bytes(&self.transmittance)
            + self.scratch.bytes(TileScratch::bytes)
    }

    /// Draws depth and transmittance. Overwrites the colours of points. `at_points` and `at_carried` have four packed transmittances per
    /// point of the hairstyle and of carried hair.
    pub fn draw_values(
        &mut self,
        view: &View,
        grid: &Grid,
        input: &FrameInput,
        placed: &mut PlacedScene,
        (at_points, at_carried): (&[u32], &[u32]),
    ) {
        let lit = view.lights.is_empty();
        let value = |(point, &packed): (&mut ShadedPoint, &u32)| {
            let left = if lit { 1.0 } else { (packed & 0xff) as f32 * (1.0 / 255.0) };
            // The value and 1 in place of colours: their quotient is the mean, whatever multiplies both.
            point.color = [left, 1.0, 0.0];
        };
        placed.points.par_iter_mut().zip(at_points).with_min_len(8192).for_each(value);
        placed.carried_points().iter_mut().zip(at_carried).for_each(value);
        let Self { depth, transmittance, scratch, .. } = self;
        let placed = &*placed;
        let tiles = depth.par_chunks_mut(TILE * TILE).zip(transmittance.par_chunks_mut(TILE * TILE));
        tiles.enumerate().for_each_init(
            || scratch.take(),
            |lease, (tile, (depth, transmittance))| {
                depth.fill(Layers::NOTHING_METRES);
                transmittance.fill(1.0);
                if placed.is_empty(tile) {
                    return;
                }
                let scratch = lease.get();
                placed.draw_tile((view, None), grid, input, tile, scratch);
                let nearest = nearest_of(view, grid, placed, (tile, posed_body(input)), &scratch.samples);
                for (i, (depth, transmittance)) in depth.iter_mut().zip(transmittance).enumerate() {
                    let at = i / TILE * STRIDE + i % TILE;
                    if nearest[at] > 0.0 {
                        *depth = NEAR_METRES / nearest[at];
                    }
                    let (sum, share) = (scratch.hair.color[0][at], scratch.hair.color[1][at]);
                    if share > LEAST_SHARE {
                        let mean = clamp(sum / share, 0.0, 1.0);
                        *transmittance = 1.0 - clamp(1.0 - scratch.hair.through[at], 0.0, 1.0) * (1.0 - mean);
                    }
                }
            },
        );
    }

    /// Copies the light of the tiles into rows.
    pub fn write_light(&self, grid: &Grid, out: &mut Layers) {
        out.resize(grid.width, grid.height);
        copy_rows(&self.light, 1, grid, &mut out.light);
    }

    /// Copies the tiles into rows.
    pub fn write(&self, grid: &Grid, out: &mut Layers) {
        out.resize(grid.width, grid.height);
        copy_rows(&self.light, 1, grid, &mut out.light);
        copy_rows(&self.depth, 1, grid, &mut out.depth);
        copy_rows(&self.transmittance, 1, grid, &mut out.transmittance);
    }
}

/// Composites a tile as exposed linear light.
pub(super) fn finish_light(view: &View, input: &PixelsIn, over_background: bool, out: &mut [[f32; 4]]) {
    let exposure = view.uniform.exposure;
    for (y, out) in out.chunks_exact_mut(TILE).enumerate() {
        let (row, open) = compose_row(view, input, y, over_background);
        let is_whole = over_background && input.picture.is_none();
        for (x, out) in out.iter_mut().enumerate() {
            let alpha = if is_whole { 1.0 } else { clamp(1.0 - open[x], 0.0, 1.0) };
            *out = [row[0][x] * exposure, row[1][x] * exposure, row[2][x] * exposure, alpha];
        }
    }
}

/// The nearest depth of each pixel of a tile in clip space; 0 if it is empty.
fn nearest_of(
    view: &View,
    grid: &Grid,
    placed: &PlacedScene,
    (tile, body): (usize, PosedBody),
    samples: &SurfaceSamples,
) -> Vec<f32> {
    let triangles = body.map_or(&[][..], |(body, _)| &body.mesh.triangles);
    // The plane of a triangle seen edge-on grows without bound beside it, so depth is clamped to that of its corners.
    let held = |(depth, id): (f32, u32)| {
        let Some(corners) = triangles.get(id as usize) else { return depth };
        let [a, b, c] = corners.map(|i| placed.surface.vertices[i as usize][2]);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        if low > NEAR_METRES { depth.clamp(NEAR_METRES / high, NEAR_METRES / low) } else { depth }
    };
    let mut near = vec![0.0; TILE * STRIDE];
    for (at, near) in near.iter_mut().enumerate() {
        let shown = samples.depths(at).into_iter().zip(samples.triangles(at));
        *near = shown.map(held).fold(0.0, f32::max);
    }
    let opacity = view.uniform.opacity;
    let mut sink = Nearest { samples, near: &mut near };
    let firsts = placed.segments();
    for &segment in placed.segment_bins.of(tile) {
        let first = firsts[segment as usize] as usize;
        let (a, b) = (&placed.points[first], &placed.points[first + 1]);
        each_span(a, b, grid.origin(tile), opacity, &mut sink);
    }
    near
}

struct Nearest<'a> {
    samples: &'a SurfaceSamples,
    near: &'a mut [f32],
}

impl SpanSink for Nearest<'_> {
    fn take(&mut self, _: &ShadedPoint, _: &ShadedPoint, span: &Span) {
        for lane in 0..BLOCK_LANES {
            let (alpha, depth) = (span.alpha[lane], span.depth[lane]);
            if alpha < Layers::LEAST_COVER {
                continue;
            }
            let (x, y) = pixel_of(span.block, lane);
            let at = y * STRIDE + x;
            let seen = self.samples.depths(at).into_iter().filter(|&body| depth >= body).count();
            if alpha * 0.25 * seen as f32 >= Layers::LEAST_COVER && depth > self.near[at] {
                self.near[at] = depth;
            }
        }
    }
}

/// Row `y` of a tone-mapped picture over the one behind it, from exposed light that is multiplied by alpha.
pub(crate) fn show_row_over(light: &[[f32; 4]], y: u32, behind: &LaidBackdrop, out: &mut [u8]) {
    for (group, (light, out)) in light.chunks(SHOWN).zip(out.chunks_mut(4 * SHOWN)).enumerate() {
        let (mut row, mut open) = ([[0.0; SHOWN]; 3], [0.0; SHOWN]);
        for (x, &[r, g, b, alpha]) in light.iter().enumerate() {
            (row[0][x], row[1][x], row[2][x]) = (r, g, b);
            open[x] = clamp(1.0 - alpha, 0.0, 1.0);
        }
        show_over(&mut row, &open, behind, [group * SHOWN, y as usize], 1.0);
        for (x, pixel) in out.as_chunks_mut::<4>().0.iter_mut().enumerate() {
            let noise = noise_at((group * SHOWN + x) as f32, y as f32);
            let byte = |v: f32| index_of(floor(clamp(v * 255.0 + noise + 0.5, 0.0, 255.0))) as u8;
            *pixel = [byte(row[0][x]), byte(row[1][x]), byte(row[2][x]), 255];
        }
    }
}

/// Pixels that are tone-mapped together.
const SHOWN: usize = 16;

/// Row `y` of a tone-mapped picture, from exposed light that is multiplied by alpha.
pub(crate) fn show_row(light: &[[f32; 4]], y: u32, out: &mut [u8]) {
    for (group, (light, out)) in light.chunks(SHOWN).zip(out.chunks_mut(4 * SHOWN)).enumerate() {
        let mut row = [[0.0; SHOWN]; 3];
        for (x, &[r, g, b, alpha]) in light.iter().enumerate() {
            let scale = if alpha == 1.0 { 1.0 } else { 1.0 / alpha.max(LEAST_SHARE) };
            (row[0][x], row[1][x], row[2][x]) = (r * scale, g * scale, b * scale);
        }
        encode(&mut row, 1.0);
        for (x, (&[.., alpha], pixel)) in light.iter().zip(out.as_chunks_mut::<4>().0).enumerate() {
            let noise = noise_at((group * SHOWN + x) as f32, y as f32);
            let byte = |v: f32| index_of(floor(clamp(v, 0.0, 255.0))) as u8;
            let [r, g, b] = [0, 1, 2].map(|c| byte(row[c][x] * 255.0 + noise + 0.5));
            *pixel = match byte(alpha * 255.0 + 0.5) {
                0 => [0; 4],
                alpha => [r, g, b, alpha],
            };
        }
    }
}
