//! Radiance from around the six axes.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

use glam::{DVec3, Vec3};

use super::picture::Reduced;

/// Angles at which the radiance toward the horizon is stored. Linear between them, the error of a small sun is
/// at most 2e-4 of its peak: `h^2 / 8` times the largest second derivative of the squared cosine, 2.
const ANGLES: usize = 256;

/// The solid angle of each weight: six of them share the sphere.
const SEXTANT: f64 = 4.0 * PI / 6.0;

/// Radiance from around the vertical axes, and from around the horizontal axis of every azimuth.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Axes {
    up: Vec3,
    down: Vec3,
    /// At azimuth `2 pi i / ANGLES`, counted from +Z toward +X.
    sides: Vec<Vec3>,
}

impl Axes {
    /// Weighs the texels, each taken as uniform, by exact integrals of the squared cosine.
    pub(super) fn new(picture: &Reduced) -> Self {
        let (mut up, mut down) = (DVec3::ZERO, DVec3::ZERO);
        let mut columns = vec![DVec3::ZERO; picture.width];
        let wide = TAU / picture.width as f64;
        for (row, texels) in picture.rows().enumerate() {
            // Sine of the latitude at the upper and the lower border.
            let (top, bottom) = picture.sines(row);
            // Of sin^2 over the sphere: the part above and the part below the horizon.
            let cubes = |sine: f64| sine.powi(3) / 3.0;
            let above = cubes(top.max(0.0)) - cubes(bottom.max(0.0));
            let below = cubes(top.min(0.0)) - cubes(bottom.min(0.0));
            let across = (top - cubes(top)) - (bottom - cubes(bottom));
            for (column, &texel) in columns.iter_mut().zip(texels) {
                up += texel * (above * wide);
                down += texel * (below * wide);
                *column += texel * across;
            }
        }
        let sides = (0..ANGLES).map(|at| side(&columns, TAU * at as f64 / ANGLES as f64).as_vec3());
        Self { up: (up / SEXTANT).as_vec3(), down: (down / SEXTANT).as_vec3(), sides: sides.collect() }
    }

    /// The six radiances, in the order +X, -X, +Y, -Y, +Z, -Z, of the surroundings turned by `turn` radians.
    pub(super) fn turned(&self, turn: f32) -> [Vec3; 6] {
        let quarter = |quarters: usize| self.toward(quarters, turn);
        [quarter(1), quarter(3), self.up, self.down, quarter(0), quarter(2)]
    }

    /// Radiance from around the azimuth of `quarters` right angles. What is there after the turn was `turn` before
    /// it.
    fn toward(&self, quarters: usize, turn: f32) -> Vec3 {
        let at = (-f64::from(turn) / TAU).rem_euclid(1.0) * ANGLES as f64;
        let first = at as usize;
        let index = |step: usize| (first + step + quarters * ANGLES / 4) % ANGLES;
        self.sides[index(0)].lerp(self.sides[index(1)], (at - first as f64) as f32)
    }
}

/// Radiance from around the horizontal axis at `azimuth`, of the sums of columns.
fn side(columns: &[DVec3], azimuth: f64) -> DVec3 {
    let border = |column: usize| squared_cosine(PI - TAU * column as f64 / columns.len() as f64 - azimuth);
    let weighed = columns.iter().enumerate().map(|(at, &sum)| sum * (border(at) - border(at + 1)));
    weighed.sum::<DVec3>() / SEXTANT
}

/// The integral of `max(0, cos t)^2` from 0 to `angle`.
fn squared_cosine(angle: f64) -> f64 {
    let turns = (angle / TAU).round();
    let rest = (angle - turns * TAU).clamp(-FRAC_PI_2, FRAC_PI_2);
    turns * 2.0 * FRAC_PI_4 + 0.5 * rest + 0.25 * (2.0 * rest).sin()
}
