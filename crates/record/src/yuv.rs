//! Conversion of sRGB images to the planes that H.264 encodes, and back.
//!
//! ITU-R BT.709-6, section 3, 8 bits, limited range: with R', G', B' in 0..=1,
//!
//! ```text
//! Y' = 0.2126 R' + 0.7152 G' + 0.0722 B'        luma   = 16 + 219 Y'
//! Pb = (B' − Y') / 1.8556                       chroma = 128 + 224 Pb
//! Pr = (R' − Y') / 1.5748                       chroma = 128 + 224 Pr
//! ```
//!
//! Chroma has half the resolution in each direction. Its samples lie on the even columns and midway between two rows, the
//! default of H.264 (ITU-T H.264, figure 6-1). It is therefore filtered by 1-2-1 along the row and averaged over the two
//! rows. A plain 2×2 average would shift the colours by half a pixel.

use crate::dither::Dither;

/// Fraction bits of the fixed-point coefficients and of the noise.
const BITS: u32 = 16;

/// Luma of black and white, 0 and 219 codes above the offset of 16.
const WHITE: i32 = 219 << BITS;

/// Largest difference of luma among 2×2 pixels of a smooth area: 2.5 codes. Only smooth areas are dithered, so that hair stays
/// sharp and costs no more.
const SMOOTH: i32 = 5 << (BITS - 1);

/// `x · scale / 255` in fixed point.
const fn fixed(x: f64, scale: f64) -> i32 {
    let value = x * scale / 255.0 * (1 << BITS) as f64;
    (if value < 0.0 { value - 0.5 } else { value + 0.5 }) as i32
}

const LUMA: [i32; 3] = [fixed(0.2126, 219.0), fixed(0.7152, 219.0), fixed(0.0722, 219.0)];
// The middle coefficients are what the others leave to zero, so that greys become exactly 128.
const BLUE: [i32; 3] =
    [fixed(-0.2126 / 1.8556, 224.0), -fixed(-0.2126 / 1.8556, 224.0) - fixed(0.5, 224.0), fixed(0.5, 224.0)];
const RED: [i32; 3] =
    [fixed(0.5, 224.0), -fixed(-0.0722 / 1.5748, 224.0) - fixed(0.5, 224.0), fixed(-0.0722 / 1.5748, 224.0)];

/// One image as three planes, 4:2:0: luma of every pixel, chroma of every second column and row.
pub(crate) struct Planes {
    width: usize,
    height: usize,
    luma: Vec<u8>,
    blue: Vec<u8>,
    red: Vec<u8>,
    dither: Dither,
    /// Sums over two rows of R, G and B, with one column repeated on the left. Scratch of [`Planes::read_rgba`].
    sums: [Vec<u16>; 3],
    /// Luma of two rows in fixed point, without the offset. Scratch of [`Planes::read_rgba`].
    weighted: [Vec<i32>; 2],
}

impl Planes {
    /// Planes for an even size in pixels.
    pub(crate) fn new(width: usize, height: usize, dither: Dither) -> Self {
        debug_assert!(width.is_multiple_of(2) && height.is_multiple_of(2));
        let quarter = width / 2 * (height / 2);
        Self {
            width,
            height,
            luma: vec![0; width * height],
            blue: vec![0; quarter],
            red: vec![0; quarter],
            dither,
            sums: [vec![0; width + 1], vec![0; width + 1], vec![0; width + 1]],
            weighted: [vec![0; width], vec![0; width]],
        }
    }

