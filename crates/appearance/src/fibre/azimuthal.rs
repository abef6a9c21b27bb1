//! The azimuthal term and the attenuation: how light spreads around the strand, and how much the fibre absorbs.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::LOBES;

/// Reflectance of a smooth dielectric boundary for unpolarised light that arrives from the outside.
fn fresnel(cos_i: f64, index: f64) -> f64 {
    let cos_i = cos_i.clamp(0.0, 1.0);
    let cos_t = (1.0 - (1.0 - cos_i * cos_i) / (index * index)).max(0.0).sqrt();
    let parallel = (index * cos_i - cos_t) / (index * cos_i + cos_t);
    let perpendicular = (cos_i - index * cos_t) / (cos_i + index * cos_t);
    0.5 * (parallel * parallel + perpendicular * perpendicular)
}

/// Path of a ray through the circular section of a fibre (Chiang et al. 2016; Marschner et al. 2003).
#[derive(Clone, Copy, Debug)]
pub struct FibrePath {
    gamma_o: f64,
    gamma_t: f64,
    fresnel: f64,
    length: f64,
}

impl FibrePath {
    /// The path toward an eye at inclination `theta_o` that leaves the fibre at the offset `h`, -1 to 1 across its width.
    pub fn new(index: f64, sin_o: f64, cos_o: f64, h: f64) -> Self {
        let h = h.clamp(-1.0, 1.0);
        // The modified index is sqrt(index^2 - sin_o^2) / cos_o (Bravais); this form has no division by zero at cos_o = 0.
        let sin_gamma_t = (h * cos_o / (index * index - sin_o * sin_o).sqrt()).clamp(-1.0, 1.0);
        let cos_gamma_t = (1.0 - sin_gamma_t * sin_gamma_t).sqrt();
        let sin_theta_t = sin_o / index;
        let cos_theta_t = (1.0 - sin_theta_t * sin_theta_t).sqrt();
        Self {
            gamma_o: h.asin(),
            gamma_t: sin_gamma_t.asin(),
            fresnel: fresnel(cos_o * (1.0 - h * h).sqrt(), index),
            length: 2.0 * cos_gamma_t / cos_theta_t,
        }
    }

    /// Attenuation `A_p` of every lobe for the absorption `sigma` per radius. The sum is 1 without absorption (pbrt, `Ap`).
    pub fn attenuation(&self, sigma: f64) -> [f64; LOBES] {
        let f = self.fresnel;
        let t = (-sigma.max(0.0) * self.length).exp();
        let tt = (1.0 - f) * (1.0 - f) * t;
        let trt = tt * t * f;
        // At a grazing angle all light is reflected, and the geometric series would be 0 / 0.
        [f, tt, trt, trt * f * t / (1.0 - t * f).max(1e-12)]
    }

    /// Azimuth `Phi_p` in which lobe `p` leaves a smooth fibre, wrapped to -pi..pi.
    pub fn exit_azimuth(&self, p: usize) -> f64 {
        wrap(2.0 * p as f64 * self.gamma_t - 2.0 * self.gamma_o + p as f64 * PI)
    }
}

/// The angle in -pi..pi.
fn wrap(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

/// The logistic distribution of azimuths, trimmed to -pi..pi (Chiang et al. 2016; pbrt, `TrimmedLogistic`).
#[derive(Clone, Copy, Debug)]
pub struct TrimmedLogistic {
    scale: f64,
    below: f64,
    inside: f64,
}

impl TrimmedLogistic {
    /// The distribution for an azimuthal roughness.
    pub fn new(roughness_around: f64) -> Self {
        let b = roughness_around;
        let scale = 0.626_657_068_657_750_1 * (0.265 * b + 1.194 * b * b + 5.372 * b.powi(22));
        let below = 1.0 / (1.0 + (PI / scale).exp());
        Self { scale, below, inside: 1.0 - 2.0 * below }
    }

    /// Azimuthal term `N_p` of a lobe, per radian, at the azimuth `from_exit` from the smooth fibre's.
    pub fn density(&self, from_exit: f64) -> f64 {
        let e = (-wrap(from_exit).abs() / self.scale).exp();
        e / (self.scale * (1.0 + e) * (1.0 + e) * self.inside)
    }

    /// Mean of [`Self::density`] over 90 degrees to both sides. It is what light has left of its azimuth after it was scattered
    /// forward by many fibres (Zinke et al. 2008, global multiple scattering).
    pub fn mean_over_half(&self, from_exit: f64) -> f64 {
        let x = wrap(from_exit);
        (self.cumulative(x + FRAC_PI_2) - self.cumulative(x - FRAC_PI_2)) / PI
    }

    /// Integral of the density from -pi to `x` within ±2 pi, continued with period 2 pi.
    fn cumulative(&self, x: f64) -> f64 {
        let turns = (x / TAU).round();
        let inside = 1.0 / (1.0 + (-(x - TAU * turns) / self.scale).exp());
        turns + (inside - self.below) / self.inside
    }
}

#[cfg(test)]
mod tests {
    use super::super::Quadrature;
    use super::*;

    #[test]
    fn azimuths_integrate_to_one_and_their_mean_is_that_of_a_half() {
        let rule = Quadrature::new(400);
        for roughness in [0.1, 0.3, 0.6, 1.0] {
            let logistic = TrimmedLogistic::new(roughness);
            let sum = rule.integrate(-PI, 0.0, |x| logistic.density(x))
                + rule.integrate(0.0, PI, |x| logistic.density(x));
            assert!((sum - 1.0).abs() < 1e-6, "{roughness}: {sum}");
            for x in [-3.0, -1.0, 0.2, 2.0] {
                // Cut where the density has its edge and where its continuation has one.
                let mut cuts = [x - FRAC_PI_2, x + FRAC_PI_2, 0.0, PI, -PI]
                    .map(|c: f64| c.clamp(x - FRAC_PI_2, x + FRAC_PI_2));
                cuts.sort_by(f64::total_cmp);
                let truth: f64 =
                    cuts.windows(2).map(|c| rule.integrate(c[0], c[1], |y| logistic.density(y))).sum::<f64>()
                        / PI;
                assert!((logistic.mean_over_half(x) - truth).abs() < 1e-6, "{roughness}, {x}");
            }
        }
    }

    #[test]
    fn attenuations_sum_to_one_without_absorption_and_fall_with_it() {
        for cos_o in [0.0, 0.01, 0.3, 1.0_f64] {
            for h in [-1.0, -0.5, 0.0, 0.99] {
                let path = FibrePath::new(1.55, (1.0 - cos_o * cos_o).sqrt(), cos_o, h);
                let mut last = f64::INFINITY;
                for sigma in [0.0, 0.1, 1.0, 10.0, 100.0] {
                    let sum: f64 = path.attenuation(sigma).iter().sum();
                    assert!(sum <= last && sum >= 0.0);
                    assert!(sigma > 0.0 || (sum - 1.0).abs() < 1e-12);
                    last = sum;
                }
            }
        }
    }
}
