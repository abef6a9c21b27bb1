//! The background: the twin of `backdrop.wgsl`.
// Compiled within the versions of `dispatch`.
#![allow(clippy::inline_always)]

use glam::Vec3;

use super::math::{mix, smoothstep};
use super::tile::TILE;
use super::view::View;

/// Pixels along each edge of a cell of ground: where its corners agree, so does what is between them.
const CELL: usize = 4;
const CORNERS: usize = TILE / CELL + 1;

/// The share of the light that is left on the ground of a tile.
///
/// Most of the ground is lit evenly: it is asked at the corners of cells first, and pixel by pixel only in cells
/// whose corners differ.
#[derive(Clone, Debug)]
pub(super) struct Ground {
    origin: [f32; 2],
    corners: [[Option<[f32; 3]>; CORNERS]; CORNERS],
}

/// Difference of two corners' light that is not worth a look between them: half a step of 8 bits.
const ALIKE: f32 = 1.0 / 512.0;

impl Ground {
    /// Asks for the light at the corners of the cells of the tile at `origin`; none where there is no ground or all of
    /// it lies in full light.
    pub fn new(view: &View, origin: [f32; 2]) -> Option<Self> {
        if view.uniform.ambient_up_ground.w <= 0.5 {
            return None;
        }
        let mut corners = [[None; CORNERS]; CORNERS];
        let mut any = false;
        for (j, row) in corners.iter_mut().enumerate() {
            for (i, corner) in row.iter_mut().enumerate() {
                let (x, y) = (origin[0] + (i * CELL) as f32, origin[1] + (j * CELL) as f32);
                *corner = ground_light(view, x, y);
                any |= corner.is_some_and(|light| light != [1.0; 3]);
            }
        }
        any.then_some(Self { origin, corners })
    }

    /// The share of the light at the centre of pixel `x`, `y` of the tile; 1 above the horizon.
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
        let (x, y) = (self.origin[0] + x as f32 + 0.5, self.origin[1] + y as f32 + 0.5);
        ground_light(view, x, y).unwrap_or([1.0; 3])
    }
}

/// Colour of a row of a tile in full light; the first pixel has its centre at `x`, `y`.
#[inline(always)]
pub(super) fn backdrop(view: &View, x: f32, y: f32, out: &mut [[f32; TILE]; 3]) {
    let uniform = view.uniform;
    let size = uniform.size_scale_exposure;
    let (top, bottom) = (uniform.background_top.to_array(), uniform.background_bottom.to_array());
    let ndc_y = 1.0 - 2.0 * y / size.y;
    let blend = smoothstep(0.0, 1.0, 0.5 - 0.5 * ndc_y);
    let (first, step, v) = (2.0 * x / size.x - 1.0, 2.0 / size.x, ndc_y * 0.7);
    let mut pool = [0.0; TILE];
    for (lane, pool) in pool.iter_mut().enumerate() {
        let u = (first + step * lane as f32) * 0.8;
        // A soft pool of light behind the figure.
        *pool = 1.0 - 0.28 * smoothstep(0.2, 1.5, (u * u + v * v).sqrt());
    }
    for c in 0..3 {
        let color = mix(top[c], bottom[c], blend);
        for lane in 0..TILE {
            out[c][lane] = color * pool[lane];
        }
    }
}

/// The share of the light that is left on the ground behind a place of the picture; none above the horizon.
fn ground_light(view: &View, x: f32, y: f32) -> Option<[f32; 3]> {
    let uniform = view.uniform;
    let eye = uniform.eye_lights.truncate();
    let size = uniform.size_scale_exposure;
    let m = &uniform.world_from_clip;
    let near =
        m.x_axis * (2.0 * x / size.x - 1.0) + m.y_axis * (1.0 - 2.0 * y / size.y) + m.z_axis + m.w_axis;
    let ray = (near.truncate() / near.w - eye).normalize_or_zero();
    if ray.y >= -1e-3 || eye.y <= 0.0 {
        return None;
    }
    let p = eye - ray * (eye.y / ray.y);
    let mut full = Vec3::from(view.ambient(1.0)) * (0.5 * 3.141_59);
    let mut lit = full;
    for light in &view.lights {
        let share = light.radiance * (-light.direction.y).max(0.0);
        full += share;
        if share.max_element() > 0.0 {
            let [body] = light.body_light(&[[p.x], [p.y], [p.z]], &[0.004], &view.disc6);
            lit += share * (body * light.columns_light(p));
        }
    }
    Some((lit / full.max(Vec3::splat(1e-4))).to_array())
}