    /// Converts an image, `width × height` pixels of RGBA. Alpha is ignored: a film has none.
    pub(crate) fn read_rgba(&mut self, rgba: &[u8]) {
        let (width, dither) = (self.width, &self.dither);
        let [sum_r, sum_g, sum_b] = &mut self.sums;
        let [weighted_upper, weighted_lower] = &mut self.weighted;
        let row_pairs = rgba.chunks_exact(width * 8);
        let luma_pairs = self.luma.chunks_exact_mut(width * 2);
        let chroma_rows = self.blue.chunks_exact_mut(width / 2).zip(self.red.chunks_exact_mut(width / 2));
        for (row, ((pair, luma), (blue, red))) in row_pairs.zip(luma_pairs).zip(chroma_rows).enumerate() {
            let (upper, lower) = pair.split_at(width * 4);
            let (luma_upper, luma_lower) = luma.split_at_mut(width);
            weigh_row(upper, weighted_upper);
            weigh_row(lower, weighted_lower);
            let sums = sum_r[1..].iter_mut().zip(&mut sum_g[1..]).zip(&mut sum_b[1..]);
            let pixels = upper.chunks_exact(4).zip(lower.chunks_exact(4));
            for (((r, g), b), (a, c)) in sums.zip(pixels) {
                *r = u16::from(a[0]) + u16::from(c[0]);
                *g = u16::from(a[1]) + u16::from(c[1]);
                *b = u16::from(a[2]) + u16::from(c[2]);
            }
            sum_r[0] = sum_r[1];
            sum_g[0] = sum_g[1];
            sum_b[0] = sum_b[1];
            for (column, (blue, red)) in blue.iter_mut().zip(red.iter_mut()).enumerate() {
                let at = column * 2;
                let cell =
                    [weighted_upper[at], weighted_upper[at + 1], weighted_lower[at], weighted_lower[at + 1]];
                let range =
                    cell.into_iter().fold(i32::MIN, i32::max) - cell.into_iter().fold(i32::MAX, i32::min);
                let is_smooth = range <= SMOOTH;
                let noise = if is_smooth { dither.luma.at(at, row * 2) } else { 0 };
                let [a, b, c, d] = cell.map(|weighted| luma_code(weighted, noise));
                luma_upper[at..at + 2].copy_from_slice(&[a, b]);
                luma_lower[at..at + 2].copy_from_slice(&[c, d]);
                // Two rows of 1-2-1: weights of 8 in all, hence three more bits to shift out.
                let filtered = |sums: &[u16]| {
                    let sums = &sums[at..at + 3];
                    i32::from(sums[0]) + 2 * i32::from(sums[1]) + i32::from(sums[2])
                };
                let (r, g, b) = (filtered(sum_r), filtered(sum_g), filtered(sum_b));
                let code = |weights: [i32; 3], noise: i32| {
                    let noise = if is_smooth { noise << 3 } else { 0 };
                    let weighted = weights[0] * r + weights[1] * g + weights[2] * b + noise;
                    (((weighted + (1 << (BITS + 2))) >> (BITS + 3)) + 128).clamp(16, 240) as u8
                };
                *blue = code(BLUE, dither.blue.at(column, row));
                *red = code(RED, dither.red.at(column, row));
            }
        }
    }
}

/// Luma of a row of RGBA pixels in fixed point, without the offset.
fn weigh_row(rgba: &[u8], weighted: &mut [i32]) {
    for (weighted, pixel) in weighted.iter_mut().zip(rgba.chunks_exact(4)) {
        *weighted =
            LUMA[0] * i32::from(pixel[0]) + LUMA[1] * i32::from(pixel[1]) + LUMA[2] * i32::from(pixel[2]);
    }
}

/// Rounds luma to its code. Noise is limited to the distance from black and white, so that they stay as they are and the mean
/// does not change beside them.
fn luma_code(weighted: i32, noise: i32) -> u8 {
    let limit = weighted.min(WHITE - weighted).max(0);
    (((weighted + noise.clamp(-limit, limit) + (1 << (BITS - 1))) >> BITS) + 16) as u8
}

