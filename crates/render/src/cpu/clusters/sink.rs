//! Where the fragments of clusters go: into the list of a tile, or blended at once.

// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use crate::cpu::hair::list::{Fragment, Fragments};
use crate::cpu::tile::{HairPlanes, STRIDE, TILE, UNSEEN};

/// Receives fragments.
pub(super) trait Sink {
    /// Whether `covered` of fragments is used.
    const TAKES_SAMPLES: bool;
    /// Whether a fragment in the columns and rows of the tile, both ends included, could be seen.
    fn is_open_in(&self, columns: [usize; 2], rows: [usize; 2]) -> bool;
    /// Whether a fragment in the pixel at `at` could be seen.
    fn is_open(&self, at: usize) -> bool;
    /// Receives a fragment.
    fn take(&mut self, at: usize, fragment: Fragment);
}

impl Sink for Fragments {
    const TAKES_SAMPLES: bool = true;

    #[inline(always)]
    fn is_open_in(&self, _columns: [usize; 2], _rows: [usize; 2]) -> bool {
        true
    }

    #[inline(always)]
    fn is_open(&self, _at: usize) -> bool {
        true
    }

    fn take(&mut self, at: usize, fragment: Fragment) {
        self.push(at, fragment);
    }
}

/// Pixels along the edges of a square that is closed as a whole.
const SQUARE: usize = 8;
/// Squares along the edges of a tile.
const SQUARES: usize = TILE / SQUARE;

/// Blends fragments that come from near to far.
pub(super) struct Blend<'a> {
    planes: &'a mut HairPlanes,
    /// The number of pixels of each square in which something behind could be seen.
    open: [[u32; SQUARES]; SQUARES],
}

impl<'a> Blend<'a> {
    /// Blends into empty planes.
    pub fn new(planes: &'a mut HairPlanes) -> Self {
        Self { planes, open: [[(SQUARE * SQUARE) as u32; SQUARES]; SQUARES] }
    }
}

impl Sink for Blend<'_> {
    const TAKES_SAMPLES: bool = false;

    #[inline(always)]
    fn is_open_in(&self, [left, right]: [usize; 2], [top, bottom]: [usize; 2]) -> bool {
        let squares = left / SQUARE..=right / SQUARE;
        self.open[top / SQUARE..=bottom / SQUARE]
            .iter()
            .any(|row| row[squares.clone()].iter().any(|&n| n > 0))
    }

    #[inline(always)]
    fn is_open(&self, at: usize) -> bool {
        self.planes.through[at] > UNSEEN
    }

    #[inline(always)]
    fn take(&mut self, at: usize, fragment: Fragment) {
        let before = self.planes.through[at];
        let share = fragment.opacity() * before;
        for (plane, color) in self.planes.color.iter_mut().zip(fragment.color) {
            plane[at] += share * color;
        }
        self.planes.through[at] = before - share;
        if before > UNSEEN && before - share <= UNSEEN {
            self.open[at / STRIDE / SQUARE][at % STRIDE / SQUARE] -= 1;
        }
    }
}
