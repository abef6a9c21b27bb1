//! Lookups of one texture at several places together: [`Chain::at`] in loops that vectorise.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use glam::{Affine2, Vec2};
use lovelock_motion::Wrap;

use crate::cpu::math::{clamp, floor, log2, max, min, most};
use crate::textures::{Chain, Content, Sampling};

/// Texture coordinates of places, and how they change from pixel to pixel.
#[derive(Clone, Copy, Debug)]
pub(super) struct CoordinatesOf<const N: usize> {
    pub at: [[f32; N]; 2],
    pub dx: [[f32; N]; 2],
    pub dy: [[f32; N]; 2],
}

/// A coordinate that is at most so large keeps its place to a few thousandths of the image.
const FARTHEST: f32 = 1024.0;

/// A place between two texels of an axis.
#[derive(Clone, Copy)]
struct Between<const N: usize> {
    first: [i32; N],
    second: [i32; N],
    part: [f32; N],
}

impl Chain {
    /// Red, green, blue (linear) and alpha at the first `count` of several places, as [`Chain::at`] returns them after `transform`, to
    /// rounding.
    #[inline(always)]
    pub(super) fn at_places<const N: usize>(
        &self,
        of: &CoordinatesOf<N>,
        count: usize,
        transform: &Affine2,
        sampling: Sampling,
    ) -> [[f32; N]; 4] {
        let uv = moved(transform, &of.at);
        let lod = self.level_of(of, transform);
        let last = (self.levels.len() - 1) as f32;
        let mut part = [0.0; N];
        let mut finer = [0_usize; N];
        for lane in 0..N {
            let lod = clamp(lod[lane], 0.0, last);
            let whole = floor(lod);
            part[lane] = lod - whole;
            finer[lane] = whole as usize;
        }
        let is_far = max(most_of(&uv[0]), most_of(&uv[1])) > FARTHEST;
        if sampling.is_nearest || is_far {
            let mut out = [[0.0; N]; 4];
            for lane in 0..count.min(N) {
                let at = self.at(Vec2::new(uv[0][lane], uv[1][lane]), lod[lane], sampling);
                (0..4).for_each(|c| out[c][lane] = at[c]);
            }
            return out;
        }
        let mut fine = self.bilinear_of(&uv, &finer, count, sampling);
        if part.iter().take(count).any(|part| *part > 0.0) {
            let mut coarser = finer;
            for lane in 0..N {
                coarser[lane] = (finer[lane] + 1).min(self.levels.len() - 1);
            }
            let coarse = self.bilinear_of(&uv, &coarser, count, sampling);
            for c in 0..4 {
                for lane in 0..N {
                    fine[c][lane] += (coarse[c][lane] - fine[c][lane]) * part[lane];
                }
            }
        }
        fine
    }

    /// See `level_of_detail`.
    #[inline(always)]
    fn level_of<const N: usize>(&self, of: &CoordinatesOf<N>, transform: &Affine2) -> [f32; N] {
        let [width, height] = self.levels[0].size;
        let (width, height) = (width as f32, height as f32);
        let turn = transform.matrix2;
        let mut lod = [0.0; N];
        for lane in 0..N {
            let squared = |step: &[[f32; N]; 2]| {
                let x = (turn.x_axis.x * step[0][lane] + turn.y_axis.x * step[1][lane]) * width;
                let y = (turn.x_axis.y * step[0][lane] + turn.y_axis.y * step[1][lane]) * height;
                x * x + y * y
            };
            // 1e-12 for NaN.
            let longest = min(max(max(squared(&of.dx), squared(&of.dy)), 1e-12), 1e30);
            lod[lane] = 0.5 * log2(longest);
        }
        lod
    }

    #[inline(always)]
    fn bilinear_of<const N: usize>(
        &self,
        uv: &[[f32; N]; 2],
        levels: &[usize; N],
        count: usize,
        sampling: Sampling,
    ) -> [[f32; N]; 4] {
        let mut size = [[1.0; N]; 2];
        for lane in 0..N {
            let [width, height] = self.levels[levels[lane]].size;
            (size[0][lane], size[1][lane]) = (width as f32, height as f32);
        }
        let x = between(&uv[0], &size[0], sampling.wrap[0]);
        let y = between(&uv[1], &size[1], sampling.wrap[1]);
        let mut corners = [[0_u32; N]; 4];
        for lane in 0..count.min(N) {
            let level = &self.levels[levels[lane]];
            let (width, texels) = (level.size[0] as usize, level.texels.as_chunks::<4>().0);
            let (upper, lower) = (y.first[lane] as usize * width, y.second[lane] as usize * width);
            let (left, right) = (x.first[lane] as usize, x.second[lane] as usize);
            for (corner, at) in
                corners.iter_mut().zip([upper + left, upper + right, lower + left, lower + right])
            {
                corner[lane] = texels.get(at).map_or(0, |texel| u32::from_le_bytes(*texel));
            }
        }
        let table = self.content.table();
        let mut out = [[0.0; N]; 4];
        for c in 0..4 {
            // Data and opacity are bytes over 255.
            let is_plain = c == 3 || self.content == Content::Data;
            let mut decoded = [[0.0; N]; 4];
            for (decoded, words) in decoded.iter_mut().zip(&corners) {
                let shift = 8 * c as u32;
                *decoded = if is_plain { shares_of(words, shift) } else { looked_up(table, words, shift) };
            }
            for lane in 0..N {
                let upper = decoded[0][lane] + (decoded[1][lane] - decoded[0][lane]) * x.part[lane];
                let lower = decoded[2][lane] + (decoded[3][lane] - decoded[2][lane]) * x.part[lane];
                out[c][lane] = upper + (lower - upper) * y.part[lane];
            }
        }
        out
    }
}

