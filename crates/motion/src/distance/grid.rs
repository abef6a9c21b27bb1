//! Distances on a grid of coarse cells, with finer ones near the surface.

use glam::{UVec3, Vec3};
use rayon::prelude::*;

use super::{
    Exact,
    bricks::{Brick, CELLS, make_bricks},
    signs::{Known, on_one_side},
};

/// Most coarse cells, and so many along the longest side: 20 mm for the reach of hair.
const MOST_CELLS: f32 = 60_000.0;
const ALONG: f32 = 85.0;
/// Most cells that are divided, 500 bytes each; surfaces that fill their space get larger cells.
const MOST_BRICKS: usize = 40_000;
/// Cells with a corner closer to the surface than this, in sizes of a cell, are divided.
const NEAR: f32 = 1.2;
/// Marks a cell that is not divided.
pub(super) const WHOLE: u32 = u32::MAX;

/// The coarse cells: cubes, with distances at their corners.
#[derive(Clone, Debug)]
pub(super) struct Lattice {
    pub(super) low: Vec3,
    pub(super) cell: f32,
    pub(super) cells: UVec3,
    /// At each corner, x fastest, z slowest: one more along each side than there are cells.
    pub(super) distances: Vec<f32>,
}

impl Lattice {
    pub(super) fn corner(&self, at: UVec3) -> usize {
        ((at.z * (self.cells.y + 1) + at.y) * (self.cells.x + 1) + at.x) as usize
    }

    pub(super) fn position(&self, at: UVec3) -> Vec3 {
        self.low + at.as_vec3() * self.cell
    }

    /// The distances at a cell's eight corners, x fastest.
    pub(super) fn corners_of(&self, cell: UVec3) -> [f32; 8] {
        let first = self.corner(cell);
        let (row, layer) = (self.cells.x as usize + 1, self.corner(UVec3::Z));
        [0, 1, row, row + 1, layer, layer + 1, layer + row, layer + row + 1]
            .map(|k| self.distances[first + k])
    }

    pub(super) fn cell_index(&self, cell: UVec3) -> usize {
        ((cell.z * self.cells.y + cell.y) * self.cells.x + cell.x) as usize
    }

    /// The cells in the order of their indices.
    fn each_cell(&self) -> impl Iterator<Item = UVec3> + use<> {
        let n = self.cells;
        (0..n.z).flat_map(move |z| (0..n.y).flat_map(move |y| (0..n.x).map(move |x| UVec3::new(x, y, z))))
    }

    /// Exact distances at the corners.
    fn new(exact: &Exact, low: Vec3, high: Vec3, cell: f32) -> Self {
        let cells = ((high - low) / cell).ceil().as_uvec3().max(UVec3::ONE);
        let mut lattice = Self { low, cell, cells, distances: Vec::new() };
        let row = cells.x as usize + 1;
        let mut points = vec![Known::default(); row * (cells.y as usize + 1) * (cells.z as usize + 1)];
        points.par_chunks_exact_mut(row).enumerate().for_each(|(i, points)| {
            let (y, z) = (i as u32 % (cells.y + 1), i as u32 / (cells.y + 1));
            let mut guess = None;
            for (point, x) in points.iter_mut().zip(0..) {
                let at = lattice.position(UVec3::new(x, y, z));
                let hit = exact.tree.closest(at, guess);
                guess = hit.map(|hit| hit.triangle);
                *point = Known { at, distance: hit.map_or(f32::MAX, |hit| hit.distance_squared.sqrt()) };
            }
        });
        lattice.sign(exact, &mut points);
        lattice.distances = points.iter().map(|point| point.distance).collect();
        lattice
    }

    /// Signs the distances at the corners: one winding number for all corners that a closed surface cannot part.
    fn sign(&self, exact: &Exact, points: &mut [Known]) {
        if !exact.closed {
            points.par_iter_mut().with_min_len(256).for_each(|point| {
                point.distance = point.distance.copysign(if exact.inside(point.at) { -1.0 } else { 1.0 });
            });
            return;
        }
        let strides = [1, self.corner(UVec3::Y), self.corner(UVec3::Z)];
        let mut signed = vec![false; points.len()];
        let mut waiting = Vec::new();
        for first in 0..points.len() {
            if signed[first] {
                continue;
            }
            let sign = if exact.inside(points[first].at) { -1.0 } else { 1.0 };
            signed[first] = true;
            waiting.push(first);
            while let Some(i) = waiting.pop() {
                points[i].distance = points[i].distance.copysign(sign);
                for stride in strides {
                    // A step over the end of a row lands far away, where the test by places still holds.
                    for next in [i.checked_sub(stride), Some(i + stride)].into_iter().flatten() {
                        if next < points.len() && !signed[next] && on_one_side(&points[i], &points[next]) {
                            signed[next] = true;
                            waiting.push(next);
                        }
                    }
                }
            }
        }
    }

