//! The definition of the scattering function.

use std::f64::consts::TAU;

use super::{Fibre, FibrePath, LOBES, Quadrature, TrimmedLogistic, longitudinal, variances};

/// Directions of eye and light relative to a strand.
#[derive(Clone, Copy, Debug)]
pub struct Directions {
    /// Inclination of the eye to the normal plane, -pi/2 to pi/2.
    pub theta_o: f64,
    /// Inclination of the light to the normal plane, -pi/2 to pi/2.
    pub theta_i: f64,
    /// Azimuth of the light minus that of the eye.
    pub phi: f64,
}

/// Turn of the eye's inclination per lobe, in tilts of the scales (Chiang et al. 2016; pbrt).
pub(super) const TILTS: [f64; LOBES] = [-2.0, 1.0, 4.0, 0.0];

/// Longitudinal terms of all lobes.
fn longitudinal_terms(
    fibre: &Fibre,
    at: &Directions,
    term: impl Fn(f64, f64, f64, f64, f64) -> f64,
) -> [f64; LOBES] {
    let v = variances(fibre.roughness_along);
    std::array::from_fn(|p| {
        let theta = at.theta_o + TILTS[p] * fibre.tilt;
        term(v[p], at.theta_i.sin(), at.theta_i.cos(), theta.sin(), theta.cos().abs())
    })
}

/// Scattering of light by a fibre toward a point at the offset `h` of its width, -1 to 1 (Chiang et al. 2016).
///
/// `sigma` is the absorption per radius and channel; negative values count as zero. The result is per steradian and contains the
/// cosine of the light, see the [module](super).
pub fn near_field(fibre: &Fibre, sigma: [f64; 3], h: f64, at: &Directions) -> [f64; 3] {
    near_field_with(longitudinal, fibre, sigma, h, at)
}

/// [`near_field`] with another longitudinal term, which has the arguments of [`longitudinal`]. Approximations of that term are
/// compared by it.
pub fn near_field_with(
    term: impl Fn(f64, f64, f64, f64, f64) -> f64,
    fibre: &Fibre,
    sigma: [f64; 3],
    h: f64,
    at: &Directions,
) -> [f64; 3] {
    let fibre = fibre.clamped();
    let m = longitudinal_terms(&fibre, at, term);
    let path = FibrePath::new(fibre.index, at.theta_o.sin(), at.theta_o.cos(), h);
    let n = azimuthal_terms(&TrimmedLogistic::new(fibre.roughness_around), &path, at.phi);
    sigma.map(|sigma| {
        let a = path.attenuation(sigma);
        (0..LOBES).map(|p| m[p] * a[p] * n[p]).sum()
    })
}

fn azimuthal_terms(logistic: &TrimmedLogistic, path: &FibrePath, phi: f64) -> [f64; LOBES] {
    let lobe = |p| logistic.density(phi - path.exit_azimuth(p));
    [lobe(0), lobe(1), lobe(2), 1.0 / TAU]
}

/// Distribution `D_p` over azimuth of every lobe, per radian: the mean of `A_p N_p` over the width of the fibre.
pub fn azimuthal_distribution(
    fibre: &Fibre,
    sigma: f64,
    theta_o: f64,
    phi: f64,
    rule: &Quadrature,
) -> [f64; LOBES] {
    let fibre = fibre.clamped();
    let logistic = TrimmedLogistic::new(fibre.roughness_around);
    let mut sum = [0.0; LOBES];
    for &(h, weight) in &rule.points {
        let path = FibrePath::new(fibre.index, theta_o.sin(), theta_o.cos(), h);
        let (a, n) = (path.attenuation(sigma), azimuthal_terms(&logistic, &path, phi));
        for p in 0..LOBES {
            sum[p] += 0.5 * weight * a[p] * n[p];
        }
    }
    sum
}

/// Scattering of light by a whole fibre, the mean of [`near_field`] over its width. It is what a strand shows that is narrower
/// than a pixel. `rule` samples the width; 96 points suffice for an azimuthal roughness from 0.15.
pub fn far_field(fibre: &Fibre, sigma: [f64; 3], at: &Directions, rule: &Quadrature) -> [f64; 3] {
    let m = longitudinal_terms(&fibre.clamped(), at, longitudinal);
    sigma.map(|sigma| {
        let d = azimuthal_distribution(fibre, sigma, at.theta_o, at.phi, rule);
        (0..LOBES).map(|p| m[p] * d[p]).sum()
    })
}
