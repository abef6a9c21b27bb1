//! An image with its mip levels: each level is the one before, averaged over boxes in linear light.

use std::sync::{Arc, LazyLock};

use lovelock_motion::Image;
use rayon::prelude::*;

/// What the pixels of an image mean, which decides how they are averaged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Content {
    /// Colours in sRGB.
    Color,
    /// Colours in sRGB that count by their opacity, so that the colour of what is not seen does not bleed into what is.
    ColorByOpacity,
    /// As [`Content::ColorByOpacity`], of a mask that shows what has at least this byte of opacity (256: nothing). The opacity of all
    /// levels but the first is the share of texels that are shown, so that what is far away keeps its size.
    Mask(u16),
    /// Numbers, such as normals.
    Data,
}

impl Content {
    /// That of a mask with a cutoff of opacity.
    pub fn mask(cutoff: f32) -> Self {
        let first = (0..=255_u16).find(|&byte| f32::from(byte) * (1.0 / 255.0) >= cutoff);
        Self::Mask(first.unwrap_or(256))
    }

    /// The same with a cutoff that similar ones share: the nearest of 1, the multiples of 32, and 255. The first level, in which the
    /// exact one decides, does not depend on it.
    pub fn with_shared_cutoff(self) -> Self {
        match self {
            Self::Mask(cutoff @ 1..=255) => Self::Mask(((cutoff + 16) / 32 * 32).clamp(1, 255)),
            other => other,
        }
    }

    /// The value of each byte of red, green and blue.
    pub fn table(self) -> &'static [f32; 256] {
        static TABLES: LazyLock<[[f32; 256]; 2]> = LazyLock::new(|| {
            let plain: [f32; 256] = std::array::from_fn(|byte| byte as f32 / 255.0);
            [plain, plain.map(linear_of_srgb)]
        });
        &TABLES[usize::from(self != Self::Data)]
    }
}

/// One level of a [`Chain`].
#[derive(Clone, Debug)]
pub(crate) struct Level {
    /// Width and height, texels.
    pub size: [u32; 2],
    /// Red, green, blue and alpha of each texel, row after row from the top.
    pub texels: Arc<[u8]>,
}

/// An image and its mip levels, finest first. It has at least one, and each is as large as its size says.
#[derive(Clone, Debug)]
pub(crate) struct Chain {
    pub levels: Vec<Level>,
    pub content: Content,
}

impl Chain {
    /// The chain of an image down to one texel. An image of another length than its size says is one white texel.
    pub fn new(image: &Image, content: Content) -> Self {
        let [width, height] = image.size;
        let bytes = (width as usize).checked_mul(height as usize).and_then(|texels| texels.checked_mul(4));
        let mut level = if bytes == Some(image.pixels.len()) && bytes != Some(0) {
            Level { size: image.size, texels: Arc::clone(&image.pixels) }
        } else {
            Level { size: [1, 1], texels: Arc::new([255; 4]) }
        };
        let mut levels = Vec::new();
        while level.size != [1, 1] {
            let next = halved(&level, content, levels.is_empty());
            levels.push(level);
            level = next;
        }
        levels.push(level);
        Self { levels, content }
    }

    /// The memory of all levels but the first, which belongs to the image, bytes.
    pub fn own_bytes(&self) -> u64 {
        self.levels.iter().skip(1).map(|level| level.texels.len() as u64).sum()
    }
}

/// The memory of all levels but the first of an image of `size`, bytes.
pub(super) fn levels_bytes(mut size: [u32; 2]) -> u64 {
    let mut bytes = 0_u64;
    while size.iter().any(|&side| side > 1) {
        size = size.map(|side| (side / 2).max(1));
        bytes = bytes.saturating_add(u64::from(size[0]).saturating_mul(u64::from(size[1])).saturating_mul(4));
    }
    bytes
}

/// The texels of a row or column that one of the next level averages, and their weights.
struct Taps {
    first: usize,
    weights: [f32; 3],
    count: usize,
}

