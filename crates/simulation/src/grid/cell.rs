//! The contents of a cell of the density grid, and the cells that one task fills.

// `unsafe` converts floats that are known to fit to integers.
#![allow(unsafe_code)]

use rayon::prelude::*;

use super::{Counting, SIDES};
use crate::lanes::greater;

/// Numbers per cell: mass, momentum along each axis, sums of directions, padding to a cache line, and three
/// that are not sums over hair.
pub(super) const NUMBERS: usize = 16;

/// The number of sums.
pub(super) const PARTS: usize = 10;

/// Index of the bits of the inverse rest density by the first [`Counting`]; that by the second follows.
const INV_REST: usize = NUMBERS - 2;

/// Index of the bits of the excess, valid after counting.
const EXCESS: usize = NUMBERS - 3;

/// The contents of a cell, in fixed point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(align(64))]
pub(super) struct Cell(pub(super) [i32; NUMBERS]);

impl Cell {
    pub(super) const EMPTY: Self = Self([0; NUMBERS]);

    #[inline(always)]
    pub(super) fn mass(&self) -> i32 {
        self.0[0]
    }

    /// Inverse of the rest density, or of a typical one where there is no hair at rest.
    #[inline(always)]
    pub(super) fn inv_rest(&self, counting: Counting) -> f32 {
        f32::from_bits(self.0[INV_REST + counting as usize] as u32)
    }

    pub(super) fn set_inv_rest(&mut self, counting: Counting, inv: f32) {
        self.0[INV_REST + counting as usize] = inv.to_bits() as i32;
    }

    /// Computes and stores the excess: how much denser the cell is than its threshold, relative to the
    /// threshold; 0 below it.
    #[inline(always)]
    fn update_excess(&mut self, counting: Counting, inv_threshold: f32) -> f32 {
        let excess = greater(0.0, self.mass() as f32 * self.inv_rest(counting) * inv_threshold - 1.0);
        self.0[EXCESS] = excess.to_bits() as i32;
        excess
    }

    /// The excess stored by [`Cells::gather`]; 0 if nothing has been counted since the cell was cleared.
    #[inline(always)]
    pub(super) fn excess(&self) -> f32 {
        f32::from_bits(self.0[EXCESS] as u32)
    }

    /// Adds `weight` times `parts` to the contents, which `mask` keeps or clears.
    ///
    /// # Safety
    ///
    /// The products must be numbers that fit an `i32`.
    #[inline(always)]
    pub(super) unsafe fn add(&mut self, mask: KeepMask, weight: f32, parts: &[f32; NUMBERS]) {
        let mut sum = *self;
        for (sum, part) in sum.0.iter_mut().zip(parts).take(PARTS) {
            // SAFETY: guaranteed by the caller.
            *sum = (*sum & mask.0).wrapping_add(unsafe { (weight * part).to_int_unchecked() });
        }
        *self = sum;
    }

    /// Adds the same cell of another grid to the contents, which `mask` keeps or clears.
    fn plus(&mut self, mask: KeepMask, other: &Self) {
        for (sum, part) in self.0.iter_mut().zip(&other.0).take(PARTS) {
            *sum = (*sum & mask.0).wrapping_add(*part);
        }
    }

    fn clear(&mut self) {
        self.0[..INV_REST].fill(0);
    }
}

/// A mask over the contents of a cell: all bits set if the cell already holds hair of this deposit, none if
/// its contents are left over from an earlier one.
#[derive(Clone, Copy, Debug)]
pub(super) struct KeepMask(i32);

impl KeepMask {
    /// From bit `x` of the cell's row.
    #[inline(always)]
    fn of(mask: u64, x: usize) -> Self {
        Self(-((mask >> x & 1) as i32))
    }
}

/// Number of cells that one task counts.
const CHUNK: usize = 8 * ROW * ROWS_PER_LAYER;

/// Cells per row along x.
const ROW: usize = SIDES.x as usize;

/// Rows per layer along z.
const ROWS_PER_LAYER: usize = SIDES.y as usize;

/// Rows of the grid.
const ROWS: usize = ROWS_PER_LAYER * SIDES.z as usize;

const _: () = assert!(ROW <= 64, "a row has a bit for each of its cells");

/// A whole grid of cells: x fastest, then y.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    pub(super) each: Vec<Cell>,
    /// One bit per cell of each row along x: set if the cell may hold hair. Other cells hold outdated
    /// contents, which [`Cells::gather`] clears in the grid that it sums into.
    masks: Vec<u64>,
    /// The masks of the previous deposit.
    before: Vec<u64>,
}

/// Counts over cells.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Counts {
    /// Cells that may hold hair.
    pub(super) held: u32,
    pub(super) over_dense: u32,
    /// Sum of the masses, each clamped to the mass of a full cell.
    pub(super) fullness: i64,
}

impl Counts {
    pub(super) fn plus(self, other: Self) -> Self {
        Self {
            held: self.held + other.held,
            over_dense: self.over_dense + other.over_dense,
            fullness: self.fullness + other.fullness,
        }
    }
}

impl Cells {
    pub(super) fn new() -> Self {
        Self { each: vec![Cell::EMPTY; ROW * ROWS], masks: vec![0; ROWS], before: vec![0; ROWS] }
    }

    /// Starts a deposit: marks all cells as empty. Outdated contents stay until hair is added or everything
    /// is gathered.
    pub(super) fn begin(&mut self) {
        std::mem::swap(&mut self.masks, &mut self.before);
        self.masks.fill(0);
    }