/// A byte of each word over 255.
#[inline(always)]
fn shares_of<const N: usize>(words: &[u32; N], shift: u32) -> [f32; N] {
    let mut out = [0.0; N];
    for lane in 0..N {
        out[lane] = (words[lane] >> shift & 0xff) as i32 as f32 * (1.0 / 255.0);
    }
    out
}

/// The value of a byte of each word.
#[inline(always)]
fn looked_up<const N: usize>(table: &[f32; 256], words: &[u32; N], shift: u32) -> [f32; N] {
    let mut out = [0.0; N];
    for lane in 0..N {
        out[lane] = table[(words[lane] >> shift & 0xff) as usize];
    }
    out
}

#[inline(always)]
fn moved<const N: usize>(transform: &Affine2, at: &[[f32; N]; 2]) -> [[f32; N]; 2] {
    let (m, by) = (transform.matrix2, transform.translation);
    let mut out = [[0.0; N]; 2];
    for lane in 0..N {
        out[0][lane] = m.x_axis.x * at[0][lane] + m.y_axis.x * at[1][lane] + by.x;
        out[1][lane] = m.x_axis.y * at[0][lane] + m.y_axis.y * at[1][lane] + by.y;
    }
    out
}

/// The largest size of numbers; infinity for NaN.
#[inline(always)]
fn most_of<const N: usize>(of: &[f32; N]) -> f32 {
    let mut sizes = [0.0; N];
    for lane in 0..N {
        let size = of[lane].abs();
        sizes[lane] = if size <= f32::MAX { size } else { f32::INFINITY };
    }
    most(&sizes)
}

/// The texels around coordinates of an axis of images of `size` texels, for coordinates within [`FARTHEST`].
#[inline(always)]
fn between<const N: usize>(u: &[f32; N], size: &[f32; N], wrap: Wrap) -> Between<N> {
    let mut out = Between { first: [0; N], second: [0; N], part: [0.0; N] };
    for lane in 0..N {
        let (u, size) = (u[lane], size[lane]);
        let reduced = match wrap {
            Wrap::Repeat => u - floor(u),
            Wrap::Mirror => u - 2.0 * floor(0.5 * u),
            Wrap::Clamp => clamp(u, -1.0, 2.0),
        };
        let at = reduced * size - 0.5;
        let first = floor(at);
        out.part[lane] = at - first;
        let texel = |index: f32| {
            let inside = match wrap {
                Wrap::Repeat => {
                    let index = if index < 0.0 { index + size } else { index };
                    if index >= size { index - size } else { index }
                }
                Wrap::Mirror => {
                    let index = if index < 0.0 { -1.0 - index } else { index };
                    let index = if index >= 2.0 * size { index - 2.0 * size } else { index };
                    if index >= size { 2.0 * size - 1.0 - index } else { index }
                }
                Wrap::Clamp => index,
            };
            clamp(inside, 0.0, size - 1.0)
        };
        out.first[lane] = texel(first) as i32;
        out.second[lane] = texel(first + 1.0) as i32;
    }
    out
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use lovelock_motion::Image;

    use super::*;
    use crate::textures::level_of_detail;

    /// An image of pseudo-random bytes.
    fn image(size: [u32; 2]) -> Image {
        let bytes = (0..size[0] * size[1] * 4).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8);
        Image { name: String::new(), size, pixels: bytes.collect::<Arc<[u8]>>() }
    }

    #[test]
    fn several_places_have_the_values_of_single_ones() {
        const N: usize = 16;
        let transform = Affine2::from_scale_angle_translation(Vec2::new(1.5, 0.8), 0.3, Vec2::new(0.2, -0.4));
        let (mut compared, mut largest) = (0, 0.0_f32);
        for (size, content) in
            [([37, 16], Content::Color), ([64, 8], Content::Data), ([1, 1], Content::Color)]
        {
            let chain = Chain::new(&image(size), content);
            for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
                for is_nearest in [false, true] {
                    let sampling = Sampling { wrap: [wrap, Wrap::Repeat], is_nearest };
                    for case in 0..20 {
                        let value = |lane: usize, k: usize| {
                            ((case * 97 + lane * 31 + k * 17) as f32 * 0.618).sin()
                                * [3.0, 3.0, 0.2, 0.1, 0.05, 0.2][k]
                        };
                        let all = |k| std::array::from_fn(|lane| value(lane, k));
                        let of = CoordinatesOf {
                            at: [all(0), all(1)],
                            dx: [all(2), all(3)],
                            dy: [all(4), all(5)],
                        };
                        let found = chain.at_places::<N>(&of, N, &transform, sampling);
                        for lane in 0..N {
                            let at = |of: [[f32; N]; 2]| Vec2::new(of[0][lane], of[1][lane]);
                            let turn = transform.matrix2;
                            let lod = level_of_detail(turn * at(of.dx), turn * at(of.dy), size);
                            let wanted = chain.at(transform.transform_point2(at(of.at)), lod, sampling);
                            for c in 0..4 {
                                largest = largest.max((found[c][lane] - wanted[c]).abs());
                                compared += 1;
                            }
                        }
                    }
                }
            }
        }
        println!("{compared} values, largest difference {largest}");
        // Measured below.
        assert!(largest < 2e-4, "{largest}");
        // Control: half a texel beside, values differ.
        let chain = Chain::new(&image([64, 8]), Content::Data);
        let none = [[0.0; 1]; 2];
        let of = |x: f32| CoordinatesOf { at: [[x], [0.5]], dx: none, dy: none };
        let at = |x| chain.at_places(&of(x), 1, &Affine2::IDENTITY, Sampling::default())[0][0];
        assert!((at(0.5) - at(0.5 + 0.5 / 64.0)).abs() > 0.01);
    }
}
