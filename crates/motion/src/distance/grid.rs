//! Distances on a grid of coarse cells, with finer ones near the surface.

use glam::{UVec3, Vec3};

use super::{
    Exact,
    bricks::{Brick, CELLS, make_bricks},
    lattice::{Lattice, WHOLE, interpolate},
};

/// Largest number of coarse cells, and their number along the longest side: 20 mm for the reach of hair.
const MAX_CELLS: f32 = 60_000.0;
const CELLS_ALONG: f32 = 85.0;
/// Largest number of divided cells, 500 bytes each; surfaces that fill their volume get larger cells.
const MAX_BRICKS: usize = 40_000;

/// Interpolated distances: about ten nanoseconds per query.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    lattice: Lattice,
    inverse_cell: f32,
    /// Index of each cell's brick, or [`WHOLE`].
    numbers: Vec<u32>,
    bricks: Vec<Brick>,
}

impl Grid {
    /// Measures the box from `low` to `high`, which must not be empty.
    pub(super) fn new(exact: &Exact, low: Vec3, high: Vec3) -> Self {
        let size = high - low;
        let mut cell = (size.max_element() / CELLS_ALONG).max((size.element_product() / MAX_CELLS).cbrt());
        loop {
            let lattice = Lattice::new(exact, low, high, cell);
            let (numbers, near) = lattice.near();
            if near.len() <= MAX_BRICKS {
                let bricks = make_bricks(exact, &lattice, &numbers, &near);
                return Self { lattice, inverse_cell: cell.recip(), numbers, bricks };
            }
            cell *= 1.4;
        }
    }

    /// Distance and normal inside the grid.
    pub(super) fn sample(&self, p: Vec3) -> Option<(f32, Vec3)> {
        let lattice = &self.lattice;
        let at = (p - lattice.low) * self.inverse_cell;
        let size = lattice.cells.as_vec3();
        // NaN is outside.
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

    /// Memory used, bytes.
    #[cfg(test)]
    pub(super) fn bytes(&self) -> usize {
        self.lattice.distances.len() * 4 + self.numbers.len() * 4 + self.bricks.len() * size_of::<Brick>()
    }
}
