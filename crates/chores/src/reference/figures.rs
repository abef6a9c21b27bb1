//! How far an image is from the reference.

use super::images::LinearImage;
use glam::DVec2;
use lovelock_metrics::{Image, flip, psnr_db};
use serde::Serialize;

/// A pixel is hair if hair covers this much of it in either image.
const COVERED: f32 = 0.5;

/// A row of the image counts for the profile if it has this many pixels of hair.
const ROW_PIXELS: usize = 8;

/// Mean luminance of ours and of the reference, and their ratio.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(super) struct Brightness {
    pub(super) ours: f64,
    pub(super) theirs: f64,
    /// Ours divided by theirs; `None` if theirs is black.
    pub(super) ratio: Option<f64>,
}

/// One image beside the reference.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Figures {
    /// Mean of FLIP over the image, both in sRGB with the same exposure.
    pub(super) flip: f64,
    /// The same after our image was made as bright as the reference, in the mean over the hair: what is left of FLIP besides brightness.
    pub(super) flip_equally_bright: f64,
    /// Mean of FLIP over the pixels of hair.
    pub(super) flip_hair: f64,
    /// Of the same images, decibels; `None` if they are equal.
    pub(super) psnr_db: Option<f64>,
    /// All hair.
    pub(super) hair: Brightness,
    /// The third of the hair that is nearest to the light in the image.
    pub(super) lit: Brightness,
    /// The third between.
    pub(super) middle: Brightness,
    /// The third that is farthest from the light.
    pub(super) shadow: Brightness,
    /// Correlation of the mean luminance of the hair's rows: 1 if highlights are in the same places. `None` if it does not vary.
    pub(super) row_correlation: Option<f64>,
    /// Pixels of hair in both images as a fraction of those in either: shows whether camera and strands are the same.
    pub(super) overlap: f64,
}

impl Figures {
    /// Compares two images of one size. `toward_light` is a direction in the image, to the right and up.
    pub(super) fn of(ours: &LinearImage, theirs: &LinearImage, toward_light: DVec2) -> anyhow::Result<Self> {
        let covers = |image: &LinearImage, i: usize| image.pixels[i][3] >= COVERED;
        let hair: Vec<usize> =
            (0..ours.pixels.len()).filter(|&i| covers(ours, i) || covers(theirs, i)).collect();
        let both = hair.iter().filter(|&&i| covers(ours, i) && covers(theirs, i)).count();
        let (shown, reference) = (ours.shown(), theirs.shown());
        let shown = Image::new(ours.width, ours.height, &shown)?;
        let reference = Image::new(theirs.width, theirs.height, &reference)?;
        let map = flip(&reference, &shown)?;
        let psnr_db = psnr_db(&reference, &shown)?;
        let light = [ours.luminance(), theirs.luminance()];
        let [lit, middle, shadow] = thirds(&hair, ours.width as usize, toward_light);
        let brightness = |pixels: &[usize]| {
            let [ours, theirs] = [0, 1].map(|of| mean(pixels.iter().map(|&i| light[of][i])));
            Brightness { ours, theirs, ratio: (theirs > 0.0).then_some(ours / theirs) }
        };
        let hair_brightness = brightness(&hair);
        let scaled = match hair_brightness.ratio {
            Some(ratio) if ratio > 0.0 => ours.scaled(1.0 / ratio as f32).shown(),
            _ => ours.shown(),
        };
        let flip_equally_bright = flip(&reference, &Image::new(ours.width, ours.height, &scaled)?)?.mean();
        let profiles = rows(&hair, ours.width as usize)
            .map(|row| [0, 1].map(|of| mean(row.iter().map(|&i| light[of][i]))));
        let (profile, their_profile): (Vec<f64>, Vec<f64>) = profiles.map(|[a, b]| (a, b)).unzip();
        Ok(Self {
            flip: map.mean(),
            flip_equally_bright,
            flip_hair: mean(hair.iter().map(|&i| f64::from(map.values[i]))),
            psnr_db: psnr_db.is_finite().then_some(psnr_db),
            hair: hair_brightness,
            lit: brightness(&lit),
            middle: brightness(&middle),
            shadow: brightness(&shadow),
            row_correlation: correlation(&profile, &their_profile),
            overlap: both as f64 / hair.len().max(1) as f64,
        })
    }
}

/// The mean of FLIP between two halves of the reference over the image: what noise alone amounts to, and more than in their mean.
pub(super) fn noise(a: &LinearImage, b: &LinearImage) -> anyhow::Result<f64> {
    let (one, other) = (a.shown(), b.shown());
    Ok(flip(&Image::new(a.width, a.height, &one)?, &Image::new(b.width, b.height, &other)?)?.mean())
}

/// The mean; 0 of nothing.
pub(super) fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0_u32), |(sum, count), value| (sum + value, count + 1));
    sum / f64::from(count.max(1))
}

/// The pixels in three parts of one size, from the one nearest to the light.
fn thirds(pixels: &[usize], width: usize, toward_light: DVec2) -> [Vec<usize>; 3] {
    let place = |i: usize| toward_light.x * (i % width) as f64 - toward_light.y * (i / width) as f64;
    let mut sorted = pixels.to_vec();
    sorted.sort_by(|&a, &b| place(b).total_cmp(&place(a)));
    let [first, second] = [1, 2].map(|third| sorted.len() * third / 3);
    [sorted[..first].to_vec(), sorted[first..second].to_vec(), sorted[second..].to_vec()]
}

