//! The background: the twin of `backdrop.wgsl`.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use glam::Vec3;
use lovelock_base::simd_versions;

use super::math::{exp2, max, mix, smoothstep, three};
use super::tile::TILE;
use super::view::View;
use crate::uniform::background_form::{RADIAL, STUDIO, VERTICAL};

/// Pixels along each edge of a cell of ground, whose light is uniform if that of its corners is.
const CELL: usize = 4;
const CORNERS: usize = TILE / CELL + 1;
/// Positions that are evaluated together.
const LANES: usize = 16;

/// The fraction of the light that reaches the ground of a tile.
///
/// Most of the ground is lit uniformly: it is evaluated at the corners of cells first, and per pixel only in cells whose corners
/// differ.
#[derive(Clone, Debug)]
pub(super) struct Ground {
    origin: [f32; 2],
    corners: [[Option<[f32; 3]>; CORNERS]; CORNERS],
}

simd_versions! {
    /// [`Ground::new`] for the vectors of `width`.
    pub(super) fn ground_simd(view: &View, origin: [f32; 2]) -> Option<Ground> {
        Ground::new(view, origin)
    }
}

/// The difference of the light at two corners up to which a cell counts as uniform: half a step of 8 bits.
const ALIKE: f32 = 1.0 / 512.0;

impl Ground {
    /// Evaluates the corners of the cells of the tile at `origin`. `None` if there is no ground or all of it is fully lit.
    #[inline(always)]
    pub fn new(view: &View, origin: [f32; 2]) -> Option<Self> {
        if view.uniform.shows_ground == 0 {
            return None;
        }
        let size = view.uniform.size;
        let (x0, y0) = (2.0 * origin[0] / size.x - 1.0, 1.0 - 2.0 * origin[1] / size.y);
        let (x1, y1) = (x0 + 2.0 * TILE as f32 / size.x, y0 - 2.0 * TILE as f32 / size.y);
        let (outline, is_ground) = ground_place(view, &[[x0, x1, x0, x1], [y0, y0, y1, y1]]);
        // The ground in a tile is convex, so it lies within the bounds of its corners.
        let lit = is_ground == [1.0; 4] && view.lights.iter().all(|light| light.is_beside(&outline));
        if lit || is_ground == [0.0; 4] {
            return None;
        }
        let mut corners = [[None; CORNERS]; CORNERS];
        let mut any = false;
        for (j, row) in corners.iter_mut().enumerate() {
            let mut ndc = [[2.0; LANES]; 2];
            for i in 0..CORNERS {
                ndc[0][i] = 2.0 * (origin[0] + (i * CELL) as f32) / size.x - 1.0;
                ndc[1][i] = 1.0 - 2.0 * (origin[1] + (j * CELL) as f32) / size.y;
            }
            let light = ground_light(view, &ndc);
            for (i, corner) in row.iter_mut().enumerate() {
                if light[3][i] > 0.0 {
                    let here = [light[0][i], light[1][i], light[2][i]];
                    any |= here != [1.0; 3];
                    *corner = Some(here);
                }
            }
        }
        any.then_some(Self { origin, corners })
    }

    /// The fraction of the light at the centre of pixel `x`, `y` of the tile; 1 above the horizon.
    #[inline(always)]
    pub fn light(&self, view: &View, x: usize, y: usize) -> [f32; 3] {
        let (i, j) = (x / CELL, y / CELL);
        let corners =
            [self.corners[j][i], self.corners[j][i + 1], self.corners[j + 1][i], self.corners[j + 1][i + 1]];
        if let [Some(a), Some(b), Some(c), Some(d)] = corners {
            let alike = |c: &[f32; 3]| {
                (a[0] - c[0]).abs() < ALIKE && (a[1] - c[1]).abs() < ALIKE && (a[2] - c[2]).abs() < ALIKE
            };
            if alike(&b) && alike(&c) && alike(&d) {
                return a;
            }
        }
        let size = view.uniform.size;
        let (x, y) = (self.origin[0] + x as f32 + 0.5, self.origin[1] + y as f32 + 0.5);
        let light = ground_light(view, &[[2.0 * x / size.x - 1.0], [1.0 - 2.0 * y / size.y]]);
        [light[0][0], light[1][0], light[2][0]]
    }
}

/// How much darker the background is far from the pool of light behind the figure.
const POOL_DEPTH: f32 = 0.6;
/// Exponent of the pool's bell: it is half as strong at a distance of 0.88 from its middle, where 1 is half the height of a
/// square image.
const POOL_FALL: f32 = -1.3;
/// Height of the pool's middle: head and shoulders are above the middle of the image.
const POOL_Y: f32 = 0.12;

