//! The tiles of an image.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use super::plain::PlainTiles;
use super::{CpuRenderer, Scratch};
use crate::cpu::backdrop::{Ground, ground_simd};
use crate::cpu::finish::{TILE_BYTES, finish_pixels_simd};
use crate::cpu::interrupt::check;
use crate::cpu::layers::finish_light;
use crate::cpu::placed::posed_body;
use crate::cpu::tile::{Grid, TILE};
use crate::cpu::view::View;
use crate::cpu::visible::LateInput;
use crate::{FrameInput, RenderError};

impl CpuRenderer {
    /// The light of all tiles, linear, for layers.
    pub(super) fn draw_light(
        &self,
        (view, late): (&View, Option<&LateInput>),
        grid: &Grid,
        input: &FrameInput,
        over_background: bool,
        light: &mut [[f32; 4]],
    ) {
        light.par_chunks_mut(TILE * TILE).enumerate().for_each_init(
            || self.scratch.take(),
            |lease, (tile, out)| {
                let ground = ground_simd(self.placed.width, view, grid.origin(tile));
                let scratch = lease.get();
                self.draw_seen((view, late), grid, input, tile, scratch);
                let seen = scratch.seen(grid.origin(tile), ground.as_ref(), self.behind.as_deref());
                finish_light(view, &seen, over_background, out);
            },
        );
    }

    /// Draws all tiles, or those of `only`. Those that show only the background are copied from `plain` if it has them, and to it otherwise.
    ///
    /// # Errors
    /// The picture must end, which is asked if all tiles are drawn.
    pub(super) fn draw_tiles(
        &self,
        (view, late): (&View, Option<&LateInput>),
        grid: &Grid,
        input: &FrameInput,
        tiles: &mut [u8],
        plain: &mut PlainTiles,
        only: Option<&[AtomicBool]>,
    ) -> Result<(), RenderError> {
        tiles
            .par_chunks_mut(TILE_BYTES)
            .zip(plain.bytes.par_chunks_mut(TILE_BYTES))
            .zip(&mut plain.known)
            .enumerate()
            .try_for_each_init(
                || self.scratch.take(),
                |lease, (tile, ((out, plain), known))| {
                    match only {
                        Some(only) if !only[tile].load(Ordering::Relaxed) => return Ok(()),
                        Some(_) => {}
                        None => check(self.interrupt.as_ref())?,
                    }
                    let ground = ground_simd(self.placed.width, view, grid.origin(tile));
                    let is_plain = ground.is_none() && self.placed.is_empty(tile);
                    if is_plain && *known {
                        out.copy_from_slice(plain);
                        return Ok(());
                    }
                    self.draw_tile((view, late), grid, input, (tile, ground.as_ref()), lease.get(), out);
                    if is_plain {
                        plain.copy_from_slice(out);
                        *known = true;
                    }
                    Ok(())
                },
            )
    }

    fn draw_tile(
        &self,
        (view, late): (&View, Option<&LateInput>),
        grid: &Grid,
        input: &FrameInput,
        (tile, ground): (usize, Option<&Ground>),
        scratch: &mut Scratch,
        out: &mut [u8],
    ) {
        self.draw_seen((view, late), grid, input, tile, scratch);
        let seen = scratch.seen(grid.origin(tile), ground, self.behind.as_deref());
        finish_pixels_simd(self.placed.width, view, &seen, out);
    }

    /// Draws the body and the hair of a tile.
    fn draw_seen(
        &self,
        (view, late): (&View, Option<&LateInput>),
        grid: &Grid,
        input: &FrameInput,
        tile: usize,
        scratch: &mut Scratch,
    ) {
        let (placed, origin) = (&self.placed, grid.origin(tile));
        placed.draw_tile((view, late), grid, input, tile, &mut scratch.tile);
        scratch.surface.clear();
        if let Some(body) = posed_body(input)
            && !placed.surface.bins.of(tile).is_empty()
        {
            scratch.light.shade_tile(
                placed.width,
                view,
                origin,
                (&placed.surface, body),
                (&scratch.tile.samples, &scratch.tile.hair),
                placed.is_exact,
                &mut scratch.surface,
            );
        }
    }
}
