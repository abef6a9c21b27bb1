//! Table of what one fibre does to light that many fibres scatter.
// Inlined into the loops of a renderer; a call would prevent vectorisation.
#![allow(clippy::inline_always)]

use rayon::prelude::*;

use super::longitudinal::VARIANCE_RATIOS;
use super::table::{
    Between, COSINES, Columns, CosineStep, SMOOTHEST_AROUND, WIDTH_POINTS, cosine, row_of, step,
};
use super::{Fibre, FibrePath, LOBES, Quadrature, TrimmedLogistic};

/// Steps of the absorption.
pub const ABSORPTIONS: usize = 64;
/// Largest backscattered variance, relative to that of R. A lobe of this width is flat at every roughness above 0.1.
const WIDEST: f64 = 200.0;

/// A row of a [`ManyTable`], for one inclination and one absorption.
///
/// | index | value |
/// |---|---|
/// | 0 | `a_f`, the share of light that one fibre scatters forward (Zinke et al. 2008, forward scattering transmittance) |
/// | 1 | `a_b`, the share that it scatters backward |
/// | 2 | variance of the forward scattering over that of R: `sum ratio_p a_fp / a_f` |
/// | 3 | variance of the backward scattering over that of R |
/// | 4 | `A_b`, light that returns from the fibres behind after any number of scatterings, see [`backscattered`] |
/// | 5 | its variance over that of R: `2 b_f a_f^2 / (1 - a_f^2) + b_b` |
/// | 6 | rate of the attenuation of diffuse light per crossed fibre: `sqrt((1 - a_f)^2 - a_b^2)` |
/// | 7 | distribution of the paths longer than TRT per radian, the same at every azimuth |
pub type ManyRow = [f32; 8];

/// Multiple scattering by absorption and inclination, for [`super::PointScatter`].
///
/// The rows are a flat array of 16 x 64 rows of 8 values (32 KB). Row `j * 64 + k` is that of the cosine of the same `j` as in a
/// [`super::ScatterTable`] and of the absorption whose [`position`] is `k`. Values between are interpolated bilinearly.
/// Variances are relative to that of R, so the table depends on the azimuthal roughness and the index of refraction, and on
/// nothing else.
#[derive(Clone, Debug, PartialEq)]
pub struct ManyTable {
    rows: Vec<ManyRow>,
}

/// Position of an absorption on the axis of the table, 0 to 63: `63 sqrt(sigma) / (1 + sqrt(sigma))`.
///
/// It resolves light hair finely, where the root of the albedo's loss counts, and its end is an infinite absorption, so nothing
/// is clamped.
#[inline(always)]
pub fn position(sigma: f32) -> f32 {
    let root = sigma.max(0.0).sqrt().min(1e9);
    (ABSORPTIONS - 1) as f32 * root / (1.0 + root)
}

/// The absorption at entry `k` of the axis.
fn absorption(k: usize) -> f64 {
    // The last entry is infinite; what is this large transmits nothing either.
    let u = (k as f64 / (ABSORPTIONS - 1) as f64).min(1.0 - 1e-6);
    (u / (1.0 - u)).powi(2)
}

/// Light that returns from endless fibres behind, beyond what the first one scatters backward.
///
/// It is the reflectance of an endless stack of layers which transmit `a_f` and reflect `a_b`, less the first layer. For
/// coloured hair it agrees with the two terms of Zinke et al. 2008 for the average backscattering attenuation and for white hair
/// it is the energy that they leave out.
pub fn backscattered(a_f: f64, a_b: f64) -> f64 {
    let q = 1.0 + a_b * a_b - a_f * a_f;
    let root = (q * q - 4.0 * a_b * a_b).max(0.0).sqrt();
    // The smaller root of the quadratic equation for the reflectance, in the form in which nothing cancels.
    let reflectance = 2.0 * a_b / (q + root).max(1e-12);
    (reflectance - a_b).clamp(0.0, 1.0)
}

impl ManyTable {
    /// The table of a fibre.
    pub fn bake(fibre: &Fibre) -> Self {
        let fibre = fibre.clamped();
        let logistic = TrimmedLogistic::new(fibre.roughness_around.max(SMOOTHEST_AROUND));
        let rule = Quadrature::new(WIDTH_POINTS);
        let rows = (0..COSINES)
            .into_par_iter()
            .flat_map_iter(|j| rows_of_cosine(fibre.index, &logistic, cosine(j), &rule));
        Self { rows: rows.collect() }
    }