    /// The number of each cell that lies near the surface, [`WHOLE`] for the others, and the cells by number.
    fn near(&self) -> (Vec<u32>, Vec<UVec3>) {
        let mut numbers = vec![WHOLE; self.cells.as_usizevec3().element_product()];
        let mut near = Vec::new();
        for (number, cell) in numbers.iter_mut().zip(self.each_cell()) {
            let corners = self.corners_of(cell);
            if corners.iter().any(|d| d.abs() < NEAR * self.cell) {
                *number = near.len() as u32;
                near.push(cell);
            }
        }
        (numbers, near)
    }
}

/// Distances by interpolation: some ten nanoseconds each.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    lattice: Lattice,
    inverse_cell: f32,
    /// Number of each cell's brick, or [`WHOLE`].
    numbers: Vec<u32>,
    bricks: Vec<Brick>,
}

impl Grid {
    /// Measures between two corners of a box, whose sides are positive.
    pub(super) fn new(exact: &Exact, low: Vec3, high: Vec3) -> Self {
        let size = high - low;
        let mut cell = (size.max_element() / ALONG).max((size.element_product() / MOST_CELLS).cbrt());
        loop {
            let lattice = Lattice::new(exact, low, high, cell);
            let (numbers, near) = lattice.near();
            if near.len() <= MOST_BRICKS {
                let bricks = make_bricks(exact, &lattice, &numbers, &near);
                return Self { lattice, inverse_cell: cell.recip(), numbers, bricks };
            }
            cell *= 1.4;
        }
    }

    /// Distance and normal within the grid.
    pub(super) fn sample(&self, p: Vec3) -> Option<(f32, Vec3)> {
        let lattice = &self.lattice;
        let at = (p - lattice.low) * self.inverse_cell;
        let size = lattice.cells.as_vec3();
        // Not a number is not within.
        if !(at.cmpge(Vec3::ZERO) & at.cmplt(size)).all() {
            return None;
        }
        let cell = at.as_uvec3();
        let within = at - cell.as_vec3();
        let number = self.numbers[lattice.cell_index(cell)];
        let (distance, slope) = if number == WHOLE {
            interpolate(&lattice.corners_of(cell), within)
        } else {
            let at = within * CELLS as f32;
            let fine = at.as_uvec3().min(UVec3::splat(CELLS as u32 - 1));
            interpolate(&self.bricks[number as usize].corners_of(fine), at - fine.as_vec3())
        };
        Some((distance, slope.normalize_or(Vec3::Y)))
    }

    /// Bytes that it holds.
    #[cfg(test)]
    pub(super) fn bytes(&self) -> usize {
        self.lattice.distances.len() * 4 + self.numbers.len() * 4 + self.bricks.len() * size_of::<Brick>()
    }
}

/// Trilinear interpolation between the corners of a cell, x fastest, and its slope in units of the cell.
pub(crate) fn interpolate(c: &[f32; 8], Vec3 { x, y, z }: Vec3) -> (f32, Vec3) {
    let along_x = [c[1] - c[0], c[3] - c[2], c[5] - c[4], c[7] - c[6]];
    let edge = [0, 1, 2, 3].map(|k| c[2 * k] + along_x[k] * x);
    let along_y = [edge[1] - edge[0], edge[3] - edge[2]];
    let face = [edge[0] + along_y[0] * y, edge[2] + along_y[1] * y];
    let along_z = face[1] - face[0];
    let slope_x = [0, 1].map(|k| along_x[2 * k] + (along_x[2 * k + 1] - along_x[2 * k]) * y);
    let slope = Vec3::new(
        slope_x[0] + (slope_x[1] - slope_x[0]) * z,
        along_y[0] + (along_y[1] - along_y[0]) * z,
        along_z,
    );
    (face[0] + along_z * z, slope)
}
