//! Structural similarity.

use crate::blur::blurred;
use crate::image::{Image, ImageError};

/// Width and height of the window in pixels.
const WINDOW: usize = 11;

/// Structural similarity of the luma of two images: 1 is equal, 0 is dissimilar, negative is inverted.
///
/// Wang, Bovik, Sheikh and Simoncelli (2004), "Image Quality Assessment: From Error Visibility to Structural
/// Similarity": a Gaussian window of 11 x 11 pixels with a deviation of 1.5, K1 = 0.01 and K2 = 0.03, the mean over all
/// windows inside the image, without downsampling. Luma is that of ITU-R BT.601, not rounded.
///
/// # Errors
/// If the images differ in size or are smaller than the window.
pub fn ssim(reference: &Image<'_>, test: &Image<'_>) -> Result<f64, ImageError> {
    reference.same_size(test)?;
    let (width, height) = (reference.width(), reference.height());
    if width.min(height) < WINDOW {
        return Err(ImageError::TooSmall(width, height, WINDOW));
    }
    // Relative to middle grey, so that squares lose fewer digits; the offset does not change variances.
    let luma = |image: &Image<'_>| -> Vec<f32> {
        image
            .rgb()
            .map(|[r, g, b]| 0.299 * f32::from(r) + 0.587 * f32::from(g) + 0.114 * f32::from(b) - MIDDLE)
            .collect()
    };
    let weights = window();
    let mean = |plane: &[f32]| blurred(plane, width, &weights, &weights);
    let product = |a: &[f32], b: &[f32]| -> Vec<f32> { a.iter().zip(b).map(|(a, b)| a * b).collect() };
    let [a, b] = [luma(reference), luma(test)];
    let [mean_a, mean_b] = [mean(&a), mean(&b)];
    let [square_a, square_b, cross] = [(&a, &a), (&b, &b), (&a, &b)].map(|(a, b)| mean(&product(a, b)));
    let [c1, c2] = [0.01_f64, 0.03].map(|k| (k * 255.0).powi(2));
    let rim = WINDOW / 2;
    let mut sum = 0.0;
    for y in rim..height - rim {
        for i in y * width + rim..(y + 1) * width - rim {
            let [ma, mb] = [f64::from(mean_a[i]), f64::from(mean_b[i])];
            let variances = f64::from(square_a[i]) - ma * ma + f64::from(square_b[i]) - mb * mb;
            let covariance = f64::from(cross[i]) - ma * mb;
            let [ma, mb] = [ma, mb].map(|mean| mean + f64::from(MIDDLE));
            sum += (2.0 * ma * mb + c1) * (2.0 * covariance + c2)
                / ((ma * ma + mb * mb + c1) * (variances + c2));
        }
    }
    Ok(sum / ((width - 2 * rim) * (height - 2 * rim)) as f64)
}

const MIDDLE: f32 = 128.0;

/// Gaussian weights of standard deviation 1.5 with a sum of 1.
fn window() -> [f32; WINDOW] {
    let weight = |i: usize| (-0.5 * ((i as f64 - (WINDOW / 2) as f64) / 1.5).powi(2)).exp();
    let total: f64 = (0..WINDOW).map(weight).sum();
    std::array::from_fn(|i| (weight(i) / total) as f32)
}

#[cfg(test)]
mod tests {
    use super::{Image, ssim};

    fn grey(width: u32, height: u32, value: impl Fn(u32, u32) -> u8) -> Vec<u8> {
        (0..width * height).flat_map(|i| [value(i % width, i / width); 4]).collect()
    }

    fn of(width: u32, a: &[u8], b: &[u8]) -> f64 {
        let height = a.len() as u32 / width / 4;
        ssim(&Image::new(width, height, a).unwrap(), &Image::new(width, height, b).unwrap()).unwrap()
    }

    #[test]
    fn flat_images_differ_by_luminance_only() {
        let [a, b] = [100_u8, 150].map(|level| grey(20, 16, move |_, _| level));
        let c1 = (0.01_f64 * 255.0).powi(2);
        let expected = (2.0 * 100.0 * 150.0 + c1) / (100.0 * 100.0 + 150.0 * 150.0 + c1);
        assert!((of(20, &a, &b) - expected).abs() < 1e-5, "{}", of(20, &a, &b));
        assert!((of(20, &a, &a) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_negative_is_below_zero_and_noise_lowers_the_value() {
        let checks = |x: u32, y: u32| if (x + y).is_multiple_of(2) { 80 } else { 176 };
        let a = grey(24, 24, checks);
        let negative = grey(24, 24, |x, y| 255 - checks(x, y) + 1);
        assert!(of(24, &a, &negative) < -0.9);
        let noisy = grey(24, 24, |x, y| checks(x, y) + ((x * 7919 + y * 104_729) % 13) as u8);
        assert!((0.9..0.9999).contains(&of(24, &a, &noisy)), "{}", of(24, &a, &noisy));
    }

    #[test]
    fn scikit_image_gives_the_same_numbers() {
        // skimage.metrics.structural_similarity 0.26 of the lumas with gaussian_weights, sigma 1.5,
        // use_sample_covariance=False and data_range 255.
        let colors = |seed: u32, more: u32| -> Vec<u8> {
            let pixel = |x: u32, y: u32| {
                let checks = if (x / 4 + y / 3) % 2 == 1 { 200 } else { 0 };
                let rgb = [(x * 7 + y * 3 * seed) % 256, (x * y * seed) % 256, checks];
                rgb.map(|channel| (channel + more * ((x * 13) % 17)).min(255) as u8)
            };
            (0..40 * 33).map(|i| pixel(i % 40, i / 40)).flat_map(|[r, g, b]| [r, g, b, 255]).collect()
        };
        for (other, expected) in [(colors(2, 0), 0.419_696_788_9), (colors(1, 1), 0.985_277_606_7)] {
            let found = of(40, &colors(1, 0), &other);
            // Single precision: measured at most 3e-7.
            assert!((found - expected).abs() < 2e-6, "{found} {expected}");
        }
    }

    #[test]
    fn small_and_unequal_images_are_refused() {
        let small = grey(10, 30, |_, _| 0);
        let image = Image::new(10, 30, &small).unwrap();
        let error = ssim(&image, &image).unwrap_err();
        assert_eq!(
            error.to_string(),
            "an image of 10 x 30 pixels is smaller than the window of 11 x 11 pixels"
        );
        assert!(ssim(&image, &Image::new(30, 10, &small).unwrap()).is_err());
    }
}
