//! A picture reduced to spherical harmonics.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::picture::Reduced;
use super::surround::Surround;

/// Factors of the coefficients: order `l` of the cosine lobe over pi is 1, 2/3, 1/4, times `2 l + 1`, times what the
/// addition theorem of the Legendre polynomials gives to each polynomial of [`Surround`].
const FACTORS: [f64; 9] = [1.0, 2.0, 2.0, 2.0, 1.25, 3.75, 3.75, 0.9375, 0.9375];

/// The light of `picture` on surfaces, before windowing.
///
/// Each texel is taken as uniform and integrated exactly, so a constant picture of any size gives its constant.
pub(super) fn project(picture: &Reduced) -> Surround {
    // The azimuth falls from left to right. Integrals of 1, cos, sin, cos 2, sin 2 over a column.
    let antiderivatives = |column: usize| {
        let azimuth = PI - TAU * column as f64 / picture.width as f64;
        [azimuth, azimuth.sin(), -azimuth.cos(), 0.5 * (2.0 * azimuth).sin(), -0.5 * (2.0 * azimuth).cos()]
    };
    let columns: Vec<[f64; 5]> = (0..picture.width)
        .map(|at| {
            let (left, right) = (antiderivatives(at), antiderivatives(at + 1));
            std::array::from_fn(|i| left[i] - right[i])
        })
        .collect();

    let mut sums = [DVec3::ZERO; 9];
    for (row, texels) in picture.rows().enumerate() {
        let mut moments = [DVec3::ZERO; 5];
        for (weights, &texel) in columns.iter().zip(texels) {
            for (moment, &weight) in moments.iter_mut().zip(weights) {
                *moment += texel * weight;
            }
        }
        let (top, bottom) = picture.sines(row);
        let (upper, lower) = (latitude_integrals(top), latitude_integrals(bottom));
        let row: [f64; 6] = std::array::from_fn(|i| upper[i] - lower[i]);
        let [one, cos, sin, cos_2, sin_2] = moments;
        let terms = [
            one * row[0],
            one * row[1],
            cos * row[2],
            sin * row[2],
            one * row[3],
            cos * row[4],
            sin * row[4],
            cos_2 * row[5],
            sin_2 * row[5],
        ];
        for (sum, term) in sums.iter_mut().zip(terms) {
            *sum += term;
        }
    }
    Surround { sh: std::array::from_fn(|at| (sums[at] * (FACTORS[at] / (4.0 * PI))).as_vec3()) }
}

/// Integrals over the latitude, with the cosine of the sphere's area, of 1, sin, cos, (3 sin^2 - 1) / 2, sin cos and
/// cos^2, up to the latitude of the given sine.
fn latitude_integrals(sine: f64) -> [f64; 6] {
    let cosine = (1.0 - sine * sine).max(0.0).sqrt();
    [
        sine,
        0.5 * sine * sine,
        0.5 * (sine.asin() + sine * cosine),
        0.5 * (sine.powi(3) - sine),
        -cosine.powi(3) / 3.0,
        sine - sine.powi(3) / 3.0,
    ]
}
