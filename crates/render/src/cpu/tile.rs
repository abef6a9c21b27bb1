//! The picture cut into tiles, and the last step of each: what is behind the hair, tone mapping, bytes.
// Compiled within the versions of `dispatch`.
#![allow(clippy::inline_always)]

use super::backdrop::{Ground, backdrop};
use super::bins::TileRange;
use super::math::{clamp, floor, index_of, max};
use super::tone::encode;
use super::view::View;

/// Pixels along each edge of a tile.
pub(super) const TILE: usize = 32;
/// Places of a row of a tile: as many more as a run of pixels may pass its end.
pub(super) const STRIDE: usize = TILE + 8;
/// Bytes of a finished tile.
pub(super) const TILE_BYTES: usize = TILE * TILE * 4;
/// Light that comes through hair and is no longer worth shading what is behind: a fourth of a step of 8 bits.
pub(super) const UNSEEN: f32 = 1.0 / 1024.0;

/// One number for each pixel of a tile, with spare places at the end of each row.
pub(super) type Plane = [f32; TILE * STRIDE];

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

    /// Pixels of a tile's corner.
    pub fn origin(&self, tile: usize) -> [f32; 2] {
        [(tile % self.columns * TILE) as f32, (tile / self.columns * TILE) as f32]
    }

    /// The tiles that a rectangle touches: left, top, right and bottom in pixels. None outside, and where a
    /// number is none.
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

/// The hair of a tile: its light, already multiplied by its cover, and what it lets through.
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

/// The body of a tile: its light times the part of each pixel that it covers, and that part.
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

/// What a finished tile is made of.
pub(super) struct PixelsIn<'a> {
    pub origin: [f32; 2],
    pub hair: &'a HairPlanes,
    pub surface: &'a SurfacePlanes,
    /// The shadows on the ground, where there are any.
    pub ground: Option<&'a Ground>,
}

/// The light of a row of a tile, and the share of it that neither hair nor body covers. Without `over_background` nothing comes
/// through from behind them.
#[inline(always)]
pub(super) fn compose_row(
    view: &View,
    input: &PixelsIn,
    y: usize,
    over_background: bool,
) -> ([[f32; TILE]; 3], [f32; TILE]) {
    let PixelsIn { origin, hair, surface, ground } = *input;
    let at = y * STRIDE;
    let mut row = [[0.0_f32; TILE]; 3];
    let mut open = [0.0_f32; TILE];
    let mut most = 0.0;
    for x in 0..TILE {
        open[x] = hair.through[at + x] * (1.0 - surface.cover[at + x]);
        most = max(open[x], most);
    }
    if most > UNSEEN && over_background {
        backdrop(view, origin[0] + 0.5, origin[1] + y as f32 + 0.5, &mut row);
        if let Some(ground) = ground {
            for x in 0..TILE {
                if open[x] > UNSEEN {
                    let light = ground.light(view, x, y);
                    (row[0][x], row[1][x], row[2][x]) =
                        (row[0][x] * light[0], row[1][x] * light[1], row[2][x] * light[2]);
                }
            }
        }
    }
    for ((row, hair_color), surface_color) in row.iter_mut().zip(&hair.color).zip(&surface.color) {
        for x in 0..TILE {
            row[x] = hair_color[at + x] + hair.through[at + x] * surface_color[at + x] + open[x] * row[x];
        }
    }
    (row, open)
}

/// Puts a tile together and writes its bytes, [`TILE_BYTES`] of them.
#[inline(always)]
pub(super) fn finish_pixels(view: &View, input: &PixelsIn, out: &mut [u8]) {
    let exposure = view.uniform.size_scale_exposure.w;
    let origin = input.origin;
    for y in 0..TILE {
        let (mut row, _) = compose_row(view, input, y, true);
        encode(&mut row, exposure);
        let mut bytes = [[0_i32; TILE]; 3];
        for (bytes, row) in bytes.iter_mut().zip(&row) {
            for x in 0..TILE {
                let noise = noise_at(origin[0] + x as f32, origin[1] + y as f32);
                // Rounded to the nearest, as a card stores what it is given.
                bytes[x] = index_of(floor(clamp(row[x] * 255.0 + noise + 0.5, 0.0, 255.0))) as i32;
            }
        }
        let Some(out) = out.get_mut(y * TILE * 4..(y + 1) * TILE * 4) else { return };
        for (x, pixel) in out.as_chunks_mut::<4>().0.iter_mut().enumerate().take(TILE) {
            *pixel = (bytes[0][x] | bytes[1][x] << 8 | bytes[2][x] << 16 | 0xff << 24).to_le_bytes();
        }
    }
}

/// Half a step of ordered noise at a pixel, so that smooth gradients do not band.
#[inline(always)]
pub(super) fn noise_at(x: f32, y: f32) -> f32 {
    let inner = x * 0.067_110_56 + y * 0.005_837_15;
    let inner = (inner - floor(inner)) * 52.982_918_9;
    inner - floor(inner) - 0.5
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
