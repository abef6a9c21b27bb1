//! The longitudinal term: how light spreads along the strand.

use super::LOBES;

/// Variances v of the lobes R, TT, TRT and the rest, for a longitudinal roughness (Chiang et al. 2016, equation 7; pbrt).
pub fn variances(roughness_along: f64) -> [f64; LOBES] {
    let b = roughness_along;
    let v = (0.726 * b + 0.812 * b * b + 3.7 * b.powi(20)).powi(2);
    VARIANCE_RATIOS.map(|ratio| ratio * v)
}

/// Variances of the lobes relative to that of R.
pub(super) const VARIANCE_RATIOS: [f64; LOBES] = [1.0, 0.25, 4.0, 4.0];

/// Longitudinal term `M_p` of a lobe with variance `v` (d'Eon et al. 2011, equation 7), per unit of sine:
/// its integral over `cos_i d(theta_i)` is 1.
///
/// The published form `exp(-si so/v) I0(ci co/v) / (2 v sinh(1/v))` overflows for smooth fibres. This one is identical and does
/// not, because `I0e(x) = exp(-x) I0(x)` stays below 1.
pub fn longitudinal(v: f64, sin_i: f64, cos_i: f64, sin_o: f64, cos_o: f64) -> f64 {
    let exponent = (cos_i * cos_o - sin_i * sin_o - 1.0) / v;
    exponent.exp() * bessel_i0e(cos_i * cos_o / v) / (v * -(-2.0 / v).exp_m1())
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