    /// Marks the eight cells whose first is at `base` as holding hair, and returns masks of which did so
    /// before, in the order of [`super::OFFSETS`].
    #[inline(always)]
    pub(super) fn mark(&mut self, base: usize) -> [KeepMask; 8] {
        let (row, x) = (base / ROW, base % ROW);
        let mut held = [KeepMask(0); 8];
        let next = row + ROWS_PER_LAYER;
        for (pair, row) in held.as_chunks_mut::<2>().0.iter_mut().zip([row, row + 1, next, next + 1]) {
            *pair = [KeepMask::of(self.masks[row], x), KeepMask::of(self.masks[row], x + 1)];
            self.masks[row] |= 0b11 << x;
        }
        held
    }

    /// Adds the contents of `others`, clears cells that have become empty, counts, and stores the excess in
    /// each cell. `most` is the mass of a full cell; a cell is over-dense above `1 / inv_threshold` times its
    /// rest density by `counting`.
    pub(super) fn gather(
        &mut self,
        others: &[Self],
        counting: Counting,
        most: i32,
        inv_threshold: f32,
    ) -> Counts {
        let before = &self.before;
        let chunks = self.each.par_chunks_mut(CHUNK).zip(self.masks.par_chunks_mut(CHUNK / ROW)).enumerate();
        let counts = |(n, (cells, masks)): (usize, (&mut [Cell], &mut [u64]))| {
            let mut out = Counts::default();
            let rows = masks.iter_mut().zip(cells.as_chunks_mut::<ROW>().0);
            for (row, (mask, cells)) in (n * CHUNK / ROW..).zip(rows) {
                for other in others {
                    for x in bits(other.masks[row]) {
                        cells[x].plus(KeepMask::of(*mask, x), &other.each[row * ROW + x]);
                    }
                    *mask |= other.masks[row];
                }
                for x in bits(before[row] & !*mask) {
                    cells[x].clear();
                }
                out.held += mask.count_ones();
                for x in bits(*mask) {
                    let cell = &mut cells[x];
                    out.over_dense += u32::from(cell.update_excess(counting, inv_threshold) > 0.0);
                    out.fullness += i64::from(cell.mass().min(most));
                }
            }
            out
        };
        chunks.map(counts).reduce(Counts::default, Counts::plus)
    }
}

/// The indices of the set bits, lowest first.
fn bits(mut mask: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let place = mask.trailing_zeros();
        mask &= mask.wrapping_sub(1);
        (place < u64::BITS).then_some(place as usize)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_are_found_from_the_lowest() {
        assert_eq!(bits(0).count(), 0);
        assert_eq!(bits(1 | 1 << 5 | 1 << 63).collect::<Vec<_>>(), [0, 5, 63]);
    }

    #[test]
    fn parts_of_a_grid_add_up_and_drop_outdated_contents() {
        let at = |n: usize| (3 * n * ROWS_PER_LAYER + 5) * ROW + 7;
        let mut parts = [Cells::new(), Cells::new(), Cells::new()];
        // The deposits of each round as (part, cell, mass): cells that move from part to part, that parts
        // share, that stay, and that receive nothing any more.
        let times: [&[(usize, usize, f32)]; 3] = [
            &[(0, 1, 3.0), (1, 2, 5.0), (2, 2, 7.0), (0, 3, 11.0), (1, 4, 13.0)],
            &[(2, 1, 17.0), (0, 2, 19.0), (0, 3, 23.0), (0, 3, 29.0)],
            &[(1, 1, 31.0), (2, 4, 37.0), (0, 4, 41.0)],
        ];
        for puts in times {
            parts.iter_mut().for_each(Cells::begin);
            for &(part, cell, mass) in puts {
                let held = parts[part].mark(at(cell));
                let numbers: [f32; NUMBERS] = std::array::from_fn(|n| n.max(1) as f32);
                // SAFETY: small numbers.
                unsafe { parts[part].each[at(cell)].add(held[0], mass, &numbers) };
            }
            let (all, others) = parts.split_first_mut().expect("three");
            all.each.iter_mut().for_each(|cell| cell.set_inv_rest(Counting::Nearest, 0.1));
            let counts = all.gather(others, Counting::Nearest, i32::MAX, 1.0);
            let sum = |cell: usize| puts.iter().filter(|put| put.1 == cell).map(|put| put.2).sum::<f32>();
            for cell in 0..6 {
                let (found, mass) = (&all.each[at(cell)], sum(cell));
                assert_eq!((found.mass(), found.0[9]), (mass as i32, 9 * mass as i32), "cell {cell}");
                assert_eq!(found.excess(), greater(0.0, mass * 0.1 - 1.0), "cell {cell}");
            }
            assert_eq!(counts.fullness, puts.iter().map(|put| put.2 as i64).sum::<i64>());
        }
    }

    #[test]
    fn a_cleared_cell_keeps_its_rest_density() {
        let mut cell = Cell([7; NUMBERS]);
        cell.set_inv_rest(Counting::Shared, 0.25);
        cell.set_inv_rest(Counting::Nearest, 0.5);
        assert_eq!((cell.update_excess(Counting::Nearest, 1.0), cell.excess()), (2.5, 2.5));
        assert_eq!((cell.update_excess(Counting::Shared, 1.0), cell.excess()), (0.75, 0.75));
        cell.clear();
        let rest = [Counting::Shared, Counting::Nearest].map(|counting| cell.inv_rest(counting));
        assert_eq!((cell.mass(), rest, cell.excess()), (0, [0.25, 0.5], 0.0));
    }
}
