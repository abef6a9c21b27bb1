//! The tiles that show only the background.

use crate::cpu::finish::TILE_BYTES;
use crate::cpu::tile::Grid;
use crate::uniform::{FrameUniform, PlainBackground};

/// Tiles that show only the background: the same in every frame until the background or the size changes.
#[derive(Debug, Default)]
pub(super) struct PlainTiles {
    /// What the tiles depend on.
    of: Option<(PlainBackground, Grid)>,
    pub(super) bytes: Vec<u8>,
    /// Whether each tile has been drawn.
    pub(super) known: Vec<bool>,
}

impl PlainTiles {
    /// Clears the tiles if the background or the size has changed.
    pub(super) fn follow(&mut self, uniform: &FrameUniform, grid: &Grid, picture: u64) {
        let of = Some((PlainBackground::of(uniform, picture), *grid));
        if self.of != of {
            self.of = of;
            self.known.clear();
            self.known.resize(grid.columns * grid.rows, false);
            self.bytes.resize(grid.columns * grid.rows * TILE_BYTES, 0);
        }
    }
}
