//! One worker's grid of density, and which of its cells are in use.

use super::layout::{Layout, TILE_CELLS};

/// One optical depth in the fixed point of cells: sums of integers do not depend on their order.
pub(super) const DEPTH_ONE: f32 = (1 << 20) as f32;

/// A run of slices of a tile, in slices; `last < first` where there is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Span {
    pub first: i16,
    pub last: i16,
}

impl Span {
    pub(super) const EMPTY: Self = Self {
        first: i16::MAX,
        last: -1,
    };

    pub(super) fn is_empty(self) -> bool {
        self.last < self.first
    }

    pub(super) fn join(self, other: Self) -> Self {
        Self {
            first: self.first.min(other.first),
            last: self.last.max(other.last),
        }
    }

    /// The cells of this run within a tile.
    pub(super) fn cells(self) -> std::ops::Range<usize> {
        if self.is_empty() {
            return 0..0;
        }
        self.first as usize * TILE_CELLS..(self.last as usize + 1) * TILE_CELLS
    }
}

/// Density by cell, all zero where `touched` says nothing.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    pub cells: Vec<u32>,
    /// One byte a group of slices of a tile: not 0 where a cell of the group may be other than 0. Bytes, since
    /// storing one needs no load of what was there.
    pub touched: Vec<u8>,
}

impl Grid {
    pub(super) fn new(layout: &Layout) -> Self {
        // Zeroed memory comes from the operating system page by page as it is used.
        Self {
            cells: vec![0; layout.cells()],
            touched: vec![0; layout.tiles() * layout.groups()],
        }
    }

    /// Makes the grid empty.
    pub(super) fn clear(&mut self, layout: &Layout) {
        let group = 1 << layout.group_len_shift();
        for (eight, marks) in self.touched.as_chunks_mut::<8>().0.iter_mut().enumerate() {
            if *marks == [0; 8] {
                continue;
            }
            for (mark, at) in marks.iter_mut().zip(eight * 8..) {
                if std::mem::take(mark) != 0 {
                    self.cells[at * group..(at + 1) * group].fill(0);
                }
            }
        }
    }

    /// Makes the grid empty whose cells in use are those of `spans`, one a tile.
    pub(super) fn clear_spans(&mut self, layout: &Layout, spans: &[Span]) {
        self.touched.fill(0);
        for (tile, span) in self.cells.chunks_exact_mut(layout.tile_len()).zip(spans) {
            tile[span.cells()].fill(0);
        }
    }

    /// The touched slices of `tile`.
    pub(super) fn span(&self, layout: &Layout, tile: usize) -> Span {
        let marks = &self.touched[tile * layout.groups()..(tile + 1) * layout.groups()];
        let words = || {
            marks
                .as_chunks::<8>()
                .0
                .iter()
                .map(|eight| u64::from_le_bytes(*eight))
                .enumerate()
        };
        let Some((at, word)) = words().find(|(_, word)| *word != 0) else {
            return Span::EMPTY;
        };
        let first = at * 8 + word.trailing_zeros() as usize / 8;
        let (at, word) = words().rfind(|(_, word)| *word != 0).unwrap_or((at, word));
        let last = at * 8 + 7 - word.leading_zeros() as usize / 8;
        let slices = 1 << layout.group_shift;
        Span {
            first: (first * slices) as i16,
            last: ((last + 1) * slices - 1) as i16,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_follow_the_marks_and_clearing_forgets_them() {
        let layout = Layout::new(128);
        let mut grid = Grid::new(&layout);
        assert!(grid.span(&layout, 3).is_empty());
        for i in [17, 90] {
            let at = layout.address(i, 2, 25) as usize;
            grid.cells[at] = 5;
            grid.touched[at >> layout.group_len_shift()] = 1;
        }
        assert_eq!(grid.span(&layout, 3), Span { first: 16, last: 91 });
        assert!(grid.span(&layout, 2).is_empty());
        grid.clear(&layout);
        assert!(grid.span(&layout, 3).is_empty());
        assert!(grid.cells.iter().all(|cell| *cell == 0));
    }
}
