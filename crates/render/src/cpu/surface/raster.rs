//! The visible triangle of each sample of a tile.
//!
//! Edges are planes in the homogeneous coordinates of the picture (Olano, Greer 1997, "Triangle Scan
//! Conversion using 2D Homogeneous Coordinates"), so that a triangle through the near plane needs no clipping.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use lovelock_base::simd_versions;

use super::edges::{Edges, at};
use super::materials::{CutTriangle, Cutouts};
use super::pixel_bounds;
use crate::camera::NEAR_METRES;
use crate::cpu::math::{max, min, three};
use crate::cpu::tile::{BLOCK_LANES, BLOCKS, STRIDE, TILE, pixel_of};

/// The positions of samples in a pixel: the standard pattern of GPUs.
pub(crate) const SAMPLES: [[f32; 2]; 4] = [[0.375, 0.125], [0.875, 0.375], [0.125, 0.625], [0.625, 0.875]];
/// No triangle.
pub(crate) const NOTHING: u32 = u32::MAX;
/// Pixels that are drawn together, and their samples.
const PIXELS: usize = 4;
const LANES: usize = PIXELS * SAMPLES.len();

/// Depth and triangle of each sample of a tile. Samples of a pixel are contiguous; a row has [`STRIDE`] pixels.
#[derive(Clone, Debug)]
pub(crate) struct SurfaceSamples {
    /// 1 at the near plane, 0 for empty samples.
    pub depth: [f32; TILE * STRIDE * SAMPLES.len()],
    pub triangle: [u32; TILE * STRIDE * SAMPLES.len()],
}

impl Default for SurfaceSamples {
    #[expect(clippy::large_stack_arrays, reason = "created once per thread and boxed immediately")]
    fn default() -> Self {
        Self {
            depth: [0.0; TILE * STRIDE * SAMPLES.len()],
            triangle: [NOTHING; TILE * STRIDE * SAMPLES.len()],
        }
    }
}

impl SurfaceSamples {
    pub fn clear(&mut self) {
        self.depth.fill(0.0);
        self.triangle.fill(NOTHING);
    }

    /// Depths of the samples of the pixel at `at`.
    #[inline(always)]
    pub fn depths(&self, at: usize) -> [f32; SAMPLES.len()] {
        let at = at * SAMPLES.len();
        [self.depth[at], self.depth[at + 1], self.depth[at + 2], self.depth[at + 3]]
    }

    /// Triangles of the samples of the pixel at `at`.
    pub fn triangles(&self, at: usize) -> [u32; SAMPLES.len()] {
        let at = at * SAMPLES.len();
        [self.triangle[at], self.triangle[at + 1], self.triangle[at + 2], self.triangle[at + 3]]
    }
}

/// What the body hides in each pixel of a tile: the body hides the fraction `share` of what is behind `near`, and all of what is
/// behind `far`. In blocks, like hair.
#[derive(Clone, Debug)]
pub(crate) struct Occlusion {
    pub near: [[f32; BLOCK_LANES]; BLOCKS],
    pub far: [[f32; BLOCK_LANES]; BLOCKS],
    pub share: [[f32; BLOCK_LANES]; BLOCKS],
}

impl Default for Occlusion {
    fn default() -> Self {
        let nothing = [[0.0; BLOCK_LANES]; BLOCKS];
        Self { near: nothing, far: nothing, share: nothing }
    }
}

impl Occlusion {
    pub fn clear(&mut self) {
        self.near.fill([0.0; BLOCK_LANES]);
        self.far.fill([0.0; BLOCK_LANES]);
        self.share.fill([0.0; BLOCK_LANES]);
    }

    /// Summarises the samples of each pixel: the nearest, the farthest, and the number at the nearest depth.
    #[inline(always)]
    pub fn gather(&mut self, samples: &SurfaceSamples) {
        for block in 0..BLOCKS {
            for lane in 0..BLOCK_LANES {
                let (x, y) = pixel_of(block, lane);
                let d = samples.depths(y * STRIDE + x);
                let near = max(max(d[0], d[1]), max(d[2], d[3]));
                let far = min(min(d[0], d[1]), min(d[2], d[3]));
                let middle = 0.5 * (near + far);
                let with = |d: f32| if d >= middle { 0.25 } else { 0.0 };
                (self.near[block][lane], self.far[block][lane]) = (near, far);
                self.share[block][lane] = with(d[0]) + with(d[1]) + with(d[2]) + with(d[3]);
            }
        }
    }
}

