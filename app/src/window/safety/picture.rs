//! Small pictures of projects.

use lovelock_project::journal::Picture;
use lovelock_render::Image;

/// Longest side, pixels.
const SIDE: u32 = 192;

/// An image made small: means of its pixels. `None` if it is empty or its device is lost.
pub(in crate::window) fn small(image: &Image) -> Option<Picture> {
    let [width, height] = image.size();
    let step = width.max(height).div_ceil(SIDE).max(1);
    let (small_width, small_height) = (width / step, height / step);
    if small_width == 0 || small_height == 0 {
        return None;
    }
    let picture = image.picture().ok()?;
    let mut rgba = Vec::with_capacity((small_width * small_height * 4) as usize);
    for y in 0..small_height {
        for x in 0..small_width {
            let mut sums = [0_u32; 4];
            for row in y * step..(y + 1) * step {
                let start = ((row * width + x * step) * 4) as usize;
                for pixel in picture.rgba.get(start..start + step as usize * 4)?.chunks_exact(4) {
                    sums.iter_mut().zip(pixel).for_each(|(sum, value)| *sum += u32::from(*value));
                }
            }
            rgba.extend(sums.map(|sum| (sum / (step * step)) as u8));
        }
    }
    Some(Picture { width: small_width, height: small_height, rgba })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    #[test]
    fn a_large_image_becomes_its_means() {
        let (width, height) = (400_u32, 200_u32);
        // Left half black, right half white.
        let rgba = (0..width * height).flat_map(|k| if k % width < 200 { [0, 0, 0, 255] } else { [255; 4] });
        let picture = lovelock_render::Picture { width, height, rgba: rgba.collect() };
        let small = small(&Image::Memory(Arc::new(picture))).expect("a picture");
        assert_eq!((small.width, small.height), (133, 66));
        let pixel = |x: usize| small.rgba[4 * (133 * 30 + x)];
        assert_eq!((pixel(10), pixel(120)), (0, 255));
        assert!((80..=175).contains(&pixel(66)), "the pixel on the edge: {}", pixel(66));
        assert!(super::small(&Image::default()).is_none());
    }
}
