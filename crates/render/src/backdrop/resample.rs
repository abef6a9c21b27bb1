//! Averages of a picture's pixels over those of an image.

use std::borrow::Cow;

use lovelock_appearance::environment::{BackdropPicture, BackdropPixels};
use lovelock_base::memory::list_bytes;
use rayon::prelude::*;

use super::{Encode, GROUP, Source, encoded_of, linear_of};

/// Red, green, blue, each times opacity, and opacity. Linear.
type Texel = [f32; 4];

/// The widest filter, standard deviations in texels: a wider one is applied to a smaller copy.
const WIDEST: f32 = 6.0;
/// Where the bell of the filter ends, standard deviations.
const REACH: f32 = 2.6;
/// The most light of a texel, that of the largest half float: sums of it stay finite.
const MOST_LIGHT: f32 = 65_504.0;

/// A copy of a picture in linear light whose sides were halved some times: each texel is the mean of those that it covers.
#[derive(Clone, Debug)]
pub(super) struct Reduced {
    pub(super) halvings: u32,
    size: [usize; 2],
    /// The size of the picture in texels; the last column and row may be covered in part.
    extent: [f32; 2],
    pub(super) texels: Vec<Texel>,
}

impl Reduced {
    /// The copy of a picture, without its brightness.
    pub fn new(picture: &BackdropPicture, halvings: u32) -> Self {
        let size = picture.size().map(|side| side as usize);
        let extent = size.map(|side| side as f32);
        match picture.pixels() {
            BackdropPixels::Display(pixels) => {
                let table: [f32; 256] = std::array::from_fn(|byte| linear_of(byte as f32 / 255.0));
                let texel = |at: usize| {
                    let [r, g, b, a] = pixels[at];
                    let opacity = f32::from(a) / 255.0;
                    let [r, g, b] = [r, g, b].map(|byte| table[usize::from(byte)] * opacity);
                    [r, g, b, opacity]
                };
                Self::of(halvings, (size, extent), halvings, texel)
            }
            BackdropPixels::Light(pixels) => {
                let texel = |at: usize| {
                    let [r, g, b] = pixels[at].map(|light| light.clamp(0.0, MOST_LIGHT));
                    [r, g, b, 1.0]
                };
                Self::of(halvings, (size, extent), halvings, texel)
            }
        }
    }

    /// A copy of half the size.
    fn halved(&self) -> Self {
        Self::of(self.halvings + 1, (self.size, self.extent), 1, |at| self.texels[at])
    }

    /// Means of `2^times` by `2^times` of the texels `at`.
    fn of(
        halvings: u32,
        ([width, height], extent): ([usize; 2], [f32; 2]),
        times: u32,
        at: impl Fn(usize) -> Texel + Sync,
    ) -> Self {
        let step = 1_usize << times;
        let size @ [columns, rows] = [width.div_ceil(step), height.div_ceil(step)];
        let share = 1.0 / (step as f32 * step as f32);
        let mut texels = vec![[0.0; 4]; columns * rows];
        texels.par_chunks_mut(columns).enumerate().for_each(|(y, row)| {
            for line in (y * step..(y + 1) * step).map(|line| line.min(height - 1) * width) {
                for (x, texel) in row.iter_mut().enumerate() {
                    for column in x * step..(x + 1) * step {
                        let from = at(line + column.min(width - 1));
                        (0..4).for_each(|c| texel[c] += share * from[c]);
                    }
                }
            }
        });
        Self { halvings, size, extent: extent.map(|side| side / step as f32), texels }
    }

