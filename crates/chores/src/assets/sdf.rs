//! Signed distance primitives and their smooth unions (Quilez 2013 to 2020).
//!
//! Distances are in metres and negative inside. Most are only exact to first order near the surface, which is enough for
//! [`super::mesh`]: it finds the zero set by Newton steps along the numeric gradient.

use glam::Vec3;

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
