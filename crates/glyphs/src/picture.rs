//! Glyphs that are pictures, such as emoji.

use skrifa::bitmap::{BitmapData, BitmapStrikes};
use skrifa::instance::Size;
use skrifa::{FontRef, GlyphId};

/// The largest width and height of a stored picture, pixels.
const MAX: u32 = 1024;

/// A picture of a glyph: sRGB with straight opacity, rows from the top.
pub(crate) struct GlyphPicture {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) rgba: Vec<[u8; 4]>,
    /// Where its upper left corner is from the start of the glyph on the base line, pixels, y downward.
    pub(crate) left: f32,
    pub(crate) top: f32,
}

/// The picture of a glyph at `px` pixels per em; `None` if the font has none that can be read.
pub(crate) fn picture(font: &FontRef<'_>, glyph: GlyphId, px: f32) -> Option<GlyphPicture> {
    let stored = BitmapStrikes::new(font).glyph_for_size(Size::new(px), glyph)?;
    let (width, height, pixels) = match stored.data {
        BitmapData::Png(bytes) => decode(bytes)?,
        BitmapData::Bgra(bytes) => {
            let (width, height) = (stored.width as usize, stored.height as usize);
            let pixels = bytes.chunks_exact(4).map(|p| [p[2], p[1], p[0], p[3]]).collect::<Vec<_>>();
            (width, height, pixels)
        }
        BitmapData::Mask(_) => return None,
    };
    if width == 0 || height == 0 || pixels.len() != width * height {
        return None;
    }
    let scale = px / stored.ppem_y.max(1.0);
    let to = [width, height].map(|edge| ((edge as f32 * scale).round() as usize).clamp(1, MAX as usize));
    Some(GlyphPicture {
        width: to[0],
        height: to[1],
        rgba: resized(&pixels, [width, height], to),
        left: stored.inner_bearing_x * scale,
        top: -stored.inner_bearing_y * scale,
    })
}

fn decode(bytes: &[u8]) -> Option<(usize, usize, Vec<[u8; 4]>)> {
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::EXPAND | png::Transformations::STRIP_16);
    let mut reader = decoder.read_info().ok()?;
    let (width, height) = (reader.info().width, reader.info().height);
    if width > MAX || height > MAX {
        return None;
    }
    let mut buffer = vec![0; reader.output_buffer_size()?];
    let frame = reader.next_frame(&mut buffer).ok()?;
    let pixels: Vec<[u8; 4]> = match frame.color_type {
        png::ColorType::Rgba => buffer.chunks_exact(4).map(|p| [p[0], p[1], p[2], p[3]]).collect(),
        png::ColorType::Rgb => buffer.chunks_exact(3).map(|p| [p[0], p[1], p[2], 255]).collect(),
        png::ColorType::GrayscaleAlpha => buffer.chunks_exact(2).map(|p| [p[0], p[0], p[0], p[1]]).collect(),
        png::ColorType::Grayscale => buffer.iter().map(|p| [*p, *p, *p, 255]).collect(),
        png::ColorType::Indexed => return None,
    };
    Some((width as usize, height as usize, pixels))
}

/// The mean of the pixels that each new pixel covers, weighted by opacity.
fn resized(
    pixels: &[[u8; 4]],
    [width, height]: [usize; 2],
    [to_width, to_height]: [usize; 2],
) -> Vec<[u8; 4]> {
    let span = |at: usize, to: usize, from: usize| {
        let start = (at * from / to).min(from - 1);
        start..((at + 1) * from).div_ceil(to).clamp(start + 1, from)
    };
    let mut out = Vec::with_capacity(to_width * to_height);
    for y in 0..to_height {
        for x in 0..to_width {
            let mut sum = [0_u32; 4];
            let mut count = 0;
            for row in span(y, to_height, height) {
                for pixel in &pixels[row * width..][span(x, to_width, width)] {
                    let alpha = u32::from(pixel[3]);
                    for (total, channel) in sum.iter_mut().zip(pixel).take(3) {
                        *total += u32::from(*channel) * alpha;
                    }
                    sum[3] += alpha;
                    count += 1;
                }
            }
            let color = |k: usize| sum[k].checked_div(sum[3]).unwrap_or(0) as u8;
            out.push([color(0), color(1), color(2), (sum[3] / count.max(1)) as u8]);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smaller_picture_has_the_mean_of_what_it_covers() {
        let half = [[200, 0, 0, 255], [0, 0, 0, 0], [200, 0, 0, 255], [0, 0, 0, 0]];
        assert_eq!(resized(&half, [2, 2], [1, 1]), [[200, 0, 0, 127]]);
        assert_eq!(resized(&half, [2, 2], [2, 2]), half);
        assert_eq!(resized(&half[..1], [1, 1], [3, 2]).len(), 6);
    }

    #[test]
    fn a_damaged_picture_is_refused() {
        assert!(decode(b"no picture").is_none());
    }
}
