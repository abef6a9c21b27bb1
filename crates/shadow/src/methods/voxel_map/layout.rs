//! The memory layout of the map on the CPU.
//!
//! Columns of cells (along the light) are grouped by 4 × 4 into *tiles*: `[tile j][tile k][i][4 × 4]`. One slice of a tile is
//! one cache line, and an address is the sum of one term per coordinate. Hair fills few tiles, and a short run of slices in
//! each; other memory is neither cleared nor summed, and the operating system does not map it.
//!
//! Addresses of cells within the map fit 32 bits at every resolution, as a test checks. They are computed without checks for overflow,
//! each of which is a branch and would keep loops from being compiled to vectors.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

/// Base-2 logarithm of the columns along the edge of a tile. Tiles of 8 × 8 are as fast but fill more cells: 41 % instead of
/// 25 % of the map of the published hairstyle at 128³.
const EDGE_SHIFT: u32 = 2;
/// Cells of one slice of a tile.
pub(super) const TILE_CELLS: usize = 1 << (2 * EDGE_SHIFT);
/// Shift from slices to cells of a tile.
const SLICE_SHIFT: u32 = 2 * EDGE_SHIFT;
/// The bits of j and k within a tile.
const WITHIN: u32 = (1 << EDGE_SHIFT) - 1;

/// The layout for one resolution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Layout {
    /// Cells along each edge, a multiple of 8.
    pub resolution: u32,
    /// Tiles along each edge across the light.
    pub tiles_per_edge: u32,
    /// Base-2 logarithm of the number of cells of a tile; slices are padded to a power of two.
    pub tile_shift: u32,
    /// Base-2 logarithm of the slices in a *group*, the unit in which touched slices are recorded.
    pub group_shift: u32,
}

impl Layout {
    pub(super) fn new(resolution: u32) -> Self {
        debug_assert!(resolution.is_multiple_of(1 << EDGE_SHIFT));
        Self {
            resolution,
            tiles_per_edge: resolution >> EDGE_SHIFT,
            tile_shift: (resolution.next_power_of_two() * TILE_CELLS as u32).ilog2(),
            // Between 8 and 64 groups per tile: as many bits as a word has, and whole bytes of them.
            group_shift: match resolution {
                ..=31 => 1,
                32..=256 => 2,
                _ => 3,
            },
        }
    }

    pub(super) fn tiles(&self) -> usize {
        (self.tiles_per_edge * self.tiles_per_edge) as usize
    }

    pub(super) fn tile_len(&self) -> usize {
        1 << self.tile_shift
    }

    pub(super) fn cells(&self) -> usize {
        self.tiles() << self.tile_shift
    }

    /// Groups of slices per tile.
    pub(super) fn groups(&self) -> usize {
        self.tile_len() >> self.group_len_shift()
    }

    /// Base-2 logarithm of the cells in a group of slices: an address shifted right by it is the index of a group.
    pub(super) fn group_len_shift(&self) -> u32 {
        self.group_shift + SLICE_SHIFT
    }

    /// The cells of a group within a tile.
    pub(super) fn group_cells(&self, group: usize) -> std::ops::Range<usize> {
        group << self.group_len_shift()..(group + 1) << self.group_len_shift()
    }

    /// The tile of column `(j, k)`.
    #[inline(always)]
    pub(super) fn tile(&self, j: u32, k: u32) -> u32 {
        (j >> EDGE_SHIFT).wrapping_mul(self.tiles_per_edge).wrapping_add(k >> EDGE_SHIFT)
    }

    /// The term of an address that depends on i.
    #[inline(always)]
    pub(super) fn slice(i: u32) -> u32 {
        i << SLICE_SHIFT
    }

    /// The term of an address that depends on j.
    #[inline(always)]
    pub(super) fn row(&self, j: u32) -> u32 {
        let tiles = (j >> EDGE_SHIFT).wrapping_mul(self.tiles_per_edge);
        tiles.wrapping_shl(self.tile_shift).wrapping_add((j & WITHIN) << EDGE_SHIFT)
    }

    /// The term of an address that depends on k.
    #[inline(always)]
    pub(super) fn column(&self, k: u32) -> u32 {
        (k >> EDGE_SHIFT).wrapping_shl(self.tile_shift).wrapping_add(k & WITHIN)
    }

    /// Address of cell `(i, j, k)`.
    #[inline(always)]
    pub(super) fn address(&self, i: u32, j: u32, k: u32) -> u32 {
        self.row(j).wrapping_add(self.column(k)).wrapping_add(Self::slice(i))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_cell_has_its_own_address() {
        for resolution in [16, 24, 32, 40, 56] {
            let layout = Layout::new(resolution);
            let mut seen = vec![false; layout.cells()];
            for i in 0..resolution {
                for j in 0..resolution {
                    for k in 0..resolution {
                        let at = layout.address(i, j, k) as usize;
                        assert!(!std::mem::replace(&mut seen[at], true));
                        let tile = at >> layout.tile_shift;
                        assert_eq!(tile as u32, layout.tile(j, k));
                        assert_eq!(tile as u32, (j / 4) * (resolution / 4) + k / 4);
                        let group = (at >> layout.group_len_shift()) % layout.groups();
                        assert_eq!(group as u32, i >> layout.group_shift);
                    }
                }
            }
        }
    }

    #[test]
    fn addresses_fit_at_every_resolution() {
        for resolution in (16..=512).step_by(8) {
            let layout = Layout::new(resolution);
            assert!(layout.cells() <= 1 << 27);
            assert!(layout.groups() <= 64 && layout.groups().is_multiple_of(8));
        }
    }
}
