//! Filtered lookups: four loads and four exponentials per point.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(unsafe_code, clippy::inline_always, clippy::needless_range_loop)]

use glam::Vec3;
use lovelock_base::numbers::mix;
use lovelock_base::simd::whole_part;
use lovelock_base::simd_versions;

use super::VoxelFilter;
use super::lattice::Lattice;
use super::layout::{Layout, TILE_CELLS};
use crate::exp::exp_of_minus_steps;

/// Points that are looked up together.
pub(super) const BLOCK: usize = 64;

simd_versions! {
    /// [`Lookup::run`] for the vectors of `width`.
    pub(super) fn look_up_simd(lookup: &Lookup, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) -> () {
        lookup.run(x, y, z, out)
    }
}

/// A map that can be read.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lookup<'a> {
    pub layout: Layout,
    pub lattice: &'a Lattice,
    /// Faces; see `sum`.
    pub cells: &'a [u32],
    /// Groups of slices that contain hair, per tile.
    pub touched: &'a [u64],
    /// Groups that hold faces, per tile. Elsewhere the last group before it counts; before the first one a column is lit.
    pub filled: &'a [u64],
    pub filter: VoxelFilter,
}

/// The positions of a block of points in the map.
struct Places {
    along: [f32; BLOCK],
    across_y: [f32; BLOCK],
    across_z: [f32; BLOCK],
    /// Addresses of the four columns: `(j, k)`, `(j, k + 1)`, `(j + 1, k)`, `(j + 1, k + 1)`.
    addresses: [[u32; BLOCK]; 4],
    slice: [u32; BLOCK],
    /// The tile that contains the point.
    tile: [u32; BLOCK],
}