impl openh264::formats::YUVSource for Planes {
    fn dimensions(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    fn strides(&self) -> (usize, usize, usize) {
        (self.width, self.width / 2, self.width / 2)
    }

    fn y(&self) -> &[u8] {
        &self.luma
    }

    fn u(&self) -> &[u8] {
        &self.blue
    }

    fn v(&self) -> &[u8] {
        &self.red
    }
}

/// Converts planes back to RGBA (alpha 255), chroma interpolated along the row where its samples lie.
///
/// The inverse of [`Planes::read_rgba`] except for the lost chroma resolution. Used to read films back and in tests.
pub(crate) fn write_rgba(source: &impl openh264::formats::YUVSource, rgba: &mut Vec<u8>) {
    let (width, height) = source.dimensions();
    let (luma_stride, blue_stride, red_stride) = source.strides();
    rgba.clear();
    rgba.reserve(width * height * 4);
    for row in 0..height {
        let luma = &source.y()[row * luma_stride..][..width];
        let blue = &source.u()[row / 2 * blue_stride..][..width / 2];
        let red = &source.v()[row / 2 * red_stride..][..width / 2];
        for (column, &luma) in luma.iter().enumerate() {
            let left = column / 2;
            let right = if column % 2 == 0 { left } else { (left + 1).min(width / 2 - 1) };
            let chroma = |plane: &[u8]| f32::midpoint(plane[left].into(), plane[right].into()) - 128.0;
            let (y, pb, pr) = ((f32::from(luma) - 16.0) / 219.0, chroma(blue) / 224.0, chroma(red) / 224.0);
            let (r, b) = (y + 1.5748 * pr, y + 1.8556 * pb);
            let g = (y - 0.2126 * r - 0.0722 * b) / 0.7152;
            rgba.extend([r, g, b].map(|x| (x * 255.0).round().clamp(0.0, 255.0) as u8));
            rgba.push(255);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Planes, write_rgba};
    use crate::dither::Dither;

    /// Planes without dithering.
    fn planes(width: usize, height: usize) -> Planes {
        Planes::new(width, height, Dither::none())
    }

    fn flat(colour: [u8; 3]) -> (u8, u8, u8) {
        let mut planes = planes(4, 4);
        planes.read_rgba(&[colour[0], colour[1], colour[2], 255].repeat(16));
        (planes.luma[5], planes.blue[1], planes.red[1])
    }

    /// BT.709 colour bars at 100 %, from published tables of 8-bit codes.
    #[test]
    fn primaries_have_the_published_codes() {
        for (colour, codes) in [
            ([255, 255, 255], (235, 128, 128)),
            ([0, 0, 0], (16, 128, 128)),
            ([255, 255, 0], (219, 16, 138)),
            ([0, 255, 255], (188, 154, 16)),
            ([0, 255, 0], (173, 42, 26)),
            ([255, 0, 255], (78, 214, 230)),
            ([255, 0, 0], (63, 102, 240)),
            ([0, 0, 255], (32, 240, 118)),
        ] {
            assert_eq!(flat(colour), codes, "{colour:?}");
        }
    }

    #[test]
    fn greys_have_no_chroma_and_rise() {
        let mut last = 0;
        for grey in 0..=255 {
            let (luma, blue, red) = flat([grey; 3]);
            assert_eq!((blue, red), (128, 128), "{grey}");
            assert!(luma >= last && (16..=235).contains(&luma));
            last = luma;
        }
    }

    #[test]
    fn flat_colours_come_back() {
        for colour in [[10_u8, 200, 90], [90, 45, 20], [250, 250, 240], [1, 2, 3], [128, 0, 64]] {
            let mut planes = planes(6, 4);
            planes.read_rgba(&[colour[0], colour[1], colour[2], 0].repeat(24));
            let mut rgba = Vec::new();
            write_rgba(&planes, &mut rgba);
            for pixel in rgba.chunks_exact(4) {
                for (was, is) in colour.iter().zip(pixel) {
                    // One code of blue-difference chroma is 1.8556 · 255 / 224 = 2.1 steps of blue, half of it rounding.
                    assert!(was.abs_diff(*is) <= 2, "{colour:?} came back as {pixel:?}");
                }
            }
        }
    }

    /// A colour edge at an even column. The sample on the column right of the edge weighs its neighbours 1-2-1, so three
    /// quarters of its weight are right of the edge. A centred 2×2 average would put all of the weight there.
    #[test]
    fn chroma_lies_on_the_even_columns() {
        let mut planes = planes(8, 2);
        let row: Vec<u8> =
            (0..8).flat_map(|x| if x < 4 { [0, 0, 0, 255] } else { [0, 0, 255, 255] }).collect();
        planes.read_rgba(&[row.clone(), row].concat());
        assert_eq!(planes.blue, [128, 128, 128 + 84, 240]);
    }

    #[test]
    fn odd_rows_and_even_rows_weigh_the_same() {
        let mut planes = planes(2, 2);
        planes.read_rgba(&[0, 0, 255, 255, 0, 0, 255, 255, 0, 0, 0, 255, 0, 0, 0, 255]);
        assert_eq!(planes.blue, [128 + 56]);
        assert_eq!(planes.luma, [32, 32, 16, 16]);
    }

    /// A grey between two codes, as noise leaves it on average; a rounded one is half a code off.
    #[test]
    fn dithering_keeps_the_mean_of_smooth_areas_and_spares_edges() {
        let (width, height) = (256, 256);
        // Grey 33 is luma 16 + 28.34.
        let grey = [33, 33, 33, 255].repeat(width * height);
        let mean = |dither: Dither| {
            let mut planes = Planes::new(width, height, dither);
            planes.read_rgba(&grey);
            planes.luma.iter().map(|&code| f64::from(code)).sum::<f64>() / planes.luma.len() as f64
        };
        let exact = 16.0 + 33.0 * 219.0 / 255.0;
        let (dithered, rounded) = (mean(Dither::for_quantiser(20)), mean(Dither::none()));
        assert!((dithered - exact).abs() < 0.04, "{dithered} {exact}");
        assert!((rounded - exact).abs() > 0.3, "{rounded} {exact}");
        // Black, white and pixels that differ from their neighbours have no noise.
        let stripes: Vec<u8> = (0..width * height).flat_map(|x| [60 + x as u8 % 2 * 8; 4]).collect();
        for image in [vec![0; grey.len()], vec![255; grey.len()], stripes] {
            let [with, without] = [Dither::for_quantiser(20), Dither::none()].map(|dither| {
                let mut planes = Planes::new(width, height, dither);
                planes.read_rgba(&image);
                planes.luma
            });
            assert_eq!(with, without);
        }
    }
}
