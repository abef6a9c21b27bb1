//! The grid of cells in head space in which the body is looked up.

use glam::{IVec3, UVec3, Vec3};

/// Most cells to each side that a place is deposited into.
pub(super) const WIDEST: i32 = 4;
/// Where nothing is tested for sparing's sake, so many cells more to each side are tested.
pub(super) const UNSPARING: i32 = 3;
/// No skin but the head's.
pub(super) const NONE: u32 = u32::MAX;

/// A grid of cells in head space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    pub(super) low: Vec3,
    pub(super) cell: f32,
    pub(super) inv_cell: f32,
    pub(super) size: UVec3,
}

impl Grid {
    pub(super) fn count(&self) -> usize {
        self.size.as_usizevec3().element_product()
    }

    /// The cells within `width` of one, as far as there are any: the first and the last.
    pub(super) fn around(&self, middle: IVec3, width: i32) -> (IVec3, IVec3) {
        ((middle - width).max(IVec3::ZERO), (middle + width).min(self.size.as_ivec3() - 1))
    }

    /// Index of the first cell of a row along x.
    pub(super) fn row(&self, y: i32, z: i32) -> usize {
        ((z * self.size.y as i32 + y) * self.size.x as i32) as usize
    }
}

/// Marks the cells within `width` of those that the places are in.
pub(super) fn mark(cells: &mut [bool], grid: &Grid, places: &[Vec3], width: i32) {
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