/// How `n` texels become half as many, rounded down and at least 1: each covers `n / m` of them, also where that is not whole.
fn taps(n: usize) -> Vec<Taps> {
    let m = (n / 2).max(1);
    let width = n as f32 / m as f32;
    (0..m)
        .map(|i| {
            // Integers: the ends are i n / m and (i + 1) n / m.
            let first = i * n / m;
            let last = ((i + 1) * n).div_ceil(m).min(n);
            let mut weights = [0.0; 3];
            for (k, weight) in weights.iter_mut().enumerate().take(last - first) {
                let low = (i as f32 * width).max((first + k) as f32);
                let high = ((i + 1) as f32 * width).min((first + k + 1) as f32);
                *weight = (high - low).max(0.0) / width;
            }
            Taps { first, weights, count: (last - first).min(3) }
        })
        .collect()
}

/// The next level; `is_first` is whether `level` is the image itself.
fn halved(level: &Level, content: Content, is_first: bool) -> Level {
    let opacity: [f32; 256] = std::array::from_fn(|byte| match content {
        Content::Mask(cutoff) if is_first => f32::from(u8::from(byte >= usize::from(cutoff))),
        _ => byte as f32 * (1.0 / 255.0),
    });
    let [width, height] = level.size.map(|side| side as usize);
    let (columns, rows) = (taps(width), taps(height));
    let decode = content.table();
    let mut texels = vec![0_u8; columns.len() * rows.len() * 4];
    texels.par_chunks_mut(columns.len() * 4).zip(&rows).for_each(|(out, row)| {
        for (out, column) in out.as_chunks_mut::<4>().0.iter_mut().zip(&columns) {
            let (mut plain, mut weighted, mut alpha) = ([0.0; 3], [0.0; 3], 0.0);
            for (j, by) in row.weights.iter().enumerate().take(row.count) {
                let line = &level.texels[(row.first + j) * width * 4..];
                for (i, bx) in column.weights.iter().enumerate().take(column.count) {
                    let [r, g, b, a] = *texel(line, column.first + i);
                    let (weight, a) = (bx * by, opacity[usize::from(a)]);
                    alpha += weight * a;
                    for (c, byte) in [r, g, b].into_iter().enumerate() {
                        let value = decode[usize::from(byte)];
                        plain[c] += weight * value;
                        weighted[c] += weight * a * value;
                    }
                }
            }
            let by_opacity = matches!(content, Content::ColorByOpacity | Content::Mask(_)) && alpha > 0.0;
            let color = if by_opacity { weighted.map(|c| c / alpha) } else { plain };
            let [r, g, b] = color.map(|c| encode(c, content));
            *out = [r, g, b, byte_of(alpha)];
        }
    });
    Level { size: [columns.len() as u32, rows.len() as u32], texels: texels.into() }
}

/// The texel at an index of a row; black if there is none.
#[inline]
pub(super) fn texel(texels: &[u8], at: usize) -> &[u8; 4] {
    texels.as_chunks::<4>().0.get(at).unwrap_or(&[0; 4])
}

