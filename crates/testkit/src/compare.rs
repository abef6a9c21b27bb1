//! Comparison of pictures.

use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8, FlipPool};

/// The perceived difference of two pictures by FLIP (Andersson et al. 2020): 0 is none, 1 is the most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flip {
    /// Mean over the pixels.
    pub mean: f32,
    /// 99th percentile over the pixels.
    pub p99: f32,
}

fn rgb(rgba: &[u8]) -> Vec<u8> {
    rgba.chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect()
}

/// FLIP of two pictures of `width` by `height` pixels, four bytes a pixel, sRGB encoded; alpha is ignored.
pub fn flip(reference: &[u8], test: &[u8], width: u32, height: u32) -> Flip {
    let image = |rgba: &[u8]| FlipImageRgb8::with_data(width, height, &rgb(rgba));
    let map = nv_flip::flip(image(reference), image(test), DEFAULT_PIXELS_PER_DEGREE);
    let pool = FlipPool::from_image(&map);
    let mut pool = pool;
    Flip { mean: pool.mean(), p99: pool.get_percentile(0.99, true) }
}

/// Peak signal to noise ratio of two pictures of equal size, decibels; infinite where they are equal.
pub fn psnr_db(reference: &[u8], test: &[u8]) -> f64 {
    assert_eq!(reference.len(), test.len(), "pictures of different size");
    let sum: f64 = reference.iter().zip(test).map(|(&a, &b)| (f64::from(a) - f64::from(b)).powi(2)).sum();
    10.0 * (255.0 * 255.0 * reference.len() as f64 / sum).log10()
}

/// Mean of each channel of a picture of four bytes a pixel, 0 to 255.
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
    fn equal_pictures_do_not_differ_and_others_do() {
        let same = flip(&gradient(0), &gradient(0), 32, 32);
        assert_eq!((same.mean, same.p99), (0.0, 0.0));
        let other = flip(&gradient(0), &gradient(80), 32, 32);
        assert!(other.mean > 0.1 && other.p99 >= other.mean, "{other:?}");
        assert!(psnr_db(&gradient(0), &gradient(0)).is_infinite());
        // 80 of 255 in one channel of four: 10 log10(4 * 255^2 / 80^2).
        assert!((psnr_db(&gradient(0), &gradient(80)) - 16.09).abs() < 0.01);
    }
}