impl Lookup<'_> {
    /// Transmittance of one point.
    pub(super) fn one(&self, p: Vec3) -> f32 {
        let mut out = [0.0];
        self.run(&[p.x], &[p.y], &[p.z], &mut out);
        out[0]
    }

    /// Transmittance of many points. All slices have the same length.
    #[inline(always)]
    fn run(&self, x: &[f32], y: &[f32], z: &[f32], out: &mut [f32]) {
        let blocks = x.chunks(BLOCK).zip(y.chunks(BLOCK)).zip(z.chunks(BLOCK)).zip(out.chunks_mut(BLOCK));
        for (((x, y), z), out) in blocks {
            if let (Ok(x), Ok(y), Ok(z), Ok(out)) =
                (x.try_into(), y.try_into(), z.try_into(), <&mut [f32; BLOCK]>::try_from(&mut *out))
            {
                self.block([x, y, z], out);
            } else {
                let pad = |axis: &[f32]| {
                    let mut lanes = [0.0; BLOCK];
                    lanes[..axis.len()].copy_from_slice(axis);
                    lanes
                };
                let mut padded = [0.0; BLOCK];
                self.block([&pad(x), &pad(y), &pad(z)], &mut padded);
                out.copy_from_slice(&padded[..out.len()]);
            }
        }
    }

    #[inline(always)]
    fn block(&self, points: [&[f32; BLOCK]; 3], out: &mut [f32; BLOCK]) {
        let places = self.place(points);
        let faces = self.load(&places);
        if self.filter == VoxelFilter::Paper {
            filter::<true>(&places, &faces, out);
        } else {
            filter::<false>(&places, &faces, out);
        }
    }

    #[inline(always)]
    fn place(&self, points: [&[f32; BLOCK]; 3]) -> Places {
        let (layout, lattice, anchor) = (&self.layout, self.lattice, self.lattice.anchor);
        let first = lattice.first.as_vec3();
        let n = layout.resolution as f32;
        let [last, last_but_one] = [1, 2].map(|from_end| layout.resolution - from_end);
        // The value of a column belongs to its centre; in the printed filter, to its far edge.
        let lead = match self.filter {
            VoxelFilter::Closest => 0.0,
            VoxelFilter::Centred => 0.5,
            VoxelFilter::Paper => 1.0,
        };
        // The back face of the closest cell alone. Only beyond the last column is a fraction 1.
        let closest = self.filter == VoxelFilter::Closest;
        let least = if closest { 1.0 } else { 0.0 };
        let mut places = Places {
            along: [0.0; BLOCK],
            across_y: [0.0; BLOCK],
            across_z: [0.0; BLOCK],
            addresses: [[0; BLOCK]; 4],
            slice: [0; BLOCK],
            tile: [0; BLOCK],
        };
        let [to_i, to_j, to_k] = lattice.axes_per_cell;
        for lane in 0..BLOCK {
            let d = [points[0][lane] - anchor.x, points[1][lane] - anchor.y, points[2][lane] - anchor.z];
            let u = (d[0] * to_i.x + d[1] * to_i.y + d[2] * to_i.z) - first.x;
            let v = (d[0] * to_j.x + d[1] * to_j.y + d[2] * to_j.z) - first.y;
            let w = (d[0] * to_k.x + d[1] * to_k.y + d[2] * to_k.z) - first.z;
            // Points before the window and NaN read the first face and the border, which are lit.
            let (u, i) = split(u, n, last);
            let (fy, j) = split(v - lead, n - 1.0, last_but_one);
            let (fz, k) = split(w - lead, n - 1.0, last_but_one);
            places.along[lane] = if closest { 1.0 } else { u };
            places.across_y[lane] = if fy < least { 0.0 } else { fy };
            places.across_z[lane] = if fz < least { 0.0 } else { fz };
            places.slice[lane] = i;
            let row = |j: u32| layout.row(j).wrapping_add(Layout::slice(i));
            let (near_j, far_j) = (row(j), row(j.wrapping_add(1)));
            let (near_k, far_k) = (layout.column(k), layout.column(k.wrapping_add(1)));
            places.addresses[0][lane] = near_j.wrapping_add(near_k);
            places.addresses[1][lane] = near_j.wrapping_add(far_k);
            places.addresses[2][lane] = far_j.wrapping_add(near_k);
            places.addresses[3][lane] = far_j.wrapping_add(far_k);
            let (_, j) = split(v, n, last);
            let (_, k) = split(w, n, last);
            places.tile[lane] = layout.tile(j, k);
        }
        places
    }

    /// The four cells of every point.
    #[inline(always)]
    fn load(&self, places: &Places) -> [[u32; BLOCK]; 4] {
        let mut faces = [[0; BLOCK]; 4];
        for lane in 0..BLOCK {
            // Tiles with hair and their neighbours are filled, and most points of hair lie there.
            let groups = self.touched[places.tile[lane] as usize];
            let group = places.slice[lane].wrapping_shr(self.layout.group_shift);
            if groups.wrapping_shr(group) & 1 == 0 {
                self.load_anywhere(places, lane, &mut faces);
                continue;
            }
            for (faces, addresses) in faces.iter_mut().zip(&places.addresses) {
                faces[lane] = self.cells[addresses[lane] as usize];
            }
        }
        faces
    }

    /// The four cells of a point that may lie outside the filled groups.
    #[cold]
    #[inline(never)]
    fn load_anywhere(&self, places: &Places, lane: usize, faces: &mut [[u32; BLOCK]; 4]) {
        for (faces, addresses) in faces.iter_mut().zip(&places.addresses) {
            faces[lane] = self.cell_anywhere(addresses[lane] as usize);
        }
    }

    /// The faces of any cell. In a gap between groups both are the last back face before it.
    pub(super) fn cell_anywhere(&self, address: usize) -> u32 {
        let layout = &self.layout;
        let tile = address >> layout.tile_shift;
        let group = (address >> layout.group_len_shift()) % layout.groups();
        let until = self.filled[tile] & (u64::MAX >> (63 - group));
        if until >> group & 1 != 0 {
            return self.cells[address];
        }
        let Some(last) = until.checked_ilog2() else { return 0 };
        let last_slice = layout.group_cells(last as usize).end - TILE_CELLS;
        let back = self.cells[(tile << layout.tile_shift) + last_slice + address % TILE_CELLS] >> 16;
        back | back << 16
    }
}

/// The fractional and the integer part of `c`, clamped to `0..=end`; the integer part is at most `last`.
#[inline(always)]
fn split(c: f32, end: f32, last: u32) -> (f32, u32) {
    // NaN becomes 0.
    let c = if c > 0.0 { c } else { 0.0 };
    let c = if c < end { c } else { end };
    let whole = whole_part(c).min(last as i32);
    (c - whole as f32, whole as u32)
}

/// Interpolation along the light, exponentials, and interpolation across.
#[inline(always)]
fn filter<const AS_PRINTED: bool>(places: &Places, faces: &[[u32; BLOCK]; 4], out: &mut [f32; BLOCK]) {
    for (lane, out) in out.iter_mut().enumerate() {
        let light = |column: usize| {
            let cell = faces[column][lane];
            let (front, back) = ((cell & 0xffff) as i32 as f32, (cell >> 16) as i32 as f32);
            if AS_PRINTED {
                mix(exp_of_minus_steps(front), exp_of_minus_steps(back), places.along[lane])
            } else {
                // Exact for a cell of uniform density.
                exp_of_minus_steps(mix(front, back, places.along[lane]))
            }
        };
        let near = mix(light(0), light(1), places.across_z[lane]);
        let far = mix(light(2), light(3), places.across_z[lane]);
        let t = mix(near, far, places.across_y[lane]);
        *out = if t < 1.0 { t } else { 1.0 };
    }
}

/// Transmittance of a whole column, from its last back face.
pub(super) fn behind_all(cell: u32) -> f32 {
    exp_of_minus_steps((cell >> 16) as i32 as f32)
}
