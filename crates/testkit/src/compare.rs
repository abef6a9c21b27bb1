//! Comparison of images.

use lovelock_metrics::Image;

/// The perceived difference of two images by FLIP (Andersson et al. 2020): 0 is none, 1 is the maximum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flip {
    /// Mean over all pixels.
    pub mean: f32,
    /// 99th percentile over all pixels, each weighted by its own difference.
    pub p99: f32,
}

/// FLIP of two images of `width` by `height` pixels, four bytes per pixel, sRGB encoded; alpha is ignored.
///
/// # Panics
/// If the bytes are not images of this size.
pub fn flip(reference: &[u8], test: &[u8], width: u32, height: u32) -> Flip {
    let image = |rgba| Image::new(width, height, rgba).expect("four bytes per pixel");
    let map = lovelock_metrics::flip(&image(reference), &image(test)).expect("images of one size");
    Flip { mean: map.mean() as f32, p99: map.weighted_percentile(0.99) as f32 }
}

/// Mean of each channel of an image with four bytes per pixel, 0 to 255.
pub fn mean_color(rgba: &[u8]) -> [f64; 4] {
    let mut sum = [0.0; 4];
    for pixel in rgba.chunks_exact(4) {
        for (s, &c) in sum.iter_mut().zip(pixel) {
            *s += f64::from(c);
        }
    }
    sum.map(|s| s / (rgba.len() / 4).max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gradient(shift: u8) -> Vec<u8> {
        (0..32 * 32).flat_map(|i| [(i % 32 * 8) as u8, shift, 90, 255]).collect()
    }

    #[test]
    fn only_different_images_differ() {
        let same = flip(&gradient(0), &gradient(0), 32, 32);
        assert_eq!((same.mean, same.p99), (0.0, 0.0));
        let other = flip(&gradient(0), &gradient(80), 32, 32);
        assert!(other.mean > 0.1 && other.p99 >= other.mean, "{other:?}");
    }
}
