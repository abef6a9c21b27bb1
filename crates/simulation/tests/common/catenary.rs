//! The catenary, the curve of a chain whose ends are held at the same height.

use glam::DVec3;

/// Largest distance along Y between the points and the catenary of that length from the origin to `apart`
/// metres along X, metres.
pub fn off_the_catenary(points: &[DVec3], length: f64, apart: f64) -> f64 {
    let half = 0.5 * apart;
    // Its parameter `a` solves `2 a sinh(half / a) = length`.
    let (mut low, mut high) = (0.01_f64, 1.0_f64);
    for _ in 0..100 {
        let a = 0.5 * (low + high);
        if 2.0 * a * (half / a).sinh() > length { low = a } else { high = a }
    }
    let a = 0.5 * (low + high);
    let y = |x: f64| a * (((x - half) / a).cosh() - (half / a).cosh());
    points.iter().map(|p| (p.y - y(p.x)).abs()).fold(0.0, f64::max)
}
