//! Coarse cells with distances at their corners.

use glam::{UVec3, Vec3};
use rayon::prelude::*;

use super::{
    Exact,
    signs::{MeasuredPoint, on_same_side},
};

/// Cells with a corner closer to the surface than this are divided, in cell sizes.
const DIVIDE_WITHIN: f32 = 1.2;
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

    /// The distances at the eight corners of a cell, x fastest.
    pub(super) fn corners_of(&self, cell: UVec3) -> [f32; 8] {
        let first = self.corner(cell);
        let (row, layer) = (self.cells.x as usize + 1, self.corner(UVec3::Z));
        [0, 1, row, row + 1, layer, layer + 1, layer + row, layer + row + 1]
            .map(|k| self.distances[first + k])
    }

    pub(super) fn cell_index(&self, cell: UVec3) -> usize {
        ((cell.z * self.cells.y + cell.y) * self.cells.x + cell.x) as usize
    }

    /// The cells in index order.
    fn each_cell(&self) -> impl Iterator<Item = UVec3> + use<> {
        let n = self.cells;
        (0..n.z).flat_map(move |z| (0..n.y).flat_map(move |y| (0..n.x).map(move |x| UVec3::new(x, y, z))))
    }

    /// Measures exact distances at the corners.
    pub(super) fn new(exact: &Exact, low: Vec3, high: Vec3, cell: f32) -> Self {
        let cells = ((high - low) / cell).ceil().as_uvec3().max(UVec3::ONE);
        let mut lattice = Self { low, cell, cells, distances: Vec::new() };
        let row = cells.x as usize + 1;
        let mut points =
            vec![MeasuredPoint::default(); row * (cells.y as usize + 1) * (cells.z as usize + 1)];
        points.par_chunks_exact_mut(row).enumerate().for_each(|(i, points)| {
            let (y, z) = (i as u32 % (cells.y + 1), i as u32 / (cells.y + 1));
            let mut guess = None;
            for (point, x) in points.iter_mut().zip(0..) {
                let at = lattice.position(UVec3::new(x, y, z));
                let hit = exact.tree.closest(at, guess);
                guess = hit.map(|hit| hit.triangle);
                *point =
                    MeasuredPoint { at, distance: hit.map_or(f32::MAX, |hit| hit.distance_squared.sqrt()) };
            }
        });
        lattice.sign(exact, &mut points);
        lattice.distances = points.iter().map(|point| point.distance).collect();
        lattice
    }

    /// Determines the signs at the corners: one winding number for each set of corners that a closed surface
    /// cannot separate.
    fn sign(&self, exact: &Exact, points: &mut [MeasuredPoint]) {
        if !exact.closed {
            points.par_iter_mut().with_min_len(256).for_each(|point| {
                point.distance = point.distance.copysign(if exact.inside(point.at) { -1.0 } else { 1.0 });
            });
            return;
        }
        let strides = [1, self.corner(UVec3::Y), self.corner(UVec3::Z)];
        let mut signed = vec![false; points.len()];
        let mut stack = Vec::new();
        for first in 0..points.len() {
            if signed[first] {
                continue;
            }
            let sign = if exact.inside(points[first].at) { -1.0 } else { 1.0 };
            signed[first] = true;
            stack.push(first);
            while let Some(i) = stack.pop() {
                points[i].distance = points[i].distance.copysign(sign);
                for stride in strides {
                    // A step over the end of a row leads far away, where the test by distance is still valid.
                    for next in [i.checked_sub(stride), Some(i + stride)].into_iter().flatten() {
                        if next < points.len() && !signed[next] && on_same_side(&points[i], &points[next]) {
                            signed[next] = true;
                            stack.push(next);
                        }
                    }
                }
            }
        }
    }

    /// The index of each cell near the surface ([`WHOLE`] for the others), and those cells in order.
    pub(super) fn near(&self) -> (Vec<u32>, Vec<UVec3>) {
        let mut numbers = vec![WHOLE; self.cells.as_usizevec3().element_product()];
        let mut near = Vec::new();
        for (number, cell) in numbers.iter_mut().zip(self.each_cell()) {
            let corners = self.corners_of(cell);
            if corners.iter().any(|d| d.abs() < DIVIDE_WITHIN * self.cell) {
                *number = near.len() as u32;
                near.push(cell);
            }
        }
        (numbers, near)
    }
}

/// Trilinear interpolation between the corners of a cell, x fastest, and its gradient per cell size.
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
