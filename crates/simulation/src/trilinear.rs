//! Trilinear interpolation between values at the eight corners of a cell, x fastest.

use glam::Vec3;
use lovelock_base::numbers::mix;

/// Weights of the corners at the fractions `f` along the axes of the cell.
#[inline(always)]
pub(crate) fn weights(f: Vec3) -> [f32; 8] {
    let g = Vec3::ONE - f;
    let (a, b, c, d) = (g.y * g.z, f.y * g.z, g.y * f.z, f.y * f.z);
    [g.x * a, f.x * a, g.x * b, f.x * b, g.x * c, f.x * c, g.x * d, f.x * d]
}

/// Gradient of the interpolant, per cell.
#[inline(always)]
pub(crate) fn gradient(v: &[f32; 8], f: Vec3) -> Vec3 {
    Vec3::new(
        square(v[1] - v[0], v[3] - v[2], v[5] - v[4], v[7] - v[6], f.y, f.z),
        square(v[2] - v[0], v[3] - v[1], v[6] - v[4], v[7] - v[5], f.x, f.z),
        square(v[4] - v[0], v[5] - v[1], v[6] - v[2], v[7] - v[3], f.x, f.y),
    )
}

#[inline(always)]
fn square(a: f32, b: f32, c: f32, d: f32, s: f32, t: f32) -> f32 {
    mix(mix(a, b, s), mix(c, d, s), t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_function_and_its_gradient_are_exact() {
        let slope = Vec3::new(0.5, -2.0, 3.0);
        let corners: [f32; 8] = std::array::from_fn(|i| {
            1.0 + slope.dot(Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32))
        });
        let f = Vec3::new(0.25, 0.6, 0.9);
        let value: f32 = corners.iter().zip(weights(f)).map(|(v, w)| v * w).sum();
        // A dozen roundings of numbers up to 5.
        assert!((value - (1.0 + slope.dot(f))).abs() < 3e-6, "{value}");
        assert!((gradient(&corners, f) - slope).length() < 3e-6);
    }
}
