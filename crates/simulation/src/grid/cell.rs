//! What lies in a cell of the density grid, and the cells that one task fills.

// Integers of numbers that are known to fit.
#![allow(unsafe_code)]

use rayon::prelude::*;

use super::SIDE;
use crate::lanes::greater;

/// Numbers of a cell: mass, momentum along each axis, sums of directions, what fills a line of the cache, and two that hair
/// adds nothing to.
pub(super) const NUMBERS: usize = 16;

/// Those of them that hair adds to.
pub(super) const PARTS: usize = 10;

/// Where a cell keeps the bits of one over its density at rest.
const INV_REST: usize = NUMBERS - 1;

/// Where a cell keeps the bits of its excess, once it has been counted.
const EXCESS: usize = NUMBERS - 2;

/// What lies in a cell, in fixed point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(align(64))]
pub(super) struct Cell(pub(super) [i32; NUMBERS]);

impl Cell {
    pub(super) const EMPTY: Self = Self([0; NUMBERS]);

    #[inline(always)]
    pub(super) fn mass(&self) -> i32 {
        self.0[0]
    }

    /// One over the density at rest, where there is some, and over a typical one elsewhere.
    #[inline(always)]
    pub(super) fn inv_rest(&self) -> f32 {
        f32::from_bits(self.0[INV_REST] as u32)
    }

    pub(super) fn set_inv_rest(&mut self, inv: f32) {
        self.0[INV_REST] = inv.to_bits() as i32;
    }

    /// By how much the cell is denser than `1 / inv_threshold` times what it is at rest, as a part of that; 0 where it is not.
    #[inline(always)]
    fn learn_excess(&mut self, inv_threshold: f32) -> f32 {
        let excess = greater(0.0, self.mass() as f32 * self.inv_rest() * inv_threshold - 1.0);
        self.0[EXCESS] = excess.to_bits() as i32;
        excess
    }

    /// What [`Cells::gather`] has found; 0 where nothing has been counted since the cell was emptied.
    #[inline(always)]
    pub(super) fn excess(&self) -> f32 {
        f32::from_bits(self.0[EXCESS] as u32)
    }

    /// Adds `weight` times `parts` to what [`Held`] keeps of the cell.
    ///
    /// # Safety
    ///
    /// The products are numbers that an `i32` holds.
    #[inline(always)]
    pub(super) unsafe fn add(&mut self, held: Held, weight: f32, parts: &[f32; NUMBERS]) {
        let mut sum = *self;
        for (sum, part) in sum.0.iter_mut().zip(parts).take(PARTS) {
            // SAFETY: as asked for.
            *sum = (*sum & held.0).wrapping_add(unsafe { (weight * part).to_int_unchecked() });
        }
        *self = sum;
    }

    /// Adds what another grid has of the same cell to what [`Held`] keeps of this one.
    fn plus(&mut self, held: Held, other: &Self) {
        for (sum, part) in self.0.iter_mut().zip(&other.0).take(PARTS) {
            *sum = (*sum & held.0).wrapping_add(*part);
        }
    }

    fn clear(&mut self) {
        self.0[..INV_REST].fill(0);
    }
}

/// Whether a cell holds hair of this time already: all bits are set where it does, and none where what is in it was left
/// there some earlier time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Held(i32);

impl Held {
    /// By the bit `x` of the row of the cell.
    #[inline(always)]
    fn of(mask: u64, x: usize) -> Self {
        Self(-((mask >> x & 1) as i32))
    }
}

/// Cells of as many layers as one task counts.
const CHUNK: usize = 8 * (SIDE * SIDE) as usize;

/// Cells of a row along x.
const ROW: usize = SIDE as usize;

const _: () = assert!(ROW <= 64, "a row has a bit for each of its cells");

/// A whole grid of cells: x fastest, then y.
#[derive(Clone, Debug)]
pub(super) struct Cells {
    pub(super) each: Vec<Cell>,
    /// Which cells of each row along x may hold hair, a bit each. What is in the others is old and does not count;
    /// [`Cells::gather`] empties it in the grid that it adds to.
    masks: Vec<u64>,
    /// Which did the last time.
    before: Vec<u64>,
}

/// What is counted of cells.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Tally {
    /// Cells that may hold hair.
    pub(super) held: u32,
    pub(super) over_dense: u32,
    /// Masses, none counted for more than that of a full cell.
    pub(super) fullness: i64,
}

