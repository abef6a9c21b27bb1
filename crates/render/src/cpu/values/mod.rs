//! Any number a strand point, drawn as a picture draws hair.

mod pick;

use glam::Vec3;
use lovelock_groom::Strands;
use lovelock_groom::simd::Width;
use rayon::prelude::*;

use super::placed::{Placed, TileScratch, copy_rows};
use super::pool::Pool;
use super::tile::{Grid, HairPlanes, STRIDE, TILE};
use super::view::View;
use crate::picture::check_size;
use crate::uniform::FrameUniform;
use crate::{FrameInput, RenderError};

/// Values from here on are none, so that sums of them stay finite.
const MOST: f32 = 1e30;

/// Share of a pixel from which on it has a value; less is rounding.
const LEAST_SHARE: f32 = 1e-6;

/// Draws numbers in place of colours, on the processor: for maps of errors, and to find the hair under a pixel. Neither
/// lights nor shadows are looked at.
#[derive(Debug)]
pub struct ValueRenderer {
    strands: Strands,
    placed: Placed,
    /// All light, a word a point.
    lit: Vec<u32>,
    tiles: Vec<[f32; 2]>,
    pixels: Vec<[f32; 2]>,
    scratch: Pool<TileScratch>,
}

/// A number for each pixel, rows from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ValuePicture {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Mean of the values of the hair that a pixel shows; NaN where it shows none, or none that has a value.
    pub value: Vec<f32>,
    /// Share of the pixel that hair covers, 0 to 1: what lies behind comes through as the rest.
    pub weight: Vec<f32>,
}

/// A point of a strand that a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HairHit {
    /// The strand.
    pub strand: usize,
    /// The point, counted over the points of all strands.
    pub point: usize,
    /// Where it is, world space, metres.
    pub position: Vec3,
}

impl Default for ValueRenderer {
    fn default() -> Self {
        Self {
            strands: Strands::default(),
            placed: Placed::new(Width::widest()),
            lit: Vec::new(),
            tiles: Vec::new(),
            pixels: Vec::new(),
            scratch: Pool::default(),
        }
    }
}

impl ValueRenderer {
    /// Draws `values`, one a strand point, as a picture of `input` draws hair: as wide, as transparent, and hidden by the body.
    /// A value that is not finite is none: it hides what lies behind and counts for nothing.
    ///
    /// # Errors
    /// A size out of range, or another number of values than of strand points.
    pub fn picture(
        &mut self,
        input: &FrameInput,
        values: &[f32],
        width: u32,
        height: u32,
    ) -> Result<ValuePicture, RenderError> {
        check_size(width, height)?;
        let mut made = std::mem::take(&mut self.strands);
        let strands = input.hair.strands(input.style, &mut made);
        let drawn = self.draw(input, strands, values, width, height);
        self.strands = made;
        drawn
    }

    fn draw(
        &mut self,
        input: &FrameInput,
        strands: &Strands,
        values: &[f32],
        width: u32,
        height: u32,
    ) -> Result<ValuePicture, RenderError> {
        if values.len() != strands.points() {
            let (found, needed) = (values.len(), strands.points());
            return Err(RenderError::Known { of: "values, one a strand point", found, needed });
        }
        let uniform = FrameUniform::new(input, width, height, &[], 1);
        let view = View::new(&uniform, &[], &[], 1);
        let grid = self.place(&view, input, strands, width, height);
        // In the place of colours: the value times 1 or 0, and that. Their quotient is the mean of the values.
        self.placed.points.par_iter_mut().zip(values).with_min_len(8192).for_each(|(point, &value)| {
            point.color = if value.abs() < MOST { [value, 1.0, 0.0] } else { [0.0; 3] };
        });
        self.placed.sort(&view, &grid, input, strands, &[]);
        let mut tiles = std::mem::take(&mut self.tiles);
        tiles.resize(grid.columns * grid.rows * TILE * TILE, [0.0; 2]);
        tiles.par_chunks_mut(TILE * TILE).enumerate().for_each_init(
            || self.scratch.take(),
            |lease, (tile, out)| {
                if self.placed.is_empty(tile) {
                    out.fill([f32::NAN, 0.0]);
                    return;
                }
                let scratch = lease.get();
                self.placed.draw_tile(&view, &grid, input, tile, scratch);
                finish(&scratch.hair, out);
            },
        );
        copy_rows(&tiles, 1, &grid, &mut self.pixels);
        self.tiles = tiles;
        let (value, weight) = self.pixels.iter().map(|&[value, weight]| (value, weight)).unzip();
        Ok(ValuePicture { width, height, value, weight })
    }

    /// Projects the strands' points.
    fn place(&mut self, view: &View, input: &FrameInput, strands: &Strands, width: u32, height: u32) -> Grid {
        self.lit.resize(strands.points(), u32::MAX);
        self.placed.shade(view, input, strands, &self.lit);
        Grid::new(width, height)
    }
}

/// Value and cover of each pixel of a tile.
fn finish(hair: &HairPlanes, out: &mut [[f32; 2]]) {
    for (y, row) in out.chunks_mut(TILE).enumerate() {
        for (x, out) in row.iter_mut().enumerate() {
            let at = y * STRIDE + x;
            let (sum, share) = (hair.color[0][at], hair.color[1][at]);
            let weight = 1.0 - hair.through[at];
            *out = [if share > LEAST_SHARE { sum / share } else { f32::NAN }, weight.clamp(0.0, 1.0)];
        }
    }
}
