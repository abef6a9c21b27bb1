//! The grid of cells in head space in which the body is marked.

use glam::{IVec3, UVec3, Vec3};

/// Largest number of cells to each side over which a probe is spread.
pub(super) const WIDEST: i32 = 4;
/// Additional cells to each side that are tested when culling is off.
pub(super) const UNCULLED_WIDTH: i32 = 3;
/// No skin other than the head's.
pub(super) const NONE: u32 = u32::MAX;

/// A grid of cells in head space.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellGrid {
    pub(super) low: Vec3,
    pub(super) cell: f32,
    pub(super) inv_cell: f32,
    pub(super) size: UVec3,
}

impl CellGrid {
    pub(super) fn count(&self) -> usize {
        self.size.as_usizevec3().element_product()
    }

    /// The first and the last cell within `width` of `middle`, clipped to the grid.
    pub(super) fn around(&self, middle: IVec3, width: i32) -> (IVec3, IVec3) {
        ((middle - width).max(IVec3::ZERO), (middle + width).min(self.size.as_ivec3() - 1))
    }

    /// Index of the first cell of a row along x.
    pub(super) fn row(&self, y: i32, z: i32) -> usize {
        ((z * self.size.y as i32 + y) * self.size.x as i32) as usize
    }
}

/// Marks the cells within `width` of the cells that contain `places`.
pub(super) fn mark(cells: &mut [bool], grid: &CellGrid, places: &[Vec3], width: i32) {
    for place in places {
        let middle = ((*place - grid.low) * grid.inv_cell).floor().as_ivec3();
        let (from, to) = grid.around(middle, width);
        if from.cmpgt(to).any() {
            continue;
        }
        for z in from.z..=to.z {
            for y in from.y..=to.y {
                let row = grid.row(y, z);
                cells[row + from.x as usize..=row + to.x as usize].fill(true);
            }
        }
    }
}
