//! sRGB pictures to the planes that H.264 codes, and back.
//!
//! ITU-R BT.709-6, section 3, 8 bits, limited range: with R', G', B' in 0..=1,
//!
//! ```text
//! Y' = 0.2126 R' + 0.7152 G' + 0.0722 B'        luma   = 16 + 219 Y'
//! Pb = (B' − Y') / 1.8556                       chroma = 128 + 224 Pb
//! Pr = (R' − Y') / 1.5748                       chroma = 128 + 224 Pr
//! ```
//!
//! Chroma has half the resolution each way. Its samples lie on the even columns and midway between two rows, which is
//! what H.264 means where a stream says nothing else (ITU-T H.264, figure 6-1), so it is filtered by 1-2-1 along
//! the row and averaged over the two rows. A plain 2×2 average would shift the colours by half a pixel.

/// Fraction bits of the fixed-point coefficients.
const BITS: u32 = 16;

/// `x · scale / 255` in fixed point.
const fn fixed(x: f64, scale: f64) -> i32 {
    let value = x * scale / 255.0 * (1 << BITS) as f64;
    (if value < 0.0 { value - 0.5 } else { value + 0.5 }) as i32
}

const LUMA: [i32; 3] = [fixed(0.2126, 219.0), fixed(0.7152, 219.0), fixed(0.0722, 219.0)];
// The middle coefficients are the rests, so that greys come out as exactly 128.
const BLUE: [i32; 3] =
    [fixed(-0.2126 / 1.8556, 224.0), -fixed(-0.2126 / 1.8556, 224.0) - fixed(0.5, 224.0), fixed(0.5, 224.0)];
const RED: [i32; 3] =
    [fixed(0.5, 224.0), -fixed(-0.0722 / 1.5748, 224.0) - fixed(0.5, 224.0), fixed(-0.0722 / 1.5748, 224.0)];

/// One picture as three planes, 4:2:0: luma of every pixel, chroma of every second column and row.
pub(crate) struct Planes {
    width: usize,
    height: usize,
    luma: Vec<u8>,
    blue: Vec<u8>,
    red: Vec<u8>,
    /// Sums over two rows of R, G and B, with one column repeated on the left. Scratch of [`Planes::read_rgba`].
    sums: [Vec<u16>; 3],
}

impl Planes {
    /// Planes for an even size in pixels.
    pub(crate) fn new(width: usize, height: usize) -> Self {
        debug_assert!(width.is_multiple_of(2) && height.is_multiple_of(2));
        let quarter = width / 2 * (height / 2);
        Self {
            width,
            height,
            luma: vec![0; width * height],
            blue: vec![0; quarter],
            red: vec![0; quarter],
            sums: [vec![0; width + 1], vec![0; width + 1], vec![0; width + 1]],
        }
    }

    /// Converts a picture, `width × height` pixels of RGBA. Alpha is ignored: a film has none.
    pub(crate) fn read_rgba(&mut self, rgba: &[u8]) {
        let width = self.width;
        let [sum_r, sum_g, sum_b] = &mut self.sums;
        let row_pairs = rgba.chunks_exact(width * 8);
        let luma_pairs = self.luma.chunks_exact_mut(width * 2);
        let chroma_rows = self.blue.chunks_exact_mut(width / 2).zip(self.red.chunks_exact_mut(width / 2));
        for ((pair, luma), (blue, red)) in row_pairs.zip(luma_pairs).zip(chroma_rows) {
            let (upper, lower) = pair.split_at(width * 4);
            let (luma_upper, luma_lower) = luma.split_at_mut(width);
            luma_row(upper, luma_upper);
            luma_row(lower, luma_lower);
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
                // Two rows of 1-2-1: weights of 8 in all, hence three more bits to shift out.
                let filtered = |sums: &[u16]| {
                    let at = &sums[column * 2..column * 2 + 3];
                    i32::from(at[0]) + 2 * i32::from(at[1]) + i32::from(at[2])
                };
                let (r, g, b) = (filtered(sum_r), filtered(sum_g), filtered(sum_b));
                let half = 1 << (BITS + 2);
                *blue = (((BLUE[0] * r + BLUE[1] * g + BLUE[2] * b + half) >> (BITS + 3)) + 128) as u8;
                *red = (((RED[0] * r + RED[1] * g + RED[2] * b + half) >> (BITS + 3)) + 128) as u8;
            }
        }
    }
}

fn luma_row(rgba: &[u8], luma: &mut [u8]) {
    for (luma, pixel) in luma.iter_mut().zip(rgba.chunks_exact(4)) {
        let weighted =
            LUMA[0] * i32::from(pixel[0]) + LUMA[1] * i32::from(pixel[1]) + LUMA[2] * i32::from(pixel[2]);
        *luma = (((weighted + (1 << (BITS - 1))) >> BITS) + 16) as u8;
    }
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
/// The reverse of [`Planes::read_rgba`] up to the lost chroma resolution; for looking at films and testing them.
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

    fn flat(colour: [u8; 3]) -> (u8, u8, u8) {
        let mut planes = Planes::new(4, 4);
        planes.read_rgba(&[colour[0], colour[1], colour[2], 255].repeat(16));
        (planes.luma[5], planes.blue[1], planes.red[1])
    }

    /// BT.709 colour bars at 100 % as printed in tables of 8-bit codes.
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
            let mut planes = Planes::new(6, 4);
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

    /// A colour edge at an even column: the sample on the edge's right column weighs its neighbours 1-2-1, so three
    /// quarters of the weight are right of it. A centred 2×2 average would have all of it there: the negative control.
    #[test]
    fn chroma_lies_on_the_even_columns() {
        let mut planes = Planes::new(8, 2);
        let row: Vec<u8> =
            (0..8).flat_map(|x| if x < 4 { [0, 0, 0, 255] } else { [0, 0, 255, 255] }).collect();
        planes.read_rgba(&[row.clone(), row].concat());
        assert_eq!(planes.blue, [128, 128, 128 + 84, 240]);
    }

    #[test]
    fn odd_rows_and_even_rows_weigh_the_same() {
        let mut planes = Planes::new(2, 2);
        planes.read_rgba(&[0, 0, 255, 255, 0, 0, 255, 255, 0, 0, 0, 255, 0, 0, 0, 255]);
        assert_eq!(planes.blue, [128 + 56]);
        assert_eq!(planes.luma, [32, 32, 16, 16]);
    }
}
