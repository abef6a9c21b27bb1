//! Signed distance primitives and their smooth unions (Quilez 2013 to 2020), and lofts along an axis.
//!
//! Distances are in metres and negative inside. Most are only exact to first order near the surface, which is enough for
//! [`super::mesh`]: it finds the zero set by Newton steps along the numeric gradient.

use glam::{Vec2, Vec3};

/// Smooth minimum with the cubic kernel, `k` metres wide: equal to `min` where the two differ by more than `k`.
pub(super) fn smin(a: f32, b: f32, k: f32) -> f32 {
    let h = (k - (a - b).abs()).max(0.0) / k;
    a.min(b) - h * h * h * k / 6.0
}

/// Smooth maximum, the mirror of [`smin`].
pub(super) fn smax(a: f32, b: f32, k: f32) -> f32 {
    -smin(-a, -b, k)
}

/// A ball.
pub(super) fn ball(p: Vec3, centre: Vec3, radius: f32) -> f32 {
    p.distance(centre) - radius
}

/// An ellipsoid along the axes of the space of `p`, `p` relative to its centre; first-order exact.
pub(super) fn ellipsoid(p: Vec3, radii: Vec3) -> f32 {
    let k0 = (p / radii).length();
    let k1 = (p / (radii * radii)).length();
    if k1 < 1e-6 { -radii.min_element() } else { k0 * (k0 - 1.0) / k1 }
}

/// The hull of two balls; exact up to the slope of the cone.
pub(super) fn round_cone(p: Vec3, a: Vec3, b: Vec3, radius_a: f32, radius_b: f32) -> f32 {
    let axis = b - a;
    let length_squared = axis.length_squared();
    let difference = radius_a - radius_b;
    let slope_squared = length_squared - difference * difference;
    let inverse = 1.0 / length_squared;
    let from_a = p - a;
    let y = from_a.dot(axis);
    let z = y - length_squared;
    let x2 = (from_a * length_squared - axis * y).length_squared();
    let y2 = y * y * length_squared;
    let z2 = z * z * length_squared;
    let k = difference.signum() * difference * difference * x2;
    if z.signum() * slope_squared * z2 > k {
        return (x2 + z2).sqrt() * inverse - radius_b;
    }
    if y.signum() * slope_squared * y2 < k {
        return (x2 + y2).sqrt() * inverse - radius_a;
    }
    ((x2 * slope_squared * inverse).sqrt() + y * difference) * inverse - radius_a
}

/// Turns `p` about the x axis by `angle` radians.
pub(super) fn turn_x(p: Vec3, angle: f32) -> Vec3 {
    let (s, c) = angle.sin_cos();
    Vec3::new(p.x, c * p.y - s * p.z, s * p.y + c * p.z)
}

/// Turns `p` about the y axis by `angle` radians.
pub(super) fn turn_y(p: Vec3, angle: f32) -> Vec3 {
    let (s, c) = angle.sin_cos();
    Vec3::new(c * p.x + s * p.z, p.y, -s * p.x + c * p.z)
}

/// Turns `p` about the z axis by `angle` radians.
pub(super) fn turn_z(p: Vec3, angle: f32) -> Vec3 {
    let (s, c) = angle.sin_cos();
    Vec3::new(c * p.x - s * p.y, s * p.x + c * p.y, p.z)
}

/// Value at `x` of the cubic through `keys` (first entry the abscissa), with the slopes of Catmull and Rom for
/// uneven spacing, limited so that the curve has no bumps of its own (Fritsch and Carlson 1980). Held constant
/// beyond the ends.
pub(super) fn curve<const N: usize>(keys: &[[f32; N]], x: f32) -> [f32; N] {
    let last = keys.len() - 1;
    if x <= keys[0][0] {
        return keys[0];
    }
    if x >= keys[last][0] {
        return keys[last];
    }
    let i = keys.partition_point(|key| key[0] <= x) - 1;
    let (k0, k1) = (&keys[i], &keys[i + 1]);
    let h = k1[0] - k0[0];
    let t = (x - k0[0]) / h;
    let mut out = [x; N];
    for c in 1..N {
        let here = (k1[c] - k0[c]) / h;
        let slope_at = |a: usize| -> f32 {
            if a == 0 || a == last {
                return here;
            }
            let (h0, h1) = (keys[a][0] - keys[a - 1][0], keys[a + 1][0] - keys[a][0]);
            let (d0, d1) = ((keys[a][c] - keys[a - 1][c]) / h0, (keys[a + 1][c] - keys[a][c]) / h1);
            if d0 * d1 <= 0.0 {
                return 0.0;
            }
            let mean = (d0 * h1 + d1 * h0) / (h0 + h1);
            mean.abs().min(3.0 * d0.abs().min(d1.abs())).copysign(d0)
        };
        let (m0, m1) = (slope_at(i) * h, slope_at(i + 1) * h);
        let (t2, t3) = (t * t, t * t * t);
        out[c] = (2.0 * t3 - 3.0 * t2 + 1.0) * k0[c]
            + (t3 - 2.0 * t2 + t) * m0
            + (3.0 * t2 - 2.0 * t3) * k1[c]
            + (t3 - t2) * m1;
    }
    out
}

/// A body part as sections along an axis: each section is a superellipse with its own radius on either side.
pub(super) struct Loft {
    /// The point on the axis at which the abscissa of the keys is 0.
    pub(super) origin: Vec3,
    /// Unit direction of the axis.
    pub(super) axis: Vec3,
    /// Unit direction of a section's first coordinate, at right angles to `axis`.
    pub(super) side: Vec3,
    /// Unit direction of a section's second coordinate.
    pub(super) front: Vec3,
    /// Exponent of the superellipse: 2 is an ellipse, more is squarer.
    pub(super) exponent: f32,
    /// Sections: abscissa, first coordinate's upper and lower end, second coordinate's upper end, middle and
    /// lower end; metres along their directions.
    pub(super) sections: Vec<[f32; 6]>,
}

impl Loft {
    /// Distance to the surface, first-order exact across the axis; the ends are rounded.
    pub(super) fn distance(&self, p: Vec3) -> f32 {
        let q = p - self.origin;
        let along = q.dot(self.axis);
        let (low, high) = (self.sections[0][0], self.sections[self.sections.len() - 1][0]);
        let clamped = along.clamp(low, high);
        let [_, side_high, side_low, front_high, middle, front_low] = curve(&self.sections, clamped);
        let centre = 0.5 * (side_high + side_low);
        let half = 0.5 * (side_high - side_low);
        let (u, v) = (q.dot(self.side) - centre, q.dot(self.front) - middle);
        let depth = if v > 0.0 { front_high - middle } else { middle - front_low };
        let (a, b) = (u.abs() / half, v.abs() / depth);
        let across = if self.exponent == 2.0 {
            let rho = a.hypot(b);
            let slope = Vec2::new(a / half, b / depth).length();
            if slope < 1e-5 { -half.min(depth) } else { (rho - 1.0) * rho / slope }
        } else {
            let n = self.exponent;
            let sum = a.powf(n) + b.powf(n);
            let slope = Vec2::new(a.powf(n - 1.0) / half, b.powf(n - 1.0) / depth).length();
            if slope < 1e-5 {
                -half.min(depth)
            } else {
                (sum.powf(1.0 / n) - 1.0) * sum.powf(1.0 - 1.0 / n) / slope
            }
        };
        let beyond = along - clamped;
        if beyond == 0.0 {
            return across;
        }
        let round = half.min(depth);
        Vec2::new((across + round).max(0.0), beyond).length() - round
    }
}