impl Tally {
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
        Self {
            each: vec![Cell::EMPTY; ROW * ROW * ROW],
            masks: vec![0; ROW * ROW],
            before: vec![0; ROW * ROW],
        }
    }

    /// No cell holds hair any more. What was in them stays until hair is put there again or all is gathered.
    pub(super) fn begin(&mut self) {
        std::mem::swap(&mut self.masks, &mut self.before);
        self.masks.fill(0);
    }

    /// Says that the eight cells whose first is at `base` may hold hair; and which of them did, in the order of
    /// [`super::OFFSETS`].
    #[inline(always)]
    pub(super) fn mark(&mut self, base: usize) -> [Held; 8] {
        let (row, x) = (base / ROW, base % ROW);
        let mut held = [Held(0); 8];
        for (pair, row) in
            held.as_chunks_mut::<2>().0.iter_mut().zip([row, row + 1, row + ROW, row + ROW + 1])
        {
            *pair = [Held::of(self.masks[row], x), Held::of(self.masks[row], x + 1)];
            self.masks[row] |= 0b11 << x;
        }
        held
    }

    /// Adds what `others` hold, empties what holds nothing any more, counts, and leaves in each cell its excess; `most` is the
    /// mass of a full cell, and what is over-dense has more than `1 / inv_threshold` of its density at rest.
    pub(super) fn gather(&mut self, others: &[Self], most: i32, inv_threshold: f32) -> Tally {
        let before = &self.before;
        let chunks = self.each.par_chunks_mut(CHUNK).zip(self.masks.par_chunks_mut(CHUNK / ROW)).enumerate();
        let tally = |(n, (cells, masks)): (usize, (&mut [Cell], &mut [u64]))| {
            let mut out = Tally::default();
            let rows = masks.iter_mut().zip(cells.as_chunks_mut::<ROW>().0);
            for (row, (mask, cells)) in (n * CHUNK / ROW..).zip(rows) {
                for other in others {
                    for x in bits(other.masks[row]) {
                        cells[x].plus(Held::of(*mask, x), &other.each[row * ROW + x]);
                    }
                    *mask |= other.masks[row];
                }
                for x in bits(before[row] & !*mask) {
                    cells[x].clear();
                }
                out.held += mask.count_ones();
                for x in bits(*mask) {
                    let cell = &mut cells[x];
                    out.over_dense += u32::from(cell.learn_excess(inv_threshold) > 0.0);
                    out.fullness += i64::from(cell.mass().min(most));
                }
            }
            out
        };
        chunks.map(tally).reduce(Tally::default, Tally::plus)
    }
}

/// The places of the bits that are set, lowest first.
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
    fn bits_are_found_from_the_lowest_on() {
        assert_eq!(bits(0).count(), 0);
        assert_eq!(bits(1 | 1 << 5 | 1 << 63).collect::<Vec<_>>(), [0, 5, 63]);
    }

    #[test]
    fn parts_of_a_grid_add_up_and_forget_what_they_held() {
        let at = |n: usize| (3 * n * ROW + 5) * ROW + 7;
        let mut parts = [Cells::new(), Cells::new(), Cells::new()];
        // Which part puts how much into which cell, time after time: cells that go from part to part, that parts share, that
        // stay, and that nothing is put into any more.
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
            all.each.iter_mut().for_each(|cell| cell.set_inv_rest(0.1));
            let tally = all.gather(others, i32::MAX, 1.0);
            let sum = |cell: usize| puts.iter().filter(|put| put.1 == cell).map(|put| put.2).sum::<f32>();
            for cell in 0..6 {
                let (found, mass) = (&all.each[at(cell)], sum(cell));
                assert_eq!((found.mass(), found.0[9]), (mass as i32, 9 * mass as i32), "cell {cell}");
                assert_eq!(found.excess(), greater(0.0, mass * 0.1 - 1.0), "cell {cell}");
            }
            assert_eq!(tally.fullness, puts.iter().map(|put| put.2 as i64).sum::<i64>());
        }
    }

    #[test]
    fn a_cell_that_is_cleared_still_knows_its_density_at_rest() {
        let mut cell = Cell([7; NUMBERS]);
        cell.set_inv_rest(0.25);
        assert_eq!((cell.learn_excess(1.0), cell.excess()), (0.75, 0.75));
        cell.clear();
        assert_eq!((cell.mass(), cell.inv_rest(), cell.excess()), (0, 0.25, 0.0));
    }
}
