//! The box and the sphere of a groom's roots.

use glam::{DMat4, DVec3, DVec4, Vec3};

use super::file::{Bounds, HairFile};

/// The most strands by which a groom is judged, evenly spaced.
const SAMPLES: usize = 4096;

pub(super) fn samples(file: &HairFile) -> impl Iterator<Item = &[Vec3]> {
    (0..file.strands()).step_by(file.strands().div_ceil(SAMPLES)).map(|strand| file.strand(strand))
}

/// A sphere fitted to points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sphere {
    pub(crate) centre: Vec3,
    pub(crate) radius: f32,
    /// Root mean square distance of the points from it, as a fraction of the radius.
    pub(crate) residual: f32,
}

/// The shape of a groom's roots, robust to a few outliers.
#[derive(Clone, Debug)]
pub(crate) struct RootShape {
    /// Box of the roots without the outermost thousandth on either side of each axis.
    pub(crate) bounds: Bounds,
    pub(crate) sphere: Option<Sphere>,
}

impl RootShape {
    pub(crate) fn of(file: &HairFile) -> Self {
        Self::of_points(&samples(file).map(|strand| strand[0]).collect::<Vec<_>>())
    }

    pub(crate) fn of_points(points: &[Vec3]) -> Self {
        let mut bounds = Bounds::EMPTY;
        let strays = points.len() / 1000;
        for axis in 0..3 {
            let mut values: Vec<f32> = points.iter().map(|p| p[axis]).collect();
            values.sort_unstable_by(f32::total_cmp);
            if let Some(last) = values.len().checked_sub(1) {
                bounds.min[axis] = values[strays];
                bounds.max[axis] = values[last - strays];
            }
        }
        Self { bounds, sphere: fit_sphere(points) }
    }

    /// The middle side of the box, or the longest where the roots lie along a line.
    pub(crate) fn span(&self) -> f32 {
        let size = self.bounds.size();
        let longest = size.max_element();
        let middle = size.element_sum() - longest - size.min_element();
        if middle > 0.2 * longest { middle } else { longest }
    }
}

/// The sphere with the least algebraic distance: |p|² = 2 c·p + (r² - |c|²) is linear in c and in the bracket. `None`
/// for fewer than four points, or points in one plane.
pub(crate) fn fit_sphere(points: &[Vec3]) -> Option<Sphere> {
    let n = points.len() as f64;
    let middle = points.iter().map(|p| p.as_dvec3()).sum::<DVec3>() / n;
    let size = points.iter().map(|p| (p.as_dvec3() - middle).abs().max_element()).fold(0.0, f64::max);
    if points.len() < 4 || size <= 0.0 {
        return None;
    }
    let (mut normal, mut right) = (DMat4::ZERO, DVec4::ZERO);
    for p in points {
        let q = (p.as_dvec3() - middle) / size;
        let row = q.extend(1.0);
        normal += DMat4::from_cols(row * row.x, row * row.y, row * row.z, row);
        right += row * q.length_squared();
    }
    let (normal, right) = (normal * (1.0 / n), right / n);
    // Points within a hundredth of a plane give a determinant of about 1e-5 of that of a ball.
    if normal.determinant().abs() < 1e-7 {
        return None;
    }
    let solution = normal.inverse() * right;
    let centre = solution.truncate() / 2.0;
    let radius = (solution.w + centre.length_squared()).sqrt();
    let sum: f64 =
        points.iter().map(|p| (((p.as_dvec3() - middle) / size).distance(centre) - radius).powi(2)).sum();
    let residual = ((sum / n).sqrt() / radius) as f32;
    (radius.is_finite() && radius > 0.0).then(|| Sphere {
        centre: (middle + centre * size).as_vec3(),
        radius: (radius * size) as f32,
        residual,
    })
}
