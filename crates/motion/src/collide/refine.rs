//! Refinement of shapes until they fit their points closely.

use glam::{Affine3A, Mat3A, Vec3};

use super::shape::signed_distance;
use crate::ColliderShape;

/// Parameters of a shape: two centres and two radii, or a centre and three radii along its own axes.
const PARAMETERS: usize = 8;

/// A shape during fitting.
#[derive(Clone, Debug)]
pub(super) struct Fit {
    pub(super) shape: ColliderShape,
    /// Depth below the points at which the surface should lie, metres.
    pub(super) inset: f32,
    /// Whether the shape is final and must not change.
    pub(super) fixed: bool,
}

/// Beyond this distance points weigh less, so that ears, noses and fingers do not inflate the shapes, metres.
const OUTLIER: f32 = 0.015;
/// Points farther than this from the initial shapes, on either side, are ignored, metres.
const DEEP: f32 = 0.03;
/// Smallest radius, metres.
const LEAST_RADIUS: f32 = 0.004;

fn to_parameters(shape: &ColliderShape) -> [f32; PARAMETERS] {
    match *shape {
        ColliderShape::Capsule { a, b, radius_a, radius_b } => {
            [a.x, a.y, a.z, b.x, b.y, b.z, radius_a, radius_b]
        }
        ColliderShape::Ellipsoid { from_unit } => {
            let (m, c) = (from_unit.matrix3, from_unit.translation);
            [c.x, c.y, c.z, m.x_axis.length(), m.y_axis.length(), m.z_axis.length(), 0.0, 0.0]
        }
    }
}

fn from_parameters(like: &ColliderShape, p: &[f32; PARAMETERS]) -> ColliderShape {
    match like {
        ColliderShape::Capsule { .. } => ColliderShape::Capsule {
            a: Vec3::new(p[0], p[1], p[2]),
            b: Vec3::new(p[3], p[4], p[5]),
            radius_a: p[6].max(LEAST_RADIUS),
            radius_b: p[7].max(LEAST_RADIUS),
        },
        ColliderShape::Ellipsoid { from_unit } => {
            let m = from_unit.matrix3;
            let axis = |v: glam::Vec3A, length: f32| v.normalize_or_zero() * length.max(LEAST_RADIUS);
            ColliderShape::Ellipsoid {
                from_unit: Affine3A {
                    matrix3: Mat3A::from_cols(
                        axis(m.x_axis, p[3]),
                        axis(m.y_axis, p[4]),
                        axis(m.z_axis, p[5]),
                    ),
                    translation: glam::Vec3A::new(p[0], p[1], p[2]),
                },
            }
        }
    }
}

/// Distance from the union of shapes, and the index of the closest shape.
pub(super) fn union(fits: &[Fit], p: Vec3) -> (f32, usize) {
    fits.iter()
        .enumerate()
        .map(|(k, fit)| (signed_distance(&fit.shape, p) + fit.inset, k))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap_or((f32::INFINITY, 0))
}

/// Refines all shapes in turn by damped Gauss-Newton steps on the points to which each is closest, with a
/// weak pull toward its initial parameters.
pub(super) fn refine(fits: &mut [Fit], points: &[Vec3], rounds: usize) {
    // The insides of mouth and nose lie deep inside the initial shapes and are not skin.
    let points: Vec<Vec3> = points.iter().copied().filter(|&p| union(fits, p).0.abs() < DEEP).collect();
    let start: Vec<[f32; PARAMETERS]> = fits.iter().map(|f| to_parameters(&f.shape)).collect();
    for _ in 0..rounds {
        let mut own: Vec<Vec<Vec3>> = vec![Vec::new(); fits.len()];
        for &p in &points {
            own[union(fits, p).1].push(p);
        }
        for (k, points) in own.iter().enumerate() {
            if points.len() >= 8 && !fits[k].fixed {
                step(fits, k, points, &start[k]);
            }
        }
    }
}

