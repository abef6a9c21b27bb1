//! Banding: layers that a shadow method produces in hair of uniform density.

use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// How far the transmittance along a ray into a uniform slab is from smooth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Banding {
    /// Largest difference between the second derivative and that of the exponential, as a multiple of the exponential's
    /// second derivative at the entry (kappa squared). It is computed from neighbouring samples, so compare only values with
    /// the same spacing of samples.
    pub curvature: f64,
    /// Largest amplitude of all waves whose period is between two samples and a quarter of the ray.
    pub amplitude: f64,
    /// Period of that wave in metres.
    pub period: f64,
    /// Distance between two samples in metres.
    pub step: f64,
    /// Transmittance minus the exponential at each sample. Not serialised.
    #[serde(skip)]
    pub residuals: Vec<f32>,
}

/// Valid numbers of samples. The upper bound limits the time of the direct Fourier transform.
const SAMPLES: std::ops::RangeInclusive<usize> = 16..=8192;

/// Measures banding in `transmittance` at the depths `z` (metres, increasing in equal steps) in a slab of uniform density
/// whose transmittance is exp(-`kappa` z), with `kappa` in 1/m.
///
/// `None` if there are fewer than 16 or more than 8192 samples, if the steps differ by more than a hundredth, if a number is
/// not finite, or if `kappa` is not greater than 0.
pub fn banding(z: &[f32], transmittance: &[f32], kappa: f32) -> Option<Banding> {
    let kappa = f64::from(kappa);
    let all = || z.iter().chain(transmittance);
    if z.len() != transmittance.len() || !SAMPLES.contains(&z.len()) || !all().all(|v| v.is_finite()) {
        return None;
    }
    let [first, last] = [f64::from(z[0]), f64::from(z[z.len() - 1])];
    let step = (last - first) / (z.len() - 1) as f64;
    let even = |pair: &[f32]| (f64::from(pair[1]) - f64::from(pair[0]) - step).abs() <= 0.01 * step;
    if !(step > 0.0 && kappa > 0.0 && kappa.is_finite() && z.windows(2).all(even)) {
        return None;
    }
    let residual = |(&z, &t): (&f32, &f32)| f64::from(t) - (-kappa * f64::from(z)).exp();
    let residuals: Vec<f64> = z.iter().zip(transmittance).map(residual).collect();
    let bend = |three: &[f64]| ((three[0] - 2.0 * three[1] + three[2]) / (step * step)).abs();
    let curvature = residuals.windows(3).map(bend).fold(0.0, f64::max) / (kappa * kappa);
    let mut found = Banding {
        curvature,
        amplitude: 0.0,
        period: 0.0,
        step,
        residuals: residuals.iter().map(|&value| value as f32).collect(),
    };
    let span = step * z.len() as f64;
    for waves in 4..=z.len() / 2 {
        let period = span / waves as f64;
        let amplitude = found.amplitude_at(period);
        if amplitude > found.amplitude {
            (found.amplitude, found.period) = (amplitude, period);
        }
    }
    Some(found)
}

impl Banding {
    /// Amplitude of the wave with `period` in metres, such as the spacing of slices: the Fourier transform of the residuals at
    /// exactly this frequency with a Hann window. 0 if the period is not greater than 0.
    pub fn amplitude_at(&self, period: f64) -> f64 {
        let turn = TAU * self.step / period;
        if !(turn.is_finite() && turn > 0.0) {
            return 0.0;
        }
        let count = self.residuals.len() as f64;
        let (mut cos, mut sin) = (0.0, 0.0);
        for (i, &residual) in self.residuals.iter().enumerate() {
            let place = i as f64 + 0.5;
            let windowed = f64::from(residual) * (0.5 - 0.5 * (TAU * place / count).cos());
            let (s, c) = (turn * place).sin_cos();
            cos += windowed * c;
            sin += windowed * s;
        }
        // The window halves the sum, and the negative frequency takes the other half of the amplitude.
        4.0 / count.max(1.0) * cos.hypot(sin)
    }
}

#[cfg(test)]
mod tests {
    use super::banding;

    const KAPPA: f32 = 30.0;

    /// 512 samples over 10 cm.
    fn depths() -> Vec<f32> {
        (0..512).map(|i| i as f32 * 0.1 / 512.0).collect()
    }

    fn along(t: impl Fn(f32) -> f32) -> super::Banding {
        banding(&depths(), &depths().into_iter().map(t).collect::<Vec<_>>(), KAPPA).unwrap()
    }

    #[test]
    fn the_exponential_has_no_layers() {
        let found = along(|z| (-KAPPA * z).exp());
        // Only the rounding of single precision remains: 6e-8 over a squared step of 0.2 mm and a squared kappa of 900.
        assert!(found.amplitude < 1e-8 && found.curvature < 0.01, "{found:?}");
    }

    #[test]
    fn a_wave_is_found_with_its_amplitude_and_period() {
        let period = 0.1 / 16.0;
        let found = along(|z| (-KAPPA * z).exp() + 0.02 * (std::f32::consts::TAU * z / period).sin());
        assert!((found.amplitude_at(f64::from(period)) - 0.02).abs() < 1e-5, "{found:?}");
        assert!((found.period - f64::from(period)).abs() < 1e-9 && (found.amplitude - 0.02).abs() < 1e-5);
        // The second derivative of the wave is its amplitude times the square of its frequency.
        let expected = 0.02 * (std::f64::consts::TAU / f64::from(period)).powi(2) / 900.0;
        assert!((found.curvature / expected - 1.0).abs() < 0.02, "{} {expected}", found.curvature);
        // Negative control: there is no wave with another period.
        assert!(found.amplitude_at(f64::from(period) * 1.5) < 1e-4);
    }

    #[test]
    fn steps_of_slices_show_at_their_spacing_and_a_wrong_slope_does_not() {
        let slice = 0.1 / 16.0;
        let stairs = along(|z| (-KAPPA * ((z / slice).floor() + 0.5) * slice).exp());
        assert!(stairs.amplitude_at(f64::from(slice)) > 0.01, "{stairs:?}");
        assert!((stairs.period - f64::from(slice)).abs() < 1e-4, "{stairs:?}");
        let thin = along(|z| (-0.9 * KAPPA * z).exp());
        assert!(thin.amplitude_at(f64::from(slice)) < 1e-3 && thin.curvature < 0.5, "{thin:?}");
        assert!(thin.curvature < 0.01 * stairs.curvature);
    }

    #[test]
    fn invalid_samples_are_refused() {
        let z = depths();
        let t = vec![0.5; z.len()];
        assert!(banding(&z, &t, KAPPA).is_some());
        assert!(banding(&z, &t[1..], KAPPA).is_none());
        assert!(banding(&z[..15], &t[..15], KAPPA).is_none());
        assert!(banding(&z, &t, 0.0).is_none() && banding(&z, &t, f32::NAN).is_none());
        let mut broken = z.clone();
        broken[7] = f32::NAN;
        assert!(banding(&broken, &t, KAPPA).is_none());
        let reversed: Vec<f32> = z.iter().rev().copied().collect();
        assert!(banding(&reversed, &t, KAPPA).is_none());
        let uneven: Vec<f32> = z.iter().map(|z| z * z).collect();
        assert!(banding(&uneven, &t, KAPPA).is_none());
        assert_eq!(along(|_| 0.5).amplitude_at(0.0), 0.0);
    }
}
