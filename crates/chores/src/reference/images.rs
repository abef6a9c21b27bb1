//! Images as linear light.

use anyhow::{Context as _, ensure};
use std::fs;
use std::path::Path;

/// Linear light in the primaries of sRGB, colour multiplied by coverage.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct LinearImage {
    pub(super) width: u32,
    pub(super) height: u32,
    /// Red, green, blue and coverage, rows from the top.
    pub(super) pixels: Vec<[f32; 4]>,
}

impl LinearImage {
    /// Reads an image of four little-endian `f32` per pixel.
    pub(super) fn read(path: &Path, [width, height]: [u32; 2]) -> anyhow::Result<Self> {
        let bytes = fs::read(path).with_context(|| format!("could not read {}", path.display()))?;
        Self::parse(&bytes, [width, height]).with_context(|| path.display().to_string())
    }

    fn parse(bytes: &[u8], [width, height]: [u32; 2]) -> anyhow::Result<Self> {
        let wanted = width as usize * height as usize * 16;
        ensure!(
            bytes.len() == wanted,
            "found {} bytes; must be {wanted} for {width} x {height} pixels",
            bytes.len()
        );
        let value = |bytes: &[u8]| bytes.try_into().map_or(f32::NAN, f32::from_le_bytes);
        let pixels: Vec<[f32; 4]> = bytes
            .chunks_exact(16)
            .map(|pixel| [0, 4, 8, 12].map(|first| value(&pixel[first..first + 4])))
            .collect();
        ensure!(
            pixels.iter().flatten().all(|value| value.is_finite()),
            "found values that are not finite; must be finite"
        );
        Ok(Self { width, height, pixels })
    }

    /// The mean of two images of one size.
    pub(super) fn mean(a: &Self, b: &Self) -> Self {
        let mean = |a: &[f32; 4], b: &[f32; 4]| std::array::from_fn(|i| 0.5 * (a[i] + b[i]));
        Self { pixels: a.pixels.iter().zip(&b.pixels).map(|(a, b)| mean(a, b)).collect(), ..*a }
    }

    /// The image with colours multiplied by a factor.
    pub(super) fn scaled(&self, factor: f32) -> Self {
        let scale = |&[r, g, b, covered]: &[f32; 4]| [r * factor, g * factor, b * factor, covered];
        Self { pixels: self.pixels.iter().map(scale).collect(), ..*self }
    }

    /// The image on a screen, in sRGB and without another tone curve: four bytes per pixel over black.
    pub(super) fn shown(&self) -> Vec<u8> {
        let byte = |light: f32| (encode(light) * 255.0 + 0.5) as u8;
        self.pixels.iter().flat_map(|&[r, g, b, _]| [byte(r), byte(g), byte(b), 255]).collect()
    }

    /// Relative luminance of each pixel.
    pub(super) fn luminance(&self) -> Vec<f64> {
        let of =
            |&[r, g, b, _]: &[f32; 4]| 0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b);
        self.pixels.iter().map(of).collect()
    }

    /// The image with its sides divided by a whole number, each pixel the mean of those that it replaces.
    pub(super) fn shrunk(&self, by: u32) -> Self {
        let (width, height) = (self.width / by, self.height / by);
        let pixel = |x: u32, y: u32| {
            let mut sum = [0.0; 4];
            for i in 0..by * by {
                let at = (y * by + i / by) as usize * self.width as usize + (x * by + i % by) as usize;
                for (sum, value) in sum.iter_mut().zip(self.pixels[at]) {
                    *sum += value / (by * by) as f32;
                }
            }
            sum
        };
        let pixels = (0..height).flat_map(|y| (0..width).map(move |x| pixel(x, y))).collect();
        Self { width, height, pixels }
    }
}

/// The transfer function of sRGB.
fn encode(light: f32) -> f32 {
    let light = light.clamp(0.0, 1.0);
    if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_become_light_and_bad_ones_are_refused() {
        let bytes: Vec<u8> = [0.5_f32, 1.0, 0.0, 1.0].into_iter().flat_map(f32::to_le_bytes).collect();
        let image = LinearImage::parse(&bytes, [1, 1]).expect("an image");
        assert_eq!(image.pixels, [[0.5, 1.0, 0.0, 1.0]]);
        // 0.5 in sRGB is 188 of 255.
        assert_eq!(image.shown(), [188, 255, 0, 255]);
        assert!((image.luminance()[0] - (0.1063 + 0.7152)).abs() < 1e-6);
        let error = LinearImage::parse(&bytes, [2, 1]).unwrap_err().to_string();
        assert!(error.contains("16 bytes") && error.contains("32"), "{error}");
        let nan: Vec<u8> = [f32::NAN; 4].into_iter().flat_map(f32::to_le_bytes).collect();
        assert!(LinearImage::parse(&nan, [1, 1]).is_err());
    }

    #[test]
    fn a_smaller_image_has_the_means() {
        let pixels = (0..8).map(|i| [i as f32; 4]).collect();
        let image = LinearImage { width: 4, height: 2, pixels }.shrunk(2);
        assert_eq!(image.pixels, [[2.5; 4], [4.5; 4]]);
    }
}