/// The pixels (ascending) of each row that has enough of them.
fn rows(pixels: &[usize], width: usize) -> impl Iterator<Item = &[usize]> {
    pixels.chunk_by(move |a, b| a / width == b / width).filter(|row| row.len() >= ROW_PIXELS)
}

/// Pearson's correlation; `None` if there are fewer than two values or one list does not vary.
fn correlation(a: &[f64], b: &[f64]) -> Option<f64> {
    let [mean_a, mean_b] = [a, b].map(|values| mean(values.iter().copied()));
    let (mut both, mut of_a, mut of_b) = (0.0, 0.0, 0.0);
    for (a, b) in a.iter().zip(b) {
        let (a, b) = (a - mean_a, b - mean_b);
        both += a * b;
        of_a += a * a;
        of_b += b * b;
    }
    let size = (of_a * of_b).sqrt();
    (size > 0.0).then_some(both / size)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(width: u32, height: u32, light: impl Fn(u32, u32) -> f32) -> LinearImage {
        let pixel = |i: u32| {
            let light = light(i % width, i / width);
            [light, light, light, 1.0]
        };
        LinearImage { width, height, pixels: (0..width * height).map(pixel).collect() }
    }

    #[test]
    fn correlations_are_those_on_paper() {
        assert_eq!(correlation(&[1.0, 2.0, 3.0], &[10.0, 20.0, 30.0]), Some(1.0));
        assert_eq!(correlation(&[1.0, 2.0, 3.0], &[3.0, 2.0, 1.0]), Some(-1.0));
        // Deviations -1, 0, 1 and -1, 2, -1: their products add up to 0.
        assert_eq!(correlation(&[1.0, 2.0, 3.0], &[0.0, 3.0, 0.0]), Some(0.0));
        assert_eq!(correlation(&[1.0, 1.0], &[1.0, 2.0]), None);
        assert_eq!(correlation(&[], &[]), None);
    }

    #[test]
    fn regions_follow_the_light() {
        // Nine columns, brighter to the right: thirds of a light from the right are columns 6 to 8, 3 to 5 and 0 to 2.
        let ours = image(9, 9, |x, _| 0.1 * x as f32);
        let theirs = image(9, 9, |_, _| 0.2);
        let found = Figures::of(&ours, &theirs, DVec2::X).expect("figures");
        for (region, wanted) in
            [(found.lit, 0.7), (found.middle, 0.4), (found.shadow, 0.1), (found.hair, 0.4)]
        {
            assert!((region.ours - wanted).abs() < 1e-6 && (region.theirs - 0.2).abs() < 1e-6, "{found:?}");
            assert!(region.ratio.is_some_and(|ratio| (ratio - wanted / 0.2).abs() < 1e-5), "{found:?}");
        }
        assert_eq!((found.overlap, found.row_correlation), (1.0, None));
        let left = Figures::of(&ours, &theirs, DVec2::NEG_X).expect("figures");
        assert!((left.lit.ours - 0.1).abs() < 1e-6, "{left:?}");
        // Up in the image is the first row.
        let up = Figures::of(&image(9, 9, |_, y| if y < 3 { 0.9 } else { 0.0 }), &theirs, DVec2::Y)
            .expect("figures");
        assert!((up.lit.ours - 0.9).abs() < 1e-6 && up.shadow.ours == 0.0, "{up:?}");
    }

    #[test]
    fn equal_images_do_not_differ_and_a_moved_highlight_does() {
        let band = |at: u32| image(16, 16, move |_, y| if y.abs_diff(at) < 2 { 0.8 } else { 0.1 });
        let same = Figures::of(&band(4), &band(4), DVec2::Y).expect("figures");
        assert_eq!((same.flip, same.psnr_db), (0.0, None));
        assert!(same.row_correlation.is_some_and(|r| (r - 1.0).abs() < 1e-12));
        let moved = Figures::of(&band(11), &band(4), DVec2::Y).expect("figures");
        assert!(moved.flip > 0.1 && moved.row_correlation.is_some_and(|r| r < 0.0), "{moved:?}");
        assert!((moved.hair.ours - moved.hair.theirs).abs() < 1e-6);
        let dark = |image: LinearImage| image.scaled(0.25);
        let darker = Figures::of(&dark(band(4)), &band(4), DVec2::Y).expect("figures");
        assert!(darker.flip > 0.1 && darker.flip_equally_bright < 1e-3, "{darker:?}");
    }

    #[test]
    fn background_is_no_hair() {
        let mut ours = image(16, 16, |_, _| 0.5);
        let mut theirs = ours.clone();
        for pixel in 0..128 {
            ours.pixels[pixel] = [0.0; 4];
        }
        for pixel in 0..64 {
            theirs.pixels[pixel] = [0.0; 4];
        }
        let found = Figures::of(&ours, &theirs, DVec2::Y).expect("figures");
        // Hair in either: 192 pixels; in both: 128.
        assert!((found.overlap - 2.0 / 3.0).abs() < 1e-12, "{found:?}");
        assert!((found.hair.theirs - 0.5).abs() < 1e-6 && (found.hair.ours - 1.0 / 3.0).abs() < 1e-6);
    }
}
