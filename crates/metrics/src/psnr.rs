//! Peak signal-to-noise ratio.

use crate::image::{Image, ImageError};

/// Peak signal-to-noise ratio of two images over red, green and blue, in decibels; infinite if they are equal.
///
/// # Errors
/// If the images differ in size.
pub fn psnr_db(reference: &Image<'_>, test: &Image<'_>) -> Result<f64, ImageError> {
    reference.same_size(test)?;
    let square = |(a, b): ([u8; 3], [u8; 3])| {
        a.iter().zip(&b).map(|(&a, &b)| u64::from(a.abs_diff(b)).pow(2)).sum::<u64>()
    };
    let sum: u64 = reference.rgb().zip(test.rgb()).map(square).sum();
    let count = (reference.width() * reference.height() * 3) as f64;
    Ok(10.0 * (255.0 * 255.0 * count / sum as f64).log10())
}

#[cfg(test)]
mod tests {
    use super::{Image, psnr_db};

    #[test]
    fn one_channel_off_by_eighty() {
        let [a, b] = [0, 80].map(|green| [10, green, 90, 255].repeat(64));
        let of = |a: &[u8], b: &[u8]| {
            psnr_db(&Image::new(8, 8, a).unwrap(), &Image::new(8, 8, b).unwrap()).unwrap()
        };
        assert!(of(&a, &a).is_infinite());
        let expected = 10.0 * (3.0 * 255.0_f64.powi(2) / 80.0_f64.powi(2)).log10();
        assert!((of(&a, &b) - expected).abs() < 1e-9);
        // Alpha is ignored, and half the difference is six decibels more.
        let half = [10, 40, 90, 0].repeat(64);
        assert!((of(&a, &half) - expected - 20.0 * 2.0_f64.log10()).abs() < 1e-9);
        assert!(psnr_db(&Image::new(8, 8, &a).unwrap(), &Image::new(4, 16, &a).unwrap()).is_err());
    }
}
