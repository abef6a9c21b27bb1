//! The hair of a picture in false colours: twin of `gpu/renderer/false_colors.rs` and `false_colors.wgsl`.

use rayon::prelude::*;

use super::finish::TILE_BYTES;
use super::placed::{PlacedScene, TileScratch};
use super::pool::Pool;
use super::tile::{Grid, HairPlanes, STRIDE, TILE};
use super::view::View;
use crate::{ColorScale, FrameInput};

/// Values from this limit on are missing. Twin of `MAX_VALUE` in `value_points.wgsl`.
const MAX: f32 = 1e30;
/// The least covered fraction of a pixel that has a value; less is rounding.
const LEAST_SHARE: f32 = 1e-6;
/// The index of the last colour.
const LAST_COLOR: usize = 255;

/// Colours the hair of finished `tiles` by one value per drawn point. Overwrites the colours of points.
pub(super) fn paint_values(
    view: &View,
    grid: &Grid,
    input: &FrameInput,
    placed: &mut PlacedScene,
    (values, scale): (&[f32], &ColorScale),
    tiles: &mut [u8],
) {
    let [low, high] = scale.range;
    let inverse = (high - low).recip();
    placed.points.par_iter_mut().zip(values).with_min_len(8192).for_each(|(point, &value)| {
        let known = value.abs() < MAX;
        point.color = if known { [(value - low) * inverse, 1.0, 0.0] } else { [0.0; 3] };
    });
    for point in placed.carried_points() {
        point.color = [0.0; 3];
    }
    let (placed, scratch) = (&*placed, Pool::<TileScratch>::default());
    tiles.par_chunks_mut(TILE_BYTES).enumerate().for_each_init(
        || scratch.take(),
        |lease, (tile, out)| {
            let scratch = lease.get();
            if placed.segment_bins.of(tile).is_empty() {
                scratch.hair.clear();
            } else {
                placed.draw_tile((view, None), grid, input, tile, scratch);
            }
            paint_tile(&scratch.hair, scale, out);
        },
    );
}

/// Colours the pixels of a tile, whose hair has places of values in their range and 1 in place of colours.
fn paint_tile(hair: &HairPlanes, scale: &ColorScale, out: &mut [u8]) {
    for (i, pixel) in out.chunks_exact_mut(4).enumerate() {
        let at = i / TILE * STRIDE + i % TILE;
        let lit = [pixel[0], pixel[1], pixel[2]].map(|byte| f32::from(byte) / 255.0);
        let luminance = 0.2126 * lit[0] + 0.7152 * lit[1] + 0.0722 * lit[2];
        let light = scale.light_on(luminance);
        let (sum, counted) = (hair.color[0][at], hair.color[1][at]);
        let share = if counted > LEAST_SHARE { (1.0 - hair.through[at]).clamp(0.0, 1.0) } else { 0.0 };
        let place = if share > 0.0 { (sum / counted).clamp(0.0, 1.0) * LAST_COLOR as f32 } else { 0.0 };
        let below = (place as usize).min(LAST_COLOR - 1);
        let part = place - below as f32;
        for c in 0..3 {
            let under = scale.behind * (luminance + (lit[c] - luminance) * scale.saturation);
            let [a, b] = [below, below + 1].map(|k| f32::from(scale.colors[k][c]) / 255.0);
            let color = light * (a + (b - a) * part);
            pixel[c] = ((under + share * (color - under)).clamp(0.0, 1.0) * 255.0).round() as u8;
        }
    }
}
