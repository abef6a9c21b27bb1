//! FLIP: the difference that people perceive when they flip between two images.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild (2020), "FLIP: A Difference Evaluator for
//! Alternating Images", Proc. ACM Comput. Graph. Interact. Tech. 3(2), for images of low dynamic range, with the
//! separable filters of the authors' program. The colour difference (`HyAB` distance in CIELAB after contrast sensitivity
//! filtering) is amplified where edges and points differ.

mod color;
mod filters;

use crate::blur::blurred;
use crate::image::{Image, ImageError};
use color::{hunt_lab, hyab, ycxcz};
use filters::Filters;
use lovelock_base::statistics::nearest_rank;
use rayon::prelude::*;

/// Pixels per degree of visual angle, the authors' default: a display 0.7 m wide with 3840 pixels at a distance of 0.7 m.
const PIXELS_PER_DEGREE: f64 = 67.0;

/// The perceived difference of two images at each pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct FlipMap {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// The difference at each pixel, rows from the top: 0 is none, 1 is the maximum.
    pub values: Vec<f32>,
}

impl FlipMap {
    /// The unweighted mean over all pixels, the single number that the authors recommend.
    pub fn mean(&self) -> f64 {
        self.values.iter().map(|&value| f64::from(value)).sum::<f64>() / self.values.len().max(1) as f64
    }

    /// The unweighted quantile `q` (0..=1) of all pixels, by nearest rank.
    pub fn percentile(&self, q: f64) -> f64 {
        let mut sorted = self.values.clone();
        sorted.sort_unstable_by(f32::total_cmp);
        nearest_rank(sorted.len(), q).map_or(0.0, |index| f64::from(sorted[index]))
    }

    /// As [`percentile`](Self::percentile), but with each pixel weighted by its own difference, as in the quartiles of the
    /// authors' program. A large empty backdrop does not change it.
    pub fn weighted_percentile(&self, q: f64) -> f64 {
        let mut sorted = self.values.clone();
        sorted.sort_unstable_by(f32::total_cmp);
        let wanted = q * sorted.iter().map(|&value| f64::from(value)).sum::<f64>();
        let mut sum = 0.0;
        for &value in &sorted {
            sum += f64::from(value);
            if sum > wanted {
                return f64::from(value);
            }
        }
        sorted.last().map_or(0.0, |&value| f64::from(value))
    }
}

/// FLIP of two images at 67 pixels per degree.
///
/// # Errors
/// If the images differ in size.
pub fn flip(reference: &Image<'_>, test: &Image<'_>) -> Result<FlipMap, ImageError> {
    reference.same_size(test)?;
    let filters = Filters::new(PIXELS_PER_DEGREE);
    let (seen_reference, seen_test) =
        rayon::join(|| FilteredImage::new(reference, &filters), || FilteredImage::new(test, &filters));
    let largest = largest_color_difference();
    let values = (0..reference.width() * reference.height())
        .into_par_iter()
        .with_min_len(4096)
        .map(|pixel| {
            let color = color_difference(seen_reference.lab[pixel], seen_test.lab[pixel], largest);
            let edges = (seen_reference.edges[pixel] - seen_test.edges[pixel]).abs();
            let points = (seen_reference.points[pixel] - seen_test.points[pixel]).abs();
            let feature = (edges.max(points) * std::f32::consts::FRAC_1_SQRT_2).powf(FEATURE_EXPONENT);
            color.powf(1.0 - feature)
        })
        .collect();
    Ok(FlipMap { width: reference.width(), height: reference.height(), values })
}

/// The exponents and the knee of the colour mapping, from section 4 of the paper.
const COLOR_EXPONENT: f32 = 0.7;
const KNEE: f32 = 0.4;
const KNEE_VALUE: f32 = 0.95;
const FEATURE_EXPONENT: f32 = 0.5;

/// The filtered signals of one image.
struct FilteredImage {
    /// Colour after contrast sensitivity filtering: CIELAB with the Hunt adjustment.
    lab: Vec<[f32; 3]>,
    /// Length of the gradient of luminance.
    edges: Vec<f32>,
    /// Length of the second derivatives of luminance.
    points: Vec<f32>,
}

impl FilteredImage {
    fn new(image: &Image<'_>, filters: &Filters) -> Self {
        let (width, height) = (image.width(), image.height());
        let mut planes = [const { Vec::new() }; 3];
        for plane in &mut planes {
            plane.reserve_exact(width * height);
        }
        for rgb in image.rgb() {
            for (plane, value) in planes.iter_mut().zip(ycxcz(rgb)) {
                plane.push(value);
            }
        }
        let blur = |plane: usize, across: &[f32], down: &[f32]| blurred(&planes[plane], width, across, down);
        let [y, cx] = [&filters.achromatic, &filters.red_green];
        let [cz1, cz2] = [&filters.blue_yellow_narrow, &filters.blue_yellow_wide];
        let [y, cx, cz1, cz2] = [blur(0, y, y), blur(1, cx, cx), blur(2, cz1, cz1), blur(2, cz2, cz2)];
        let lab = (0..width * height)
            .into_par_iter()
            .with_min_len(4096)
            .map(|i| hunt_lab([y[i], cx[i], cz1[i] + cz2[i]]))
            .collect();
        // This luminance differs from one of 0 to 1 by an offset and a scale; derivatives depend only on the scale.
        let length = |along: &[f32]| {
            let [x, y] = [blur(0, along, &filters.gaussian), blur(0, &filters.gaussian, along)];
            x.iter().zip(&y).map(|(x, y)| (x * x + y * y).sqrt() / 116.0).collect()
        };
        Self { lab, edges: length(&filters.first), points: length(&filters.second) }
    }
}

/// The difference of two colours, 0 to 1; `largest` is the result of [`largest_color_difference`].
fn color_difference(reference: [f32; 3], test: [f32; 3], largest: f32) -> f32 {
    let difference = hyab(reference, test).powf(COLOR_EXPONENT);
    let knee = KNEE * largest;
    if difference < knee {
        difference * KNEE_VALUE / knee
    } else {
        KNEE_VALUE + (difference - knee) / (largest - knee) * (1.0 - KNEE_VALUE)
    }
}

/// The difference between pure green and pure blue, before it is scaled to 1.
fn largest_color_difference() -> f32 {
    hyab(hunt_lab(ycxcz([0, 255, 0])), hunt_lab(ycxcz([0, 0, 255]))).powf(COLOR_EXPONENT)
}

#[cfg(test)]
mod tests;
