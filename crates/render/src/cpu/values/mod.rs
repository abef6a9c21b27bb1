//! Images of one number per strand point.

mod pick;

use glam::Vec3;
use lovelock_base::memory::list_bytes;
use lovelock_base::simd::Width;
use lovelock_groom::Strands;
use lovelock_picture::check_size;
use rayon::prelude::*;

use super::placed::{PlacedScene, TileScratch, copy_rows};
use super::pool::Pool;
use super::tile::{Grid, HairPlanes, STRIDE, TILE};
use super::view::{ShadingView, View};
use crate::scene_light::NO_LIGHT;
use crate::strand_details::StrandDetails;
use crate::uniform::FrameUniform;
use crate::{FrameInput, RenderError};

/// Values from this limit on count as missing, so that sums stay finite.
const MAX: f32 = 1e30;

/// The least covered fraction of a pixel that has a value; less is rounding.
const LEAST_SHARE: f32 = 1e-6;

/// Renders numbers in place of colours on the CPU, for error maps and to find the hair under a pixel. Ignores lights and shadows.
#[derive(Debug)]
pub struct ValueRenderer {
    strands: Strands,
    placed: PlacedScene,
    details: StrandDetails,
    /// Full transmittance, one word per point.
    lit: Vec<u32>,
    tiles: Vec<[f32; 2]>,
    pixels: Vec<[f32; 2]>,
    scratch: Pool<TileScratch>,
}

/// One number per pixel, rows from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ValuePicture {
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Mean of the values of the visible hair in a pixel; NaN if there is no hair or none with a value.
    pub value: Vec<f32>,
    /// The fraction of the pixel that hair covers, 0 to 1.
    pub weight: Vec<f32>,
}

/// The strand point that a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HairHit {
    /// The index of the strand.
    pub strand: usize,
    /// The index of the point among the points of all strands.
    pub point: usize,
    /// Its position, world space, metres.
    pub position: Vec3,
}

impl Default for ValueRenderer {
    fn default() -> Self {
        Self {
            strands: Strands::default(),
            placed: PlacedScene::new(Width::widest()),
            details: StrandDetails::default(),
            lit: Vec::new(),
            tiles: Vec::new(),
            pixels: Vec::new(),
            scratch: Pool::default(),
        }
    }
}

impl ValueRenderer {
    /// The memory that it keeps from picture to picture, bytes.
    pub fn bytes(&self) -> u64 {
        self.strands.bytes()
            + self.placed.bytes()
            + self.details.bytes()
            + list_bytes(&self.lit)
            + list_bytes(&self.tiles)
            + list_bytes(&self.pixels)
            + self.scratch.bytes(TileScratch::bytes)
    }

    /// Renders `values`, one per strand point, as an image of `input` renders hair: with the same widths, transparency and occlusion
    /// by the body. A value that is not finite is missing: it hides what is behind it but is not part of the mean.
    ///
    /// # Errors
    /// The size is out of range, or the number of values differs from the number of strand points.
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
            return Err(RenderError::Known { of: "values (one per strand point)", found, needed });
        }
        let uniform = FrameUniform::new(input, None, &NO_LIGHT, (width, height), &[], 1);
        let view = View::new(&uniform, (&NO_LIGHT.grid, ShadingView::TwoHighlights), &[], &[], 1);
        let grid = self.place(&view, input, strands, width, height);
        // In place of colours: the value times 1 or 0, and 1 or 0. Their quotient is the mean of the values.
        self.placed.points.par_iter_mut().zip(values).with_min_len(8192).for_each(|(point, &value)| {
            point.color = if value.abs() < MAX { [value, 1.0, 0.0] } else { [0.0; 3] };
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
                self.placed.draw_tile((&view, None), &grid, input, tile, scratch);
                finish(&scratch.hair, out);
            },
        );
        copy_rows(&tiles, 1, &grid, &mut self.pixels);
        self.tiles = tiles;
        let (value, weight) = self.pixels.iter().map(|&[value, weight]| (value, weight)).unzip();
        Ok(ValuePicture { width, height, value, weight })
    }

    /// Projects the strand points.
    fn place(&mut self, view: &View, input: &FrameInput, strands: &Strands, width: u32, height: u32) -> Grid {
        self.lit.resize(strands.points(), u32::MAX);
        self.details.follow(input.style);
        self.placed.shade(view, (strands, &self.details), &self.lit, false);
        Grid::new(width, height)
    }
}

/// Value and coverage of each pixel of a tile.
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
