//! The last step of a tile: compositing, tone mapping, bytes.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use lovelock_base::simd_versions;

use super::backdrop::{Ground, backdrop};
use super::math::{clamp, floor, index_of, max};
use super::tile::{HairPlanes, STRIDE, SurfacePlanes, TILE, UNSEEN};
use super::tone_map::encode;
use super::view::View;
use crate::backdrop::{LaidBackdrop, mixed};

/// Bytes of a finished tile.
pub(super) const TILE_BYTES: usize = TILE * TILE * 4;

/// The input of a finished tile.
pub(super) struct PixelsIn<'a> {
    pub origin: [f32; 2],
    pub hair: &'a HairPlanes,
    pub surface: &'a SurfacePlanes,
    /// The shadows on the ground, if any.
    pub ground: Option<&'a Ground>,
    /// The picture behind the figure, if any.
    pub picture: Option<&'a LaidBackdrop>,
}

/// The light of a row of a tile, and the fraction that neither hair nor body covers. Without `over_background` there is nothing
/// behind them. A picture behind them is not in the light; shadows on the ground cover it as black does.
#[inline(always)]
pub(super) fn compose_row(
    view: &View,
    input: &PixelsIn,
    y: usize,
    over_background: bool,
) -> ([[f32; TILE]; 3], [f32; TILE]) {
    let PixelsIn { origin, hair, surface, ground, picture } = *input;
    let at = y * STRIDE;
    let mut row = [[0.0_f32; TILE]; 3];
    let mut open = [0.0_f32; TILE];
    let mut most = 0.0;
    for x in 0..TILE {
        open[x] = hair.through[at + x] * (1.0 - surface.cover[at + x]);
        most = max(open[x], most);
    }
    if let (true, Some(_), Some(ground)) = (over_background, picture, ground) {
        for x in 0..TILE {
            if open[x] > UNSEEN {
                let [r, g, b] = ground.light(view, x, y);
                open[x] *= (r + g + b) * (1.0 / 3.0);
            }
        }
    }
    if most > UNSEEN && over_background && picture.is_none() {
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

simd_versions! {
    /// [`finish_pixels`] for the vectors of `width`.
    pub(super) fn finish_pixels_simd(view: &View, input: &PixelsIn, out: &mut [u8]) -> () {
        finish_pixels(view, input, out)
    }
}

/// Composites and tone-maps a tile, and writes its [`TILE_BYTES`] bytes.
#[inline(always)]
fn finish_pixels(view: &View, input: &PixelsIn, out: &mut [u8]) {
    let exposure = view.uniform.exposure;
    let origin = input.origin;
    for y in 0..TILE {
        let (mut row, open) = compose_row(view, input, y, true);
        if let Some(picture) = input.picture {
            show_over(&mut row, &open, picture, [origin[0] as usize, origin[1] as usize + y], exposure);
        } else {
            encode(&mut row, exposure);
        }
        let mut bytes = [[0_i32; TILE]; 3];
        for (bytes, row) in bytes.iter_mut().zip(&row) {
            for x in 0..TILE {
                let noise = noise_at(origin[0] + x as f32, origin[1] + y as f32);
                // Rounded to nearest, as a GPU does.
                bytes[x] = index_of(floor(clamp(row[x] * 255.0 + noise + 0.5, 0.0, 255.0))) as i32;
            }
        }
        let Some(out) = out.get_mut(y * TILE * 4..(y + 1) * TILE * 4) else { return };
        for (x, pixel) in out.as_chunks_mut::<4>().0.iter_mut().enumerate().take(TILE) {
            *pixel = (bytes[0][x] | bytes[1][x] << 8 | bytes[2][x] << 16 | 0xff << 24).to_le_bytes();
        }
    }
}

/// Encodes a row of light over the picture behind it, which shows through by `open`. The row begins at the pixel `[x, y]` of the image.
#[inline(always)]
pub(super) fn show_over<const N: usize>(
    row: &mut [[f32; N]; 3],
    open: &[f32; N],
    picture: &LaidBackdrop,
    [x0, y]: [usize; 2],
    exposure: f32,
) {
    for lane in 0..N {
        let scale = 1.0 / max(1.0 - open[lane], LEAST_COVER);
        (0..3).for_each(|c| row[c][lane] *= scale);
    }
    encode(row, exposure);
    for lane in 0..N {
        if open[lane] > UNSEEN {
            // Less than this covers nothing.
            let open = if open[lane] > 1.0 - LEAST_COVER { 1.0 } else { open[lane] };
            let over = [row[0][lane], row[1][lane], row[2][lane]];
            let shown = mixed(over, picture.color(x0 + lane, y), open);
            (0..3).for_each(|c| row[c][lane] = shown[c]);
        }
    }
}

/// The least coverage of a pixel that has a colour; less is rounding. Twin of the one in picture.wgsl.
const LEAST_COVER: f32 = 1e-5;

/// Ordered dither of up to half a step, so that smooth gradients do not band.
#[inline(always)]
pub(super) fn noise_at(x: f32, y: f32) -> f32 {
    let inner = x * 0.067_110_56 + y * 0.005_837_15;
    let inner = (inner - floor(inner)) * 52.982_918_9;
    inner - floor(inner) - 0.5
}
