//! The filters of FLIP, each separable, as weights along an axis.

use std::f64::consts::PI;

/// Weights along one axis, of odd number, the middle one at the pixel itself.
pub(super) struct Filters {
    /// The eye's blur of luminance.
    pub(super) achromatic: Vec<f32>,
    /// Of red against green.
    pub(super) red_green: Vec<f32>,
    /// Of blue against yellow, a sum of two.
    pub(super) blue_yellow_narrow: Vec<f32>,
    /// The other of the two.
    pub(super) blue_yellow_wide: Vec<f32>,
    /// The blur across a feature, its first derivative (edges) and its second (points).
    pub(super) gaussian: Vec<f32>,
    pub(super) first: Vec<f32>,
    pub(super) second: Vec<f32>,
}

/// The width of a feature, degrees.
const FEATURE_WIDTH: f64 = 0.082;

impl Filters {
    pub(super) fn new(pixels_per_degree: f64) -> Self {
        // The paper's a and b of each channel's contrast sensitivity.
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
        // Each of the two is applied across and down, so each axis has the root of its share.
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

/// Scales positive weights to a sum of 1 and negative ones to -1.
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
    fn blurs_keep_a_flat_plane_and_derivatives_lose_it() {
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