    /// The standard deviation along an axis, texels, of the filter of a picture whose side is `side` pixels: half a texel where it is
    /// enlarged, half a pixel where it is reduced, and a blur of `blur` pixels. What halving has blurred is left out.
    fn sigma(&self, axis: usize, side: f32, blur: f32) -> f32 {
        let per_pixel = self.extent[axis] / side.max(1e-3);
        let blur = blur * per_pixel;
        // The variance of as many texels of the picture as one covers, in its own size.
        let halved = (1.0 - 0.25_f32.powi(self.halvings as i32)) / 12.0;
        (0.25 * (per_pixel * per_pixel).max(1.0) + blur * blur - halved).sqrt()
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> u64 {
        list_bytes(&self.texels)
    }
}

/// How often the sides of the picture of an image can be halved until it has one to two texels for each pixel.
pub(super) fn halvings(of: &Source) -> u32 {
    let mut extent = of.picture.size().map(|side| side as f32);
    let sides = of.fit.size(extent, of.size.map(|side| side as f32));
    let mut halvings = 0;
    while (0..2).all(|axis| 0.5 * extent[axis] >= sides[axis].max(1.0)) {
        extent = extent.map(|side| 0.5 * side);
        halvings += 1;
    }
    halvings
}

/// The texels along one axis that a pixel averages, and their weights.
struct Taps {
    first: usize,
    weights: Vec<f32>,
    /// The part of the pixel that the picture covers.
    cover: f32,
}

/// The taps of all pixels of one axis. The picture is `side` pixels long in the image, of `pixels`, and is covered by `texels` texels, the
/// last perhaps in part: it is `extent` long; the filter has the standard deviation `sigma`, texels.
fn taps(pixels: usize, side: f32, (texels, extent): (usize, f32), sigma: f32) -> Vec<Taps> {
    let start = 0.5 * (pixels as f32 - side);
    let per_pixel = extent / side.max(1e-3);
    let reach = (REACH * sigma).max(1.0);
    let tap = |pixel: usize| {
        let (low, high) = (pixel as f32, pixel as f32 + 1.0);
        let cover = (high.min(start + side) - low.max(start)).clamp(0.0, 1.0);
        let centre = (low + 0.5 - start) * per_pixel;
        let last = texels as f32 - 1.0;
        let first = (centre - reach).floor().clamp(0.0, last) as usize;
        let end = (centre + reach).ceil().clamp(0.0, last) as usize;
        let weight = |texel: usize| {
            let away = (texel as f32 + 0.5 - centre) / sigma;
            // Beyond the border the nearest texel remains.
            (-0.5 * away * away).exp().max(1e-20)
        };
        let mut weights: Vec<f32> = (first..=end).map(weight).collect();
        let sum: f32 = weights.iter().sum();
        for weight in &mut weights {
            *weight /= sum;
        }
        Taps { first, weights, cover }
    };
    (0..pixels).map(tap).collect()
}

/// The packed pixels of a picture in an image, from a copy of the picture.
pub(super) fn lay(of: &Source, copy: &Reduced, encode: Encode) -> Vec<u32> {
    let is_light = matches!(of.picture.pixels(), BackdropPixels::Light(_));
    let factor = of.stops.exp2();
    let [width, height] = of.size.map(|side| side as usize);
    let original = of.picture.size().map(|side| side as f32);
    let sides = of.fit.size(original, [width as f32, height as f32]);
    let blur = of.blur * height as f32;
    let mut copy = Cow::Borrowed(copy);
    while (0..2).all(|axis| copy.size[axis] > 1 && copy.sigma(axis, sides[axis], blur) > WIDEST) {
        copy = Cow::Owned(copy.halved());
    }
    let [columns, rows] = [(0, width), (1, height)].map(|(axis, pixels)| {
        let sigma = copy.sigma(axis, sides[axis], blur);
        taps(pixels, sides[axis], (copy.size[axis], copy.extent[axis]), sigma)
    });
    let mut border = of.border.to_array().map(|c| [c; GROUP]);
    encode(&mut border, of.exposure);
    let border = border.map(|[c, ..]| linear_of(c));
    let texels_per_row = copy.size[0];
    let mut out = vec![0; width * height];
    out.par_chunks_mut(width.max(1)).zip(&rows).for_each_init(
        Vec::new,
        |line: &mut Vec<Texel>, (out, row)| {
            line.clear();
            line.resize(texels_per_row, [0.0; 4]);
            for (k, weight) in row.weights.iter().enumerate() {
                let from = &copy.texels[(row.first + k) * texels_per_row..][..texels_per_row];
                for (sum, texel) in line.iter_mut().zip(from) {
                    (0..4).for_each(|c| sum[c] += weight * texel[c]);
                }
            }
            for (group, out) in out.chunks_mut(GROUP).enumerate() {
                let mut color = [[0.0; GROUP]; 3];
                let mut opacity = [0.0; GROUP];
                for (lane, tap) in columns[group * GROUP..].iter().take(out.len()).enumerate() {
                    let mut sum = [0.0; 4];
                    for (weight, texel) in tap.weights.iter().zip(&line[tap.first..]) {
                        (0..4).for_each(|c| sum[c] += weight * texel[c]);
                    }
                    let whole = if !is_light && sum[3] > 0.0 { sum[3] } else { 1.0 };
                    (0..3).for_each(|c| color[c][lane] = (sum[c] / whole * factor).min(MOST_LIGHT));
                    opacity[lane] = sum[3] * tap.cover * row.cover;
                }
                if is_light {
                    encode(&mut color, of.exposure);
                }
                for (lane, out) in out.iter_mut().enumerate() {
                    *out = [0, 1, 2].into_iter().fold(0, |packed, c| {
                        let shown =
                            if is_light { linear_of(color[c][lane]) } else { color[c][lane].min(1.0) };
                        let mixed = border[c] + opacity[lane] * (shown - border[c]);
                        let value = (encoded_of(mixed).clamp(0.0, 1.0) * 1023.0 + 0.5) as u32;
                        packed | value << (10 * c)
                    });
                }
            }
        },
    );
    out
}
