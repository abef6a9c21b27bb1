//! The grid of density of one worker, and which of its cells are in use.

use super::layout::Layout;

/// Optical depth 1 in the fixed-point format of cells. Sums of integers do not depend on their order.
pub(super) const DEPTH_ONE: f32 = (1 << 20) as f32;

/// Density per cell; 0 outside the groups in use.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    pub cells: Vec<u32>,
    /// One byte per group of slices of a tile: 1 if the group received a deposit. Unlike a bit, a byte is stored without a
    /// load; [`Grid::take_marks`] turns bytes into bits.
    pub marks: Vec<u8>,
    /// One number per tile with one bit per group: groups that may contain non-zero cells.
    pub used: Vec<u64>,
}

impl Grid {
    pub(super) fn new(layout: &Layout) -> Self {
        // The operating system maps zeroed memory page by page, at the first use.
        Self {
            cells: vec![0; layout.cells()],
            marks: vec![0; layout.tiles() * layout.groups()],
            used: vec![0; layout.tiles()],
        }
    }

    /// Clears the grid.
    pub(super) fn clear(&mut self, layout: &Layout) {
        for (tile, used) in self.cells.chunks_exact_mut(layout.tile_len()).zip(&mut self.used) {
            for group in bits(std::mem::take(used)) {
                tile[layout.group_cells(group)].fill(0);
            }
        }
    }

    /// Moves the marks of a deposit to `used`.
    pub(super) fn take_marks(&mut self, layout: &Layout) {
        let words = self.marks.chunks_exact_mut(layout.groups()).zip(&mut self.used);
        for (marks, used) in words {
            *used = 0;
            for (at, eight) in marks.as_chunks_mut::<8>().0.iter_mut().enumerate() {
                // The product moves the lowest bit of byte b to bit 56 + b.
                let packed = u64::from_le_bytes(*eight).wrapping_mul(0x0102_0408_1020_4080) >> 56;
                *used |= packed << (8 * at);
                *eight = [0; 8];
            }
        }
    }
}

/// The positions of the bits that are set, lowest first.
pub(super) fn bits(mut word: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let at = word.trailing_zeros();
        word &= word.wrapping_sub(1);
        (at < 64).then_some(at as usize)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_become_bits_and_clearing_forgets_them() {
        for resolution in [16, 32, 128, 256, 512] {
            let layout = Layout::new(resolution);
            let mut grid = Grid::new(&layout);
            let slices = [0, 9, 17.min(resolution - 1), resolution - 1];
            for i in slices {
                let at = layout.address(i, 2, 13) as usize;
                grid.cells[at] = 5;
                grid.marks[at >> layout.group_len_shift()] = 1;
            }
            grid.take_marks(&layout);
            let expected = slices.iter().fold(0, |bits, i| bits | 1_u64 << (i >> layout.group_shift));
            let marked = layout.tile(2, 13) as usize;
            assert_eq!(grid.used[marked], expected);
            assert!(grid.used.iter().enumerate().all(|(tile, used)| tile == marked || *used == 0));
            assert!(grid.marks.iter().all(|mark| *mark == 0));
            grid.clear(&layout);
            assert!(grid.used.iter().all(|used| *used == 0));
            assert!(slices.iter().all(|i| grid.cells[layout.address(*i, 2, 13) as usize] == 0));
        }
    }

    #[test]
    fn bits_come_in_order() {
        assert_eq!(bits(1 | 1 << 5 | 1 << 63).collect::<Vec<_>>(), [0, 5, 63]);
        assert_eq!(bits(0).count(), 0);
        assert_eq!(bits(u64::MAX).count(), 64);
    }
}