    /// All values as a flat array of 8,192 numbers, for a buffer of the GPU.
    pub fn values(&self) -> &[f32] {
        self.rows.as_flattened()
    }

    /// The row of an inclination and an absorption.
    pub fn row(&self, eye: CosineStep, sigma: f32) -> ManyRow {
        row_of(self.columns(&[eye], &[sigma]))
    }

    /// The rows of several inclinations and absorptions, by value.
    #[inline(always)]
    pub(super) fn columns<const N: usize>(&self, eye: &[CosineStep; N], sigma: &[f32; N]) -> Columns<N> {
        let mut at = Between { first: [0; N], next: [0.0; N], later: [0.0; N], stride: ABSORPTIONS };
        for lane in 0..N {
            let (k, x) = step(position(sigma[lane]), ABSORPTIONS);
            at.first[lane] = eye[lane].index * ABSORPTIONS + k;
            (at.next[lane], at.later[lane]) = (x, eye[lane].fraction);
        }
        at.columns(&self.rows)
    }
}

fn rows_of_cosine(index: f64, logistic: &TrimmedLogistic, cos_o: f64, rule: &Quadrature) -> Vec<ManyRow> {
    use std::f64::consts::{PI, TAU};
    let sin_o = (1.0 - cos_o * cos_o).sqrt();
    // Per point of the width, its path and the share of every lobe that leaves forward, away from the eye.
    let paths: Vec<_> = rule
        .points
        .iter()
        .map(|&(h, weight)| {
            let path = FibrePath::new(index, sin_o, cos_o, h);
            let lobe = |p| PI * logistic.mean_over_half(PI - path.exit_azimuth(p));
            (path, [lobe(0), lobe(1), lobe(2), 0.5], 0.5 * weight)
        })
        .collect();
    let row = |k| {
        let (mut forward, mut backward) = ([0.0; LOBES], [0.0; LOBES]);
        for (path, shares, weight) in &paths {
            let a = path.attenuation(absorption(k));
            for p in 0..LOBES {
                forward[p] += weight * a[p] * shares[p];
                backward[p] += weight * a[p] * (1.0 - shares[p]);
            }
        }
        let sum = |shares: [f64; LOBES]| shares.iter().sum::<f64>();
        let spread = |shares: [f64; LOBES]| {
            (0..LOBES).map(|p| VARIANCE_RATIOS[p] * shares[p]).sum::<f64>() / sum(shares).max(1e-12)
        };
        let (a_f, a_b) = (sum(forward), sum(backward));
        let (b_f, b_b) = (spread(forward), spread(backward));
        let returned = (2.0 * b_f * a_f * a_f / (1.0 - a_f * a_f).max(1e-9) + b_b).min(WIDEST);
        let rate = ((1.0 - a_f).powi(2) - a_b * a_b).max(0.0).sqrt();
        [a_f, a_b, b_f, b_b, backscattered(a_f, a_b), returned, rate, (forward[3] + backward[3]) / TAU]
            .map(|x| x as f32)
    };
    (0..ABSORPTIONS).map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::backscattered;

    #[test]
    fn returned_light_is_that_of_zinke_for_colours_and_everything_for_white() {
        let zinke = |f: f64, b: f64| {
            let rest = 1.0 - f * f;
            b * f * f / rest + b.powi(3) * f * f / (rest * rest)
        };
        for (f, b) in [(0.710, 0.073), (0.403, 0.047), (0.342, 0.043), (0.041, 0.034)] {
            // Blonde's red channel differs most, by 1.2 %.
            assert!((backscattered(f, b) / zinke(f, b) - 1.0).abs() < 0.015, "{f} {b}");
        }
        assert!((backscattered(0.903, 0.097) - 0.903).abs() < 1e-6);
        assert!((zinke(0.903, 0.097) - 0.903).abs() > 0.4);
        assert_eq!(backscattered(0.0, 0.0), 0.0);
        assert!(backscattered(1.0, 0.0).is_finite());
    }
}
