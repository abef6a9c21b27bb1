//! The tiles of a picture, what each of them holds, and the blocks of pixels within it.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use super::bins::TileRange;

/// Pixels along each edge of a tile.
pub(super) const TILE: usize = 32;
/// Items per row of a tile: more than pixels, because a run of pixels may exceed the row.
pub(super) const STRIDE: usize = TILE + 8;
/// Pixels that are drawn together: a block of two columns and four rows, because hair is mostly vertical.
pub(super) const BLOCK_LANES: usize = BLOCK_WIDTH * BLOCK_HEIGHT;
pub(super) const BLOCK_WIDTH: usize = 2;
pub(super) const BLOCK_HEIGHT: usize = 4;
/// Blocks per row of blocks, and per tile.
pub(super) const BLOCKS_IN_ROW: usize = TILE / BLOCK_WIDTH;
pub(super) const BLOCKS: usize = BLOCKS_IN_ROW * (TILE / BLOCK_HEIGHT);
/// The transmittance of hair below which what is behind it is not shaded: a quarter of a step of 8 bits.
pub(super) const UNSEEN: f32 = 1.0 / 1024.0;
/// The transmittance at which blending in exact order ends: a fortieth of a step of 8 bits. The same number is in `eye/lists/resolve.wgsl`.
pub(super) const OPAQUE: f32 = 1e-4;

/// One number per pixel of a tile, with unused items at the end of each row.
pub(super) type Plane = [f32; TILE * STRIDE];

/// Column and row in the tile of a lane of a block.
#[inline(always)]
pub(super) fn pixel_of(block: usize, lane: usize) -> (usize, usize) {
    let (x, y) = (block % BLOCKS_IN_ROW * BLOCK_WIDTH, block / BLOCKS_IN_ROW * BLOCK_HEIGHT);
    (x + lane % BLOCK_WIDTH, y + lane / BLOCK_WIDTH)
}

/// The tiles of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Grid {
    pub width: u32,
    pub height: u32,
    pub columns: usize,
    pub rows: usize,
}

impl Grid {
    pub fn new(width: u32, height: u32) -> Self {
        let tiles = |side: u32| (side as usize).div_ceil(TILE);
        Self { width, height, columns: tiles(width), rows: tiles(height) }
    }

    /// The corner of a tile, pixels.
    pub fn origin(&self, tile: usize) -> [f32; 2] {
        [(tile % self.columns * TILE) as f32, (tile / self.columns * TILE) as f32]
    }

    /// The tiles that a rectangle (left, top, right and bottom in pixels) touches. `None` outside the picture and for NaN.
    #[inline(always)]
    pub fn range(&self, [left, top, right, bottom]: [f32; 4]) -> Option<TileRange> {
        let (width, height) = (self.width as f32, self.height as f32);
        let seen = right >= 0.0 && bottom >= 0.0 && left < width && top < height;
        if !seen {
            return None;
        }
        let tile = |at: f32, most: f32| (at.clamp(0.0, most - 1.0) as usize / TILE) as u16;
        Some(TileRange {
            x0: tile(left, width),
            x1: tile(right, width),
            y0: tile(top, height),
            y1: tile(bottom, height),
        })
    }
}

/// The hair of a tile: its light, premultiplied by coverage, and its transmittance toward the eye.
#[derive(Clone, Debug)]
pub(super) struct HairPlanes {
    pub color: [Plane; 3],
    pub through: Plane,
}

impl Default for HairPlanes {
    fn default() -> Self {
        Self { color: [[0.0; TILE * STRIDE]; 3], through: [1.0; TILE * STRIDE] }
    }
}

impl HairPlanes {
    pub fn clear(&mut self) {
        self.color.iter_mut().for_each(|plane| plane.fill(0.0));
        self.through.fill(1.0);
    }
}

/// The body of a tile: its light, premultiplied by coverage, and its coverage.
#[derive(Clone, Debug)]
pub(super) struct SurfacePlanes {
    pub color: [Plane; 3],
    pub cover: Plane,
}

impl Default for SurfacePlanes {
    fn default() -> Self {
        Self { color: [[0.0; TILE * STRIDE]; 3], cover: [0.0; TILE * STRIDE] }
    }
}

impl SurfacePlanes {
    pub fn clear(&mut self) {
        self.color.iter_mut().for_each(|plane| plane.fill(0.0));
        self.cover.fill(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_cover_the_picture_and_ranges_stay_inside() {
        let grid = Grid::new(70, 33);
        assert_eq!((grid.columns, grid.rows), (3, 2));
        assert_eq!(grid.origin(5), [64.0, 32.0]);
        let all = grid.range([-1e9, -1e9, 1e9, 1e9]).expect("all of it");
        assert_eq!(all, TileRange { x0: 0, x1: 2, y0: 0, y1: 1 });
        assert_eq!(grid.range([71.0, 0.0, 80.0, 5.0]), None);
        assert_eq!(grid.range([f32::NAN, 0.0, 80.0, 5.0]), None);
        let one = grid.range([31.0, 31.0, 31.9, 31.9]).expect("one tile");
        assert_eq!(one, TileRange { x0: 0, x1: 0, y0: 0, y1: 0 });
    }
}
