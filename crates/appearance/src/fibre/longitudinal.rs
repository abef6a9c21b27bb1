//! The longitudinal term: how light spreads along the strand.
// Inlined into the loops of a renderer; a call would prevent vectorisation.
#![allow(clippy::inline_always)]

use super::LOBES;
use super::arithmetic::exp;

/// Variances v of the lobes R, TT, TRT and the rest, for a longitudinal roughness (Chiang et al. 2016; pbrt).
pub fn variances(roughness_along: f64) -> [f64; LOBES] {
    let b = roughness_along;
    let v = (0.726 * b + 0.812 * b * b + 3.7 * b.powi(20)).powi(2);
    VARIANCE_RATIOS.map(|ratio| ratio * v)
}

/// Variances of the lobes relative to that of R.
pub(super) const VARIANCE_RATIOS: [f64; LOBES] = [1.0, 0.25, 4.0, 4.0];

/// Longitudinal term `M_p` of a lobe with variance `v` (d'Eon et al. 2011), per unit of sine:
/// its integral over `cos_i d(theta_i)` is 1.
///
/// The published form `exp(-si so/v) I0(ci co/v) / (2 v sinh(1/v))` overflows for smooth fibres. This one is identical and does
/// not, because `I0e(x) = exp(-x) I0(x)` stays below 1.
pub fn longitudinal(v: f64, sin_i: f64, cos_i: f64, sin_o: f64, cos_o: f64) -> f64 {
    let exponent = (cos_i * cos_o - sin_i * sin_o - 1.0) / v;
    exponent.exp() * bessel_i0e(cos_i * cos_o / v) / (v * -(-2.0 / v).exp_m1())
}

/// A longitudinal lobe in single precision, with the divisions done.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LongitudinalLobe {
    /// `1 / v`.
    pub inverse: f32,
    /// `1 / (v (1 - exp(-2/v)))`.
    pub scale: f32,
}

impl LongitudinalLobe {
    /// The lobe of variance `v`, 3e-4 to 200, with the exact scale.
    #[cfg(test)]
    fn new(v: f64) -> Self {
        Self { inverse: (1.0 / v) as f32, scale: (1.0 / (v * -(-2.0 / v).exp_m1())) as f32 }
    }

    /// The lobe of variance `v`, 3e-4 to 200, without an exponential. Its scale is within 0.16 % of the exact one.
    #[inline(always)]
    pub fn quick(v: f32) -> Self {
        let w = 1.0 / v;
        // Least maximal relative error of a rational function that is 1/2 at 0 and w at infinity.
        let above = 0.5 + w * (0.777_000_5 + w * (0.545_796_4 + w * 0.386_785));
        let below = 1.0 + w * (0.523_910_8 + w * 0.386_785);
        Self { inverse: w, scale: above / below }
    }

    /// [`longitudinal`] in plain arithmetic: one exponential, one square root, one division and no branch. `cos_o` and `cos_i`
    /// are not negative. The Bessel function is within 0.04 % of the exact one.
    #[inline(always)]
    pub fn at(self, sin_i: f32, cos_i: f32, sin_o: f32, cos_o: f32) -> f32 {
        let both = cos_i * cos_o;
        let x = both * self.inverse;
        // The square of I0e(x) as a rational function with the exact slope at 0 and the exact limit 1 / (2 pi x); the free
        // numbers have the least maximal relative error.
        let above = 1.0 + x * (0.386_872_3 + x * (0.255_961_1 + x * 0.172_482_43));
        let below = 1.0 + x * (2.386_872_3 + x * (2.598_808_4 + x * (1.298_065 + x * 1.083_739)));
        exp((both - sin_i * sin_o - 1.0) * self.inverse) * (above / below).sqrt() * self.scale
    }
}