/// The input of a tile.
pub(crate) struct TriangleTile<'a> {
    /// The corner of the tile, pixels.
    pub origin: [f32; 2],
    /// Pixels from the left and top times w, and w.
    pub vertices: &'a [[f32; 3]],
    pub triangles: &'a [[u32; 3]],
    /// The triangles that touch the tile.
    pub list: &'a [u32],
    /// The holes of triangles, if the body has materials.
    pub cutouts: Option<Cutouts<'a>>,
}

simd_versions! {
    /// [`raster_triangles`] for the vectors of `width`.
    pub(crate) fn raster_triangles_simd(input: &TriangleTile, out: &mut SurfaceSamples, hidden: &mut Occlusion) -> () {
        raster_triangles(input, out, hidden)
    }
}

/// Rasterises triangles into a tile with a depth test.
#[inline(always)]
fn raster_triangles(input: &TriangleTile, out: &mut SurfaceSamples, hidden: &mut Occlusion) {
    raster(input, out);
    hidden.gather(out);
}

#[inline(always)]
fn raster(input: &TriangleTile, out: &mut SurfaceSamples) {
    for &id in input.list {
        let [i, j, k] = input.triangles[id as usize];
        let corners = [input.vertices[i as usize], input.vertices[j as usize], input.vertices[k as usize]];
        let Some(edges) = Edges::new(corners, input.origin) else { continue };
        let tile = TILE as f32;
        let [left, top, right, bottom] = match pixel_bounds(corners) {
            Some([l, t, r, b]) => {
                [l - input.origin[0], t - input.origin[1], r - input.origin[0], b - input.origin[1]]
            }
            None => [0.0, 0.0, tile, tile],
        };
        if right < 0.0 || bottom < 0.0 || left >= tile || top >= tile {
            continue;
        }
        let (x0, x1) = (left.max(0.0) as usize, right.min(tile - 1.0) as usize);
        let (y0, y1) = (top.max(0.0) as usize, bottom.min(tile - 1.0) as usize);
        let near = edges.scale * NEAR_METRES;
        // Differences of each plane between the first sample of a run and the others.
        let mut steps = [[0.0; LANES]; 3];
        for (steps, [a, b, _]) in steps.iter_mut().zip(edges.planes) {
            for lane in 0..LANES {
                steps[lane] = a * OFFSETS[0][lane] + b * OFFSETS[1][lane];
            }
        }
        if let Some(cut) = input.cutouts.and_then(|cutouts| cutouts.of(id)) {
            raster_cut(input, (&cut, &edges), near, ([x0, x1], [y0, y1]), id, out);
            continue;
        }
        for y in y0..=y1 {
            for x in (x0..=x1).step_by(PIXELS) {
                let (fx, fy) = (x as f32, y as f32);
                let start = three(|i| at(edges.planes[i], fx, fy));
                raster_run(start, &steps, near, id, (y * STRIDE + x) * SAMPLES.len(), out);
            }
        }
    }
}

/// Rasterises a triangle with holes, sample by sample.
fn raster_cut(
    input: &TriangleTile,
    (cut, edges): (&CutTriangle, &Edges),
    near: f32,
    ([x0, x1], [y0, y1]): ([usize; 2], [usize; 2]),
    id: u32,
    out: &mut SurfaceSamples,
) {
    let [left, top] = input.origin.map(|c| c as u32);
    for y in y0..=y1 {
        for x in x0..=x1 {
            for (k, [dx, dy]) in SAMPLES.into_iter().enumerate() {
                let place = (y * STRIDE + x) * SAMPLES.len() + k;
                let e = three(|i| at(edges.planes[i], x as f32 + dx, y as f32 + dy));
                let z = (e[0] + e[1] + e[2]) * near;
                let inside = min(min(e[0], e[1]), e[2]) >= 0.0 && z <= 1.0;
                if inside && z > out.depth[place] && cut.shows(edges, e, [left + x as u32, top + y as u32], k)
                {
                    (out.depth[place], out.triangle[place]) = (z, id);
                }
            }
        }
    }
}

/// Positions of the samples of a run of pixels, relative to its corner.
const OFFSETS: [[f32; LANES]; 2] = {
    let mut offsets = [[0.0; LANES]; 2];
    let mut lane = 0;
    while lane < LANES {
        let sample = SAMPLES[lane % SAMPLES.len()];
        offsets[0][lane] = (lane / SAMPLES.len()) as f32 + sample[0];
        offsets[1][lane] = sample[1];
        lane += 1;
    }
    offsets
};