fn byte_of(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

fn encode(value: f32, content: Content) -> u8 {
    /// Steps of the table. They are even in the square root, and finer than a byte everywhere.
    const STEPS: usize = 4096;
    static TABLE: LazyLock<Vec<u8>> = LazyLock::new(|| {
        let of = |step: usize| (step as f32 / (STEPS - 1) as f32).powi(2);
        (0..STEPS).map(|step| byte_of(srgb_of_linear(of(step)))).collect()
    });
    if content == Content::Data {
        return byte_of(value);
    }
    let step = (value.clamp(0.0, 1.0).sqrt() * (STEPS - 1) as f32 + 0.5) as usize;
    TABLE.get(step).copied().unwrap_or(255)
}

/// The curve of sRGB (IEC 61966-2-1).
fn linear_of_srgb(value: f32) -> f32 {
    if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

fn srgb_of_linear(value: f32) -> f32 {
    if value <= 0.003_130_8 { 12.92 * value } else { 1.055 * value.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(size: [u32; 2], of: impl Fn(u32, u32) -> [u8; 4]) -> Image {
        let pixels: Vec<u8> = (0..size[0] * size[1]).flat_map(|i| of(i % size[0], i / size[0])).collect();
        Image { name: String::new(), size, pixels: pixels.into() }
    }

    #[test]
    fn a_checker_becomes_half_the_light_and_not_half_the_byte() {
        let checker = image([8, 8], |x, y| if (x + y) % 2 == 0 { [255; 4] } else { [0, 0, 0, 255] });
        let chain = Chain::new(&checker, Content::Color);
        let sizes: Vec<_> = chain.levels.iter().map(|level| level.size).collect();
        assert_eq!(sizes, [[8, 8], [4, 4], [2, 2], [1, 1]]);
        assert_eq!((chain.own_bytes(), levels_bytes([8, 8])), (4 * 21, 4 * 21));
        // sRGB of 0.5 is 187.5 of 255; half the byte would be 128.
        for level in &chain.levels[1..] {
            for texel in level.texels.as_chunks::<4>().0 {
                assert!((187..=188).contains(&texel[0]), "{texel:?}");
                assert_eq!(texel[3], 255);
            }
        }
        let data = Chain::new(&checker, Content::Data);
        assert_eq!(data.levels[1].texels[0], 128, "numbers are averaged as they are");
    }

    #[test]
    fn odd_sizes_average_all_texels_with_equal_weight() {
        // Of 5 columns the middle one is shared by both of the next level.
        let ramp = image([5, 1], |x, _| [[0, 50, 100, 150, 200][x as usize]; 4]);
        let chain = Chain::new(&ramp, Content::Data);
        let level = &chain.levels[1];
        assert_eq!(level.size, [2, 1]);
        // (0 + 50 + 100/2) / 2.5 and (100/2 + 150 + 200) / 2.5.
        assert_eq!((level.texels[0], level.texels[4]), (40, 160));
        assert_eq!(chain.levels[2].texels[0], 100, "the mean of all");
        for n in 1..40 {
            let mut weights = vec![0.0; n];
            for taps in taps(n) {
                for k in 0..taps.count {
                    weights[taps.first + k] += taps.weights[k];
                }
                assert!((taps.weights.iter().sum::<f32>() - 1.0).abs() < 1e-5, "{n}");
            }
            let even = (n / 2).max(1) as f32 / n as f32;
            assert!(weights.iter().all(|weight| (weight - even).abs() < 1e-5), "{n}: {weights:?}");
        }
    }

    #[test]
    fn the_colour_of_what_is_not_seen_does_not_bleed() {
        let edge = image([2, 1], |x, _| if x == 0 { [200, 100, 50, 255] } else { [0, 255, 0, 0] });
        let last = |content| Chain::new(&edge, content).levels[1].texels.to_vec();
        assert_eq!(last(Content::ColorByOpacity), [200, 100, 50, 128]);
        assert!(last(Content::Color)[1] > 150, "the control: by area green bleeds in");
    }

    #[test]
    fn a_mask_keeps_the_share_that_it_shows() {
        // Stripes: one of four columns is opaque, and the others nearly as opaque as the cutoff asks.
        let stripes = image([16, 16], |x, _| if x % 4 == 0 { [200, 100, 50, 255] } else { [0, 0, 0, 120] });
        let chain = Chain::new(&stripes, Content::mask(0.5));
        assert_eq!(chain.levels[0].texels[..8], [200, 100, 50, 255, 0, 0, 0, 120], "the image itself");
        assert_eq!(chain.levels[1].texels[..8], [200, 100, 50, 128, 0, 0, 0, 0]);
        for level in &chain.levels[2..] {
            assert!(level.texels.as_chunks::<4>().0.iter().all(|texel| *texel == [200, 100, 50, 64]));
        }
        // The control: the mean opacity of the stripes, which a cutoff of one half would show as a whole.
        let mean = Chain::new(&stripes, Content::ColorByOpacity);
        assert!(mean.levels[2].texels[3] > 128);
        let all = |cutoff| Chain::new(&stripes, Content::mask(cutoff)).levels[4].texels[3];
        assert_eq!([0.0, 0.4, 1.0, 1.01].map(all), [255, 255, 64, 0]);
    }

    #[test]
    fn every_byte_comes_back_from_light_and_wrong_lengths_are_white() {
        for byte in 0..=255_u8 {
            let value = Content::Color.table()[usize::from(byte)];
            assert_eq!(encode(value, Content::Color), byte);
            assert_eq!(encode(Content::Data.table()[usize::from(byte)], Content::Data), byte);
        }
        let short = Image { name: String::new(), size: [4, 4], pixels: Arc::new([1, 2, 3, 4]) };
        let chain = Chain::new(&short, Content::Color);
        assert_eq!((chain.levels.len(), &chain.levels[0].texels[..]), (1, &[255; 4][..]));
    }
}
