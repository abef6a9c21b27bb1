//! Burns a label into an image: settings and frame number.

use lovelock_metrics::Canvas;
use lovelock_render::{Layers, Picture};

/// Margin between the text and its box, and between the box and the image's edge, pixels.
const MARGIN: usize = 6;
const PAPER: [u8; 3] = [19, 20, 23];
const INK: [u8; 3] = [236, 238, 242];

/// Writes one line into the lower left corner, as far as it fits.
pub(super) fn burn_in(picture: &mut Picture, words: &str) {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let Some((canvas, box_width)) = written(words, width, height) else { return };
    if picture.rgba.len() != width * height * 4 {
        return;
    }
    let rows = picture.rgba.chunks_exact_mut(width * 4).skip(height - MARGIN - BOX_HEIGHT);
    for (row, written) in rows.zip(canvas.rgba().chunks_exact(box_width * 4)) {
        row[MARGIN * 4..][..box_width * 4].copy_from_slice(written);
    }
}

/// The same for linear light; depth and transmittance stay unchanged.
pub(super) fn burn_in_light(layers: &mut Layers, words: &str) {
    let (width, height) = (layers.width as usize, layers.height as usize);
    let Some((canvas, box_width)) = written(words, width, height) else { return };
    let linear = |byte: u8| {
        let c = f32::from(byte) / 255.0;
        if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    };
    let rows = layers.light.chunks_exact_mut(width).skip(height - MARGIN - BOX_HEIGHT);
    for (row, written) in rows.zip(canvas.rgba().chunks_exact(box_width * 4)) {
        for (pixel, &[r, g, b, _]) in row[MARGIN..].iter_mut().zip(written.as_chunks::<4>().0) {
            *pixel = [linear(r), linear(g), linear(b), 1.0];
        }
    }
}

const BOX_HEIGHT: usize = Canvas::LINE + 2 * MARGIN;

/// The box with its text, and its width; `None` if it does not fit into the image.
fn written(words: &str, width: usize, height: usize) -> Option<(Canvas, usize)> {
    let box_width = (Canvas::text_width(words) + 2 * MARGIN).min(width.saturating_sub(2 * MARGIN));
    if box_width <= 2 * MARGIN || height < BOX_HEIGHT + 2 * MARGIN {
        return None;
    }
    let mut canvas = Canvas::new(box_width, BOX_HEIGHT, PAPER);
    canvas.text(MARGIN as i32, MARGIN as i32, words, INK);
    Some((canvas, box_width))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(width: u32, height: u32) -> Picture {
        Picture { width, height, rgba: vec![128; (width * height * 4) as usize] }
    }

    #[test]
    fn the_label_is_in_the_lower_left_corner_and_nowhere_else() {
        let mut picture = grey(300, 80);
        burn_in(&mut picture, "frame 12");
        let changed = |x: usize, y: usize| picture.rgba[(y * 300 + x) * 4..][..4] != [128; 4];
        assert!(changed(8, 70), "the box");
        let bright = picture.rgba.chunks_exact(4).filter(|pixel| pixel[0] > 200).count();
        assert!(bright > 20, "letters: {bright} bright pixels");
        for (x, y) in [(2, 70), (290, 70), (8, 10), (8, 78)] {
            assert!(!changed(x, y), "{x}, {y}");
        }
        let mut other = grey(300, 80);
        burn_in(&mut other, "frame 13");
        assert_ne!(picture, other, "control: another number gives another image");
    }

    #[test]
    fn the_label_in_light_is_where_that_in_bytes_is() {
        let mut picture = grey(300, 80);
        burn_in(&mut picture, "frame 12");
        let mut layers = Layers {
            width: 300,
            height: 80,
            light: vec![[7.0, 7.0, 7.0, 0.5]; 300 * 80],
            ..Layers::default()
        };
        burn_in_light(&mut layers, "frame 12");
        for (light, pixel) in layers.light.iter().zip(picture.rgba.chunks_exact(4)) {
            assert_eq!(light[3] == 0.5, pixel == [128; 4], "{light:?} {pixel:?}");
        }
        let brightest = layers.light.iter().filter(|p| p[3] == 1.0).map(|p| p[0]).fold(0.0, f32::max);
        // 236 of 255, decoded.
        assert!((brightest - 0.839).abs() < 0.002, "{brightest}");
    }

    #[test]
    fn a_small_image_stays_unchanged_and_a_long_label_is_cut() {
        for (width, height) in [(0, 0), (8, 200), (200, 20)] {
            let mut picture = grey(width, height);
            burn_in(&mut picture, "frame 12");
            assert_eq!(picture, grey(width, height));
        }
        let mut picture = grey(60, 60);
        burn_in(&mut picture, &"long words ".repeat(50));
        assert_ne!(picture, grey(60, 60));
    }
}
