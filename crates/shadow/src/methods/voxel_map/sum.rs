//! The sum of optical depth along the light, in place.
//!
//! A cell becomes two 16-bit numbers in steps of 1/4096: optical depth at its front face in the low half, at its back face in
//! the high half. One load then provides everything that interpolation along the light needs.

// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, clippy::needless_range_loop, unsafe_code)]

use lovelock_base::simd::Width;
use lovelock_base::simd_versions;
use rayon::prelude::*;

use super::grid::{Grid, bits};
use super::layout::{Layout, TILE_CELLS};

/// The value at which sums saturate: above 16 in fixed point, the largest depth that a cell can hold, and far from overflow.
const MAX: u32 = 1 << 25;
/// Shift from the fixed-point format of density (2^20) to that of faces (2^12).
const FACE_SHIFT: u32 = 8;

/// The groups that contain hair in any of the grids, per tile.
pub(super) fn touched(grids: &[Grid], touched: &mut Vec<u64>) {
    touched.clear();
    if let Some((first, others)) = grids.split_first() {
        touched.extend_from_slice(&first.used);
        for other in others {
            touched.iter_mut().zip(&other.used).for_each(|(touched, used)| *touched |= used);
        }
    }
}

/// The groups of `tile` to fill: those that contain hair in it or in a tile around it, because a point reads the columns next
/// to its own.
pub(super) fn dilated(layout: &Layout, touched: &[u64], tile: usize) -> u64 {
    let edge = layout.tiles_per_edge as usize;
    let (j, k) = (tile / edge, tile % edge);
    let rows = j.saturating_sub(1)..=(j + 1).min(edge - 1);
    let columns = k.saturating_sub(1)..=(k + 1).min(edge - 1);
    rows.flat_map(|row| &touched[row * edge + columns.start()..=row * edge + columns.end()])
        .fold(0, |groups, more| groups | more)
}

/// Adds all grids to the first one and sums along the light, in the groups that hair may read. These become the groups in use
/// of the first grid.
pub(super) fn sum_along_light(width: Width, layout: &Layout, grids: &mut [Grid], touched: &[u64]) {
    let Some((target, others)) = grids.split_first_mut() else { return };
    let tiles = target.cells.par_chunks_exact_mut(layout.tile_len()).zip(&mut target.used);
    tiles.enumerate().with_min_len(64).for_each(|(tile, (cells, used))| {
        *used = dilated(layout, touched, tile);
        if *used != 0 {
            sum_tile_simd(width, layout, tile, *used, cells, others);
        }
    });
}

simd_versions! {
    /// [`sum_tile`] for the vectors of `width`.
    fn sum_tile_simd(layout: &Layout, tile: usize, used: u64, cells: &mut [u32], others: &[Grid]) -> () {
        sum_tile(layout, tile, used, cells, others)
    }
}

/// Adds the cells of `tile` of the `others` to `cells`, then sums the groups in `used` along the light.
#[inline(always)]
fn sum_tile(layout: &Layout, tile: usize, used: u64, cells: &mut [u32], others: &[Grid]) {
    let mut faces = Faces::default();
    for group in bits(used) {
        let cells = &mut cells[layout.group_cells(group)];
        for other in others.iter().filter(|other| (other.used[tile] >> group) & 1 != 0) {
            let from = &other.cells[tile * layout.tile_len()..][layout.group_cells(group)];
            for (into, from) in cells.iter_mut().zip(from) {
                *into = into.saturating_add(*from);
            }
        }
        for slice in cells.as_chunks_mut::<TILE_CELLS>().0 {
            faces.pass(slice);
        }
    }
}

/// The minimum, in the loops of every vector width.
#[inline(always)]
fn least(a: u32, b: u32) -> u32 {
    if a < b { a } else { b }
}

/// The running sums of the columns of a tile.
struct Faces {
    sum: [u32; TILE_CELLS],
    front: [u32; TILE_CELLS],
}

impl Default for Faces {
    fn default() -> Self {
        Self { sum: [0; TILE_CELLS], front: [0; TILE_CELLS] }
    }
}

impl Faces {
    /// Adds one slice of density and replaces it by its faces.
    #[inline(always)]
    fn pass(&mut self, slice: &mut [u32; TILE_CELLS]) {
        // Copies, because the compiler cannot prove that the arrays do not overlap. Two numbers up to MAX fit; a check for overflow would be
        // a branch.
        let (mut cells, mut sums, mut fronts) = (*slice, self.sum, self.front);
        for lane in 0..TILE_CELLS {
            let sum = least(sums[lane].wrapping_add(least(cells[lane], MAX)), MAX);
            let back = least(sum.wrapping_add(1 << (FACE_SHIFT - 1)) >> FACE_SHIFT, 0xffff);
            cells[lane] = fronts[lane] | back << 16;
            (sums[lane], fronts[lane]) = (sum, back);
        }
        (*slice, self.sum, self.front) = (cells, sums, fronts);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_holds_the_depth_before_and_behind_it() {
        let mut faces = Faces::default();
        let mut slices = [[0_u32; TILE_CELLS]; 4];
        slices[1][5] = 3 << 20;
        slices[2][5] = 1 << 19;
        for slice in &mut slices {
            faces.pass(slice);
        }
        let at = |slice: usize| (slices[slice][5] & 0xffff, slices[slice][5] >> 16);
        assert_eq!([at(0), at(1), at(2)], [(0, 0), (0, 3 * 4096), (3 * 4096, 3 * 4096 + 2048)]);
        assert_eq!(at(3), (3 * 4096 + 2048, 3 * 4096 + 2048), "an empty cell keeps the running value");
        assert!(slices.iter().all(|slice| slice[6] == 0));
    }

    #[test]
    fn full_cells_saturate() {
        let mut faces = Faces::default();
        for _ in 0..600 {
            let mut slice = [u32::MAX; TILE_CELLS];
            faces.pass(&mut slice);
            assert_eq!(slice[0] >> 16, 0xffff);
        }
    }

    #[test]
    fn dilation_reaches_all_eight_neighbours() {
        let layout = Layout::new(32);
        let mut touched = vec![0; layout.tiles()];
        touched[3 * 8 + 4] = 0b0100;
        touched[3 * 8 + 6] = 0b1000;
        for j in 0..8_usize {
            for k in 0..8_usize {
                let near = |tile: usize| u64::from(j.abs_diff(3) <= 1 && k.abs_diff(tile) <= 1);
                let expected = (near(4) * 0b0100) | (near(6) * 0b1000);
                assert_eq!(dilated(&layout, &touched, j * 8 + k), expected, "tile {j}, {k}");
            }
        }
    }
}
