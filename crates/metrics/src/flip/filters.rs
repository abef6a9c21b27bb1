//! The separable filters of FLIP, as weights along one axis.

use std::f64::consts::PI;

/// An odd number of weights along one axis; the middle one is at the pixel itself.
pub(super) struct Filters {
    /// Contrast sensitivity for luminance.
    pub(super) achromatic: Vec<f32>,
    /// For red-green.
    pub(super) red_green: Vec<f32>,
    /// For blue-yellow: the first of two terms.
    pub(super) blue_yellow_narrow: Vec<f32>,
    /// The second of the two terms.
    pub(super) blue_yellow_wide: Vec<f32>,
    /// Gaussian of a feature, and its first (edges) and second derivative (points).
    pub(super) gaussian: Vec<f32>,
    pub(super) first: Vec<f32>,
    pub(super) second: Vec<f32>,
}

/// Width of a feature in degrees.
const FEATURE_WIDTH: f64 = 0.082;

impl Filters {
    pub(super) fn new(pixels_per_degree: f64) -> Self {
        // The paper's a and b for the contrast sensitivity of each channel.
        let widest: f64 = 0.04;
        let radius = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as i32;
        let along = |scale: f64, b: f64| -> Vec<f64> {
            let weight = |x: i32| scale * (-(PI * f64::from(x) / pixels_per_degree).powi(2) / b).exp();
            (-radius..=radius).map(weight).collect()
        };
        let sum = |weights: &[f64]| weights.iter().sum::<f64>();
        let one = |b| {
            let weights = along(1.0, b);
            let total = sum(&weights);
            weights.iter().map(|weight| (weight / total) as f32).collect()
        };
        // Each of the two is applied horizontally and vertically, so each axis has the square root of its weight.
        let share = |a: f64, b: f64| along((a * (PI / b).sqrt()).sqrt(), b);
        let two = [share(34.1, 0.04), share(13.5, 0.025)];
        let total = (sum(&two[0]).powi(2) + sum(&two[1]).powi(2)).sqrt();
        let [blue_yellow_narrow, blue_yellow_wide] =
            two.map(|weights| weights.iter().map(|weight| (weight / total) as f32).collect());

        let deviation = 0.5 * FEATURE_WIDTH * pixels_per_degree;
        let radius = (3.0 * deviation).ceil() as i32;
        let at = |shape: fn(f64) -> f64| -> Vec<f64> {
            (-radius..=radius)
                .map(|x| f64::from(x) / deviation)
                .map(|x| shape(x) * (-0.5 * x * x).exp())
                .collect()
        };
        Self {
            achromatic: one(0.0047),
            red_green: one(0.0053),
            blue_yellow_narrow,
            blue_yellow_wide,
            gaussian: balanced(&at(|_| 1.0)),
            first: balanced(&at(|x| -x)),
            second: balanced(&at(|x| x * x - 1.0)),
        }
    }
}

/// Scales positive weights to a sum of 1 and negative weights to a sum of -1.
fn balanced(weights: &[f64]) -> Vec<f32> {
    let total = |sign: f64| weights.iter().map(|weight| (weight * sign).max(0.0)).sum::<f64>();
    let [positive, negative] = [total(1.0), total(-1.0)];
    weights.iter().map(|&w| if w > 0.0 { w / positive } else { w / negative.max(1e-300) } as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::Filters;
    use crate::blur::blurred;

    #[test]
    fn blurs_keep_a_constant_and_derivatives_remove_it() {
        let filters = Filters::new(67.0);
        let flat = vec![3.0; 7 * 5];
        for (across, down, expected) in [
            (&filters.achromatic, &filters.achromatic, 3.0),
            (&filters.red_green, &filters.red_green, 3.0),
            (&filters.first, &filters.gaussian, 0.0),
            (&filters.gaussian, &filters.second, 0.0),
        ] {
            let out = blurred(&flat, 7, across, down);
            assert!(out.iter().all(|value| (value - expected).abs() < 1e-5), "{expected}: {out:?}");
        }
        let two = [&filters.blue_yellow_narrow, &filters.blue_yellow_wide];
        let [a, b] = two.map(|weights| blurred(&flat, 7, weights, weights)[17]);
        assert!((a + b - 3.0).abs() < 1e-5, "{a} {b}");
    }
}