/// The fully lit colour of a row of a tile whose first pixel has its centre at `x`, `y`.
#[inline(always)]
pub(super) fn backdrop(view: &View, x: f32, y: f32, out: &mut [[f32; TILE]; 3]) {
    let uniform = view.uniform;
    let size = uniform.size;
    let (top, bottom) = (uniform.background_top.to_array(), uniform.background_bottom.to_array());
    let ndc_y = 1.0 - 2.0 * y / size.y;
    let blend = smoothstep(0.0, 1.0, 0.5 - 0.5 * ndc_y);
    match uniform.background_form {
        STUDIO => {}
        RADIAL => {
            let (aspect, first, step) = (size.x / size.y, 2.0 * x / size.x - 1.0, 2.0 / size.x);
            let corner = (aspect * aspect + 1.0).sqrt();
            for lane in 0..TILE {
                let u = (first + step * lane as f32) * aspect;
                let outward = smoothstep(0.0, 1.0, (u * u + ndc_y * ndc_y).sqrt() / corner);
                for c in 0..3 {
                    out[c][lane] = mix(bottom[c], top[c], outward);
                }
            }
            return;
        }
        form => {
            for c in 0..3 {
                out[c].fill(if form == VERTICAL { mix(top[c], bottom[c], blend) } else { top[c] });
            }
            return;
        }
    }
    // Half as elongated as the image.
    let (wide, high) = ((size.x / size.y).sqrt(), ndc_y - POOL_Y);
    let (first, step) = (2.0 * x / size.x - 1.0, 2.0 / size.x);
    let mut pool = [0.0; TILE];
    for (lane, pool) in pool.iter_mut().enumerate() {
        let u = (first + step * lane as f32) * wide;
        // A bell has no edge: where a ramp begins or ends, the eye sees a ring.
        *pool = 1.0 - POOL_DEPTH * (1.0 - exp2(POOL_FALL * (u * u + high * high)));
    }
    for c in 0..3 {
        let color = mix(top[c], bottom[c], blend);
        for lane in 0..TILE {
            out[c][lane] = color * pool[lane];
        }
    }
}

/// The positions on the ground behind positions of the picture, and whether there is ground: 1 or 0.
#[inline(always)]
fn ground_place<const N: usize>(view: &View, ndc: &[[f32; N]; 2]) -> ([[f32; N]; 3], [f32; N]) {
    let eye = view.uniform.eye.to_array();
    let m = view.uniform.world_from_clip.to_cols_array_2d();
    let mut place = [[0.0; N]; 3];
    let mut is_ground = [0.0; N];
    for lane in 0..N {
        let near = |row: usize| m[0][row] * ndc[0][lane] + m[1][row] * ndc[1][lane] + m[2][row] + m[3][row];
        let inverse = 1.0 / near(3);
        let ray = three(|axis| near(axis) * inverse - eye[axis]);
        let length = (ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2]).sqrt();
        let seen = (ray[1] < -1e-3 * length) & (eye[1] > 0.0);
        is_ground[lane] = if seen { 1.0 } else { 0.0 };
        let far = if seen { eye[1] / ray[1] } else { 0.0 };
        for axis in 0..3 {
            place[axis][lane] = eye[axis] - ray[axis] * far;
        }
    }
    (place, is_ground)
}

/// The fraction of the light on the ground behind positions of the picture, and whether there is ground: 1 or 0. Above the
/// horizon the fraction is 1.
#[inline(always)]
fn ground_light<const N: usize>(view: &View, ndc: &[[f32; N]; 2]) -> [[f32; N]; 4] {
    let mut out = [[1.0; N]; 4];
    let (place, is_ground) = ground_place(view, ndc);
    out[3] = is_ground;
    if is_ground == [0.0; N] {
        return out;
    }
    let ambient = view.ambient([0.0, 1.0, 0.0]);
    let sky = three(|c| ambient[c] * 3.141_59);
    let mut full = [[sky[0]; N], [sky[1]; N], [sky[2]; N]];
    let mut lit = full;
    for light in &view.lights {
        let (toward, arriving) = light.arriving(&place);
        let mut facing = [0.0; N];
        let mut any = false;
        for lane in 0..N {
            facing[lane] = max(toward[1][lane], 0.0) * arriving[lane];
            any |= facing[lane] > 0.0;
        }
        if !any {
            continue;
        }
        let up = [[0.0; N], [1.0; N], [0.0; N]];
        let body = light.past_body(&place, Some(&up), 0.004, &view.surface_disc);
        let radiance = light.radiance.to_array();
        for lane in 0..N {
            let hair = light.columns_light(Vec3::new(place[0][lane], place[1][lane], place[2][lane]));
            for c in 0..3 {
                let share = radiance[c] * facing[lane];
                full[c][lane] += share;
                lit[c][lane] += share * (body[lane] * hair);
            }
        }
    }
    for c in 0..3 {
        for lane in 0..N {
            // Without light there is no shadow.
            let (lit, full) = (lit[c][lane] + max(1e-4 - full[c][lane], 0.0), max(full[c][lane], 1e-4));
            out[c][lane] = if out[3][lane] > 0.0 { lit / full } else { 1.0 };
        }
    }
    out
}
