//! Light on a surface of any normal, as nine coefficients.

use std::f32::consts::PI;

use glam::{Vec3, Vec4};

/// Second-order spherical harmonics of the light that a surface receives (Ramamoorthi and Hanrahan 2001).
///
/// The poles are on the Y axis, so a turn about it mixes pairs of coefficients alone. The constants of the
/// harmonics and of the cosine lobe are multiplied in: what is left is a polynomial of the normal,
///
/// ```text
/// s0 + s1 y + s2 z + s3 x + s4 (3 y^2 - 1) / 2 + s5 y z + s6 y x + s7 (z^2 - x^2) + s8 2 x z
/// ```
///
/// which is the irradiance over pi: the radiance that leaves a white diffuse surface. A uniform surround of
/// radiance `L` gives `L`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct Surround {
    /// The coefficients `s0` to `s8`, in units of radiance.
    pub sh: [Vec3; 9],
}

/// Rows and columns of the directions on which a surround is searched for negative light.
const SEARCH: [u32; 2] = [32, 64];

impl Surround {
    /// A uniform sky above a uniform ground.
    ///
    /// Exact, and equal to `mix(ground, sky, 0.5 + 0.5 * normal.y)`: a step at the horizon has no second order,
    /// and the cosine lobe passes no odd order above the first.
    pub fn sky_and_ground(sky: Vec3, ground: Vec3) -> Self {
        let mut sh = [Vec3::ZERO; 9];
        sh[0] = 0.5 * (sky + ground);
        sh[1] = 0.5 * (sky - ground);
        Self { sh }
    }

    /// Mean radiance over all directions.
    pub fn mean(&self) -> Vec3 {
        self.sh[0]
    }

    /// The surround turned by `radians` about +Y; a positive turn takes +Z to +X.
    pub fn turned(&self, radians: f32) -> Self {
        let mut sh = self.sh;
        for (cosine, sine, order) in [(2, 3, 1.0), (5, 6, 1.0), (7, 8, 2.0)] {
            let (s, c) = (order * radians).sin_cos();
            sh[cosine] = self.sh[cosine] * c - self.sh[sine] * s;
            sh[sine] = self.sh[cosine] * s + self.sh[sine] * c;
        }
        Self { sh }
    }

    /// The surround with all light multiplied by `factor`.
    pub fn scaled(&self, factor: f32) -> Self {
        Self { sh: self.sh.map(|s| factor * s) }
    }

    /// The coefficients as nine `vec4f` of a uniform; the last component is unused and zero.
    pub fn uniform(&self) -> [Vec4; 9] {
        self.sh.map(|s| s.extend(0.0))
    }

    /// The polynomial: irradiance over pi, and negative on a ring around a small sun before [`Self::without_ringing`].
    pub(super) fn polynomial(&self, n: Vec3) -> Vec3 {
        let s = &self.sh;
        s[0] + s[1] * n.y
            + s[2] * n.z
            + s[3] * n.x
            + s[4] * (1.5 * n.y * n.y - 0.5)
            + s[5] * (n.y * n.z)
            + s[6] * (n.y * n.x)
            + s[7] * (n.z * n.z - n.x * n.x)
            + s[8] * (2.0 * n.x * n.z)
    }

    /// The surround with as much smoothing as removes negative light, and none where there is none.
    ///
    /// Three orders of a small sun ring: they are negative on a ring behind it, by 16 % of its mean. Each order
    /// `l` is divided by `1 + k (l (l + 1))^2`, which penalises the Laplacian (Sloan 2008, "Stupid Spherical
    /// Harmonics Tricks"), with the least `k` that leaves nothing negative. The mean is not touched, one `k` for
    /// all colours shifts no hue, and a factor per order commutes with turning.
    pub(super) fn without_ringing(&self) -> Self {
        let directions = search_directions();
        let rings = |k: f32| {
            let smooth = self.smoothed(k);
            directions.iter().any(|&n| smooth.polynomial(n).min_element() < 0.0)
        };
        if !rings(0.0) {
            return *self;
        }
        // 1e4 leaves less than 3e-5 of the first order, which is smaller than the mean of any radiance that is not
        // negative.
        let (mut low, mut high) = (0.0_f32, 1e4_f32);
        for _ in 0..48 {
            // Halving the logarithm of 1 + k resolves small and large k alike.
            let middle = ((1.0 + low) * (1.0 + high)).sqrt() - 1.0;
            if rings(middle) { low = middle } else { high = middle }
        }
        self.smoothed(high)
    }

    /// Each order `l` divided by `1 + k (l (l + 1))^2`.
    fn smoothed(&self, k: f32) -> Self {
        let factors = [1.0, 1.0 / (1.0 + 4.0 * k), 1.0 / (1.0 + 36.0 * k)];
        let mut sh = self.sh;
        for (at, s) in sh.iter_mut().enumerate() {
            *s *= factors[usize::from(at > 0) + usize::from(at > 3)];
        }
        Self { sh }
    }
}

/// Directions all over the sphere, 5.6 degrees apart or less.
pub(super) fn search_directions() -> Vec<Vec3> {
    let [rows, columns] = SEARCH;
    let mut directions = Vec::with_capacity((rows * columns) as usize);
    for row in 0..=rows {
        let (y, across) = (PI * (row as f32 / rows as f32 - 0.5)).sin_cos();
        for column in 0..columns {
            let (x, z) = (2.0 * PI * column as f32 / columns as f32).sin_cos();
            directions.push(Vec3::new(across * x, y, across * z));
        }
    }
    directions
}