/// The modified Bessel function of order zero times `exp(-x)`, for non-negative `x`; relative error below 1e-9.
fn bessel_i0e(x: f64) -> f64 {
    if x < 30.0 {
        // The power series: every term is positive, so nothing cancels.
        let quarter = 0.25 * x * x;
        let (mut term, mut sum, mut k) = (1.0, 1.0, 1.0);
        while term > 1e-17 * sum {
            term *= quarter / (k * k);
            sum += term;
            k += 1.0;
        }
        sum * (-x).exp()
    } else {
        // The asymptotic series (Abramowitz and Stegun 9.7.1).
        let (mut term, mut sum) = (1.0, 1.0);
        for k in 1..=8 {
            let odd = f64::from(2 * k - 1);
            term *= odd * odd / (8.0 * f64::from(k) * x);
            sum += term;
        }
        sum / (2.0 * std::f64::consts::PI * x).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::super::Quadrature;
    use super::*;

    #[test]
    fn bessel_function_against_tabulated_values() {
        // Abramowitz and Stegun, table 9.8.
        for (x, expected) in
            [(0.0, 1.0), (1.0, 0.465_759_607_6), (5.0, 0.183_540_812_6), (10.0, 0.127_833_337_2)]
        {
            assert!((bessel_i0e(x) - expected).abs() < 1e-9, "{x}");
        }
        assert!((bessel_i0e(29.999_999) / bessel_i0e(30.000_001) - 1.0).abs() < 1e-7);
    }

    #[test]
    fn single_precision_is_finite_and_close_for_every_roughness() {
        // Largest error of both lobes relative to the peak, and relative to the value where it is above 1 % of the peak.
        let mut worst = [0.0_f64; 3];
        for step in 5..=100 {
            for v in variances(f64::from(step) / 100.0) {
                let lobes = [LongitudinalLobe::new(v), LongitudinalLobe::quick(v as f32)];
                let (mut peak, mut error, mut values) = (0.0_f64, [0.0_f64; 2], Vec::new());
                let angles = || (-30..=30).map(|i| f64::from(i) * std::f64::consts::FRAC_PI_2 / 30.0);
                for (i, o) in angles().flat_map(|i| angles().map(move |o| (i, o))) {
                    let truth = longitudinal(v, i.sin(), i.cos(), o.sin(), o.cos());
                    peak = peak.max(truth);
                    for (lobe, error) in lobes.iter().zip(&mut error) {
                        let value = lobe.at(i.sin() as f32, i.cos() as f32, o.sin() as f32, o.cos() as f32);
                        assert!(value.is_finite() && value >= 0.0);
                        *error = error.max((f64::from(value) - truth).abs());
                        values.push((truth, f64::from(value)));
                    }
                }
                // The exponent of the smoothest lobe is a difference of numbers near 1, divided by 4e-4.
                let relative = values.iter().filter(|(truth, _)| *truth > 0.01 * peak);
                let relative = relative.map(|(truth, value)| (value / truth - 1.0).abs()).fold(0.0, f64::max);
                worst =
                    [worst[0].max(error[0] / peak), worst[1].max(error[1] / peak), worst[2].max(relative)];
            }
        }
        println!("{worst:?}");
        assert!(worst[0] < 0.0006 && worst[1] < 0.002 && worst[2] < 0.0025, "{worst:?}");
    }

    #[test]
    fn every_lobe_integrates_to_one() {
        let rule = Quadrature::new(200);
        for roughness in [0.1, 0.3, 0.7, 1.0] {
            for v in variances(roughness) {
                for theta_o in [-1.2_f64, 0.0, 0.4] {
                    let half = std::f64::consts::FRAC_PI_2;
                    let sum = rule.integrate(-half, half, |theta| {
                        longitudinal(v, theta.sin(), theta.cos(), theta_o.sin(), theta_o.cos()) * theta.cos()
                    });
                    assert!((sum - 1.0).abs() < 1e-6, "v {v}, theta {theta_o}: {sum}");
                }
            }
        }
    }
}