/// Sum of robust squared distances (Huber) and of the pull.
fn cost(fit: &Fit, points: &[Vec3], parameters: &[f32; PARAMETERS], start: &[f32; PARAMETERS]) -> f32 {
    let shape = from_parameters(&fit.shape, parameters);
    let points_cost: f32 = points
        .iter()
        .map(|&p| {
            let d = (signed_distance(&shape, p) + fit.inset).abs();
            if d < OUTLIER { d * d } else { OUTLIER * (2.0 * d - OUTLIER) }
        })
        .sum();
    points_cost + pull(points) * parameters.iter().zip(start).map(|(p, s)| (p - s) * (p - s)).sum::<f32>()
}

/// Weight of the pull: a twentieth of the number of points.
fn pull(points: &[Vec3]) -> f32 {
    0.05 * points.len() as f32
}

fn step(fits: &mut [Fit], k: usize, points: &[Vec3], start: &[f32; PARAMETERS]) {
    let fit = &fits[k];
    let mut at = to_parameters(&fit.shape);
    let mut now = cost(fit, points, &at, start);
    let mut damping = 1e-3;
    for _ in 0..4 {
        // Normal equations from numeric derivatives; a tenth of a millimetre is far above rounding.
        const H: f32 = 1e-4;
        let shape = from_parameters(&fit.shape, &at);
        let moved: Vec<ColliderShape> = (0..PARAMETERS)
            .map(|i| {
                let mut p = at;
                p[i] += H;
                from_parameters(&fit.shape, &p)
            })
            .collect();
        let mut normal = [[0.0_f64; PARAMETERS]; PARAMETERS];
        let mut right = [0.0_f64; PARAMETERS];
        for &p in points {
            let raw = signed_distance(&shape, p);
            let d = raw + fit.inset;
            let weight = f64::from((OUTLIER / d.abs().max(1e-9)).min(1.0));
            let gradient: [f64; PARAMETERS] =
                std::array::from_fn(|i| f64::from((signed_distance(&moved[i], p) - raw) / H));
            for i in 0..PARAMETERS {
                right[i] -= weight * gradient[i] * f64::from(d);
                for j in 0..PARAMETERS {
                    normal[i][j] += weight * gradient[i] * gradient[j];
                }
            }
        }
        for i in 0..PARAMETERS {
            normal[i][i] += f64::from(pull(points));
            right[i] -= f64::from(pull(points) * (at[i] - start[i]));
        }
        let mut improved = false;
        for _ in 0..4 {
            let mut damped = normal;
            for (i, row) in damped.iter_mut().enumerate() {
                row[i] *= 1.0 + damping;
            }
            let Some(change) = solve(damped, right) else { break };
            let mut next = at;
            for (value, change) in next.iter_mut().zip(change) {
                *value += change as f32;
            }
            let then = cost(fit, points, &next, start);
            if then < now {
                (at, now, improved) = (next, then, true);
                damping *= 0.3;
                break;
            }
            damping = (damping * 10.0).max(1e-2);
        }
        if !improved {
            break;
        }
    }
    fits[k].shape = from_parameters(&fits[k].shape, &at);
}

/// Solves a symmetric positive definite system by Cholesky factorisation; `None` if it is not positive
/// definite.
pub(super) fn solve<const N: usize>(mut m: [[f64; N]; N], mut x: [f64; N]) -> Option<[f64; N]> {
    for i in 0..N {
        for j in 0..=i {
            let sum: f64 = m[i][j] - (0..j).map(|k| m[i][k] * m[j][k]).sum::<f64>();
            if i == j {
                if !(sum > 1e-18 && sum.is_finite()) {
                    return None;
                }
                m[i][i] = sum.sqrt();
            } else {
                m[i][j] = sum / m[j][j];
            }
        }
    }
    for i in 0..N {
        x[i] = (x[i] - (0..i).map(|k| m[i][k] * x[k]).sum::<f64>()) / m[i][i];
    }
    for i in (0..N).rev() {
        x[i] = (x[i] - (i + 1..N).map(|k| m[k][i] * x[k]).sum::<f64>()) / m[i][i];
    }
    Some(x)
}