#[inline(always)]
fn raster_run(
    start: [f32; 3],
    steps: &[[f32; LANES]; 3],
    near: f32,
    id: u32,
    place: usize,
    out: &mut SurfaceSamples,
) {
    let (Some(depth), Some(shown)) =
        (out.depth[place..].first_chunk_mut::<LANES>(), out.triangle[place..].first_chunk_mut::<LANES>())
    else {
        return;
    };
    let before = *depth;
    let mut after = [0.0; LANES];
    for lane in 0..LANES {
        let e = [start[0] + steps[0][lane], start[1] + steps[1][lane], start[2] + steps[2][lane]];
        let z = (e[0] + e[1] + e[2]) * near;
        // The least of all conditions decides: one comparison vectorises, several do not. NaN passes none.
        let inside = min(min(min(e[0], e[1]), e[2]), min(1.0 - z, z - before[lane]));
        after[lane] = if inside >= 0.0 { z } else { before[lane] };
    }
    *depth = after;
    for lane in 0..LANES {
        shown[lane] = if after[lane] == before[lane] { shown[lane] } else { id };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn draw(triangles: &[[[f32; 3]; 3]]) -> Box<SurfaceSamples> {
        let vertices: Vec<[f32; 3]> =
            triangles.iter().flatten().map(|&[x, y, w]| [x * w, y * w, w]).collect();
        let indices: Vec<[u32; 3]> =
            (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let list: Vec<u32> = (0..triangles.len() as u32).collect();
        let mut out = Box::<SurfaceSamples>::default();
        let input = TriangleTile {
            origin: [0.0, 0.0],
            vertices: &vertices,
            triangles: &indices,
            list: &list,
            cutouts: None,
        };
        raster(&input, &mut out);
        out
    }

    fn covered(out: &SurfaceSamples) -> usize {
        let inside = |(i, id): &(usize, &u32)| i / SAMPLES.len() % STRIDE < TILE && **id != NOTHING;
        out.triangle.iter().enumerate().filter(inside).count()
    }

    #[test]
    fn two_halves_of_a_square_cover_it_whole_with_the_right_depth() {
        let (a, b, c, d) = ([4.0, 4.0, 2.0], [20.0, 4.0, 2.0], [20.0, 28.0, 2.0], [4.0, 28.0, 2.0]);
        let out = draw(&[[a, b, c], [a, d, c]]);
        assert_eq!(covered(&out), 16 * 24 * 4);
        assert!((out.depths(10 * STRIDE + 10)[0] - NEAR_METRES / 2.0).abs() < 1e-6);
        assert_eq!(out.triangles(10 * STRIDE + 3), [NOTHING; 4]);
    }

    #[test]
    fn the_nearer_one_is_seen_whatever_the_order() {
        let far = [[0.0, 0.0, 3.0], [31.0, 0.0, 3.0], [0.0, 31.0, 3.0]];
        let near = far.map(|[x, y, _]| [x, y, 1.0]);
        let id = |triangles: &[_]| draw(triangles).triangles(5 * STRIDE + 5)[2];
        assert_eq!(id(&[far, near]), 1);
        assert_eq!(id(&[near, far]), 0);
    }

    #[test]
    fn a_triangle_through_the_near_plane_is_cut_there() {
        // A floor from far before the eye to behind it: w grows upward in the picture.
        let corners = [[-400.0, 80.0, 5.0], [400.0, 80.0, 5.0], [16.0, 160.0, -1.0]];
        let vertices: Vec<[f32; 3]> = corners.iter().map(|&[x, y, w]| [x, y, w]).collect();
        let mut out = Box::<SurfaceSamples>::default();
        let input = TriangleTile {
            origin: [0.0, 0.0],
            vertices: &vertices,
            triangles: &[[0, 1, 2]],
            list: &[0],
            cutouts: None,
        };
        raster(&input, &mut out);
        assert!(covered(&out) > 0, "what is before the eye is drawn");
        assert!(out.depth.iter().all(|z| (0.0..=1.0).contains(z)));
    }

    #[test]
    fn nonsense_draws_nothing() {
        let out = draw(&[
            [[f32::NAN, 0.0, 1.0], [9.0, 0.0, 1.0], [0.0, 9.0, 1.0]],
            [[1.0, 1.0, 1.0], [9.0, 9.0, 1.0], [5.0, 5.0, 1.0]],
            [[f32::INFINITY, 0.0, 1.0], [9.0, 0.0, 1.0], [0.0, 9.0, 1.0]],
        ]);
        assert_eq!(covered(&out), 0);
    }
}
