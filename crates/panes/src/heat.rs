//! False-colour images of errors: in memory, and the colours of those that a device draws.

use lovelock_metrics::{ColorMap, Image, flip, paint};
use lovelock_render::{ColorScale, FrameInput, Picture, RenderError, ValueRenderer};

/// Brightness of the image under the colours.
const BEHIND: f32 = 0.3;

/// The colours with which a device draws values up to `largest` as [`on_hair`] does.
pub(super) fn scale(colors: ColorMap, largest: f32) -> ColorScale {
    let (low, high) = colors.range_to(largest).into_inner();
    let table = std::array::from_fn(|k| colors.at(k as f32 / 255.0));
    ColorScale { range: [low, high], colors: table, behind: BEHIND, saturation: 0.0, relief: 0.0 }
}

/// Renders `values`, one per strand point, in colour over a dimmed grey image of the same hair. Twin of
/// `false_colors.wgsl`.
///
/// # Errors
/// If the size is out of range, or there is not one value per strand point.
pub(super) fn on_hair(
    renderer: &mut ValueRenderer,
    input: &FrameInput,
    values: &[f32],
    (colors, largest): (ColorMap, f32),
    picture: &mut Picture,
) -> Result<(), RenderError> {
    let drawn = renderer.picture(input, values, picture.width, picture.height)?;
    let painted = paint(&drawn.value, colors.range_to(largest), colors);
    let pixels = picture.rgba.chunks_exact_mut(4).zip(painted.chunks_exact(4)).zip(&drawn.weight);
    for ((pixel, color), &weight) in pixels {
        let [r, g, b] = [pixel[0], pixel[1], pixel[2]].map(f32::from);
        let grey = BEHIND * (0.2126 * r + 0.7152 * g + 0.0722 * b);
        let share = if color[3] == 0 || !weight.is_finite() { 0.0 } else { weight.clamp(0.0, 1.0) };
        for (out, &color) in pixel.iter_mut().zip(&color[..3]) {
            *out = (grey + share * (f32::from(color) - grey)).round() as u8;
        }
        pixel[3] = 255;
    }
    Ok(())
}

/// Replaces `picture` by its difference from `reference` (FLIP) in colour, and returns the mean. `picture` is resized to the
/// reference. FLIP is computed on the CPU, and so is the reference, so the pictures of every backend come to memory for it.
pub(super) fn of_pictures(reference: &Picture, largest: f32, picture: &mut Picture) -> Result<f64, String> {
    resize(picture, reference.width, reference.height);
    let test = Image::new(picture.width, picture.height, &picture.rgba).map_err(|error| error.to_string())?;
    let reference =
        Image::new(reference.width, reference.height, &reference.rgba).map_err(|error| error.to_string())?;
    let map = flip(&reference, &test).map_err(|error| error.to_string())?;
    let painted = paint(&map.values, ColorMap::Magma.range_to(largest), ColorMap::Magma);
    let mean = map.mean();
    picture.rgba = painted;
    Ok(mean)
}

/// Resizes an image with bilinear filtering, as the screen does.
pub(super) fn resize(picture: &mut Picture, width: u32, height: u32) {
    let whole = u64::from(picture.width) * u64::from(picture.height) * 4;
    if (picture.width, picture.height) == (width, height) || whole == 0 || picture.rgba.len() as u64 != whole
    {
        return;
    }
    let (from_width, from_height) = (picture.width as usize, picture.height as usize);
    let place = |i: u32, to: u32, from: usize| {
        let at = ((i as f32 + 0.5) * from as f32 / to as f32 - 0.5).clamp(0.0, from as f32 - 1.0);
        let first = at as usize;
        (first, (first + 1).min(from - 1), at - first as f32)
    };
    let columns: Vec<_> = (0..width).map(|x| place(x, width, from_width)).collect();
    let mut rgba = Vec::with_capacity(width as usize * height as usize * 4);
    for y in 0..height {
        let (top, bottom, down) = place(y, height, from_height);
        for &(left, right, across) in &columns {
            let at = |x: usize, y: usize, c: usize| f32::from(picture.rgba[(y * from_width + x) * 4 + c]);
            for c in 0..4 {
                let upper = at(left, top, c) + across * (at(right, top, c) - at(left, top, c));
                let lower = at(left, bottom, c) + across * (at(right, bottom, c) - at(left, bottom, c));
                rgba.push((upper + down * (lower - upper)).round() as u8);
            }
        }
    }
    *picture = Picture { width, height, rgba };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_resized_image_keeps_its_colours_and_gradients() {
        let ramp: Vec<u8> = (0..4_u8).flat_map(|x| [x * 60, 7, 200, 255]).collect();
        let mut picture = Picture { width: 4, height: 1, rgba: ramp };
        let same = picture.clone();
        resize(&mut picture, 4, 1);
        assert_eq!(picture, same);
        resize(&mut picture, 8, 3);
        assert_eq!((picture.width, picture.height, picture.rgba.len()), (8, 3, 96));
        let reds: Vec<u8> = picture.rgba.chunks_exact(4).take(8).map(|pixel| pixel[0]).collect();
        assert_eq!(reds, [0, 15, 45, 75, 105, 135, 165, 180]);
        assert!(picture.rgba.chunks_exact(4).all(|pixel| pixel[1..] == [7, 200, 255]));
        // An empty image stays empty.
        let mut empty = Picture::default();
        resize(&mut empty, 8, 8);
        assert_eq!(empty, Picture::default());
    }

    #[test]
    fn equal_images_give_black_and_others_do_not() {
        let grey = |v: u8| Picture { width: 8, height: 8, rgba: [v, v, v, 255].repeat(64) };
        let (reference, mut same, mut other) = (grey(90), grey(90), grey(200));
        assert_eq!(of_pictures(&reference, 1.0, &mut same), Ok(0.0));
        assert_eq!(same.rgba[..3], ColorMap::Magma.at(0.0));
        let mean = of_pictures(&reference, 1.0, &mut other).expect("a mean");
        assert!(mean > 0.1 && other.rgba[..3] != same.rgba[..3], "{mean}");
    }
}
