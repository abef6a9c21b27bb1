//! The point of a triangle that is closest to another point.

use glam::Vec3;
use lovelock_base::triangle::closest_point_with;

/// The point of a triangle closest to `p`. Rounding moves it within the triangle, never off it.
pub(super) fn closest_on_triangle(triangle: &[Vec3; 3], p: Vec3) -> Vec3 {
    closest_point_with(p, triangle, |[va, vb, vc]| {
        let &[a, b, c] = triangle;
        let scale = 1.0 / (va + vb + vc);
        a + (b - a) * (vb * scale) + (c - a) * (vc * scale)
    })
}

/// Number of triangles that are measured at once.
pub(super) const LANES: usize = 8;

/// Triangles in lanes for vector instructions: one corner of each, and the edges from it.
#[derive(Clone, Debug)]
pub(super) struct Pack {
    corner: [[f32; LANES]; 3],
    edges: [[[f32; LANES]; 3]; 2],
}

impl Pack {
    /// Packs between one and [`LANES`] triangles; the last one is repeated.
    pub(super) fn new(triangles: &[[Vec3; 3]]) -> Self {
        let lanes: [[Vec3; 3]; LANES] = std::array::from_fn(|lane| triangles[lane.min(triangles.len() - 1)]);
        let apart =
            |of: fn(&[Vec3; 3]) -> Vec3| [0, 1, 2].map(|axis| lanes.map(|corners| of(&corners)[axis]));
        Self { corner: apart(|[a, ..]| *a), edges: [apart(|[a, b, _]| b - a), apart(|[a, _, c]| c - a)] }
    }

    /// The lane of the triangle closest to a point, and its squared distance. Uses the formulas of
    /// [`closest_on_triangle`] without branches: the minimum over the edges, or the face if the point is
    /// above it.
    pub(super) fn closest(&self, p: Vec3) -> (usize, f32) {
        let mut squares = [0.0_f32; LANES];
        let [[abx, aby, abz], [acx, acy, acz]] = &self.edges;
        for k in 0..LANES {
            let ap = [p.x - self.corner[0][k], p.y - self.corner[1][k], p.z - self.corner[2][k]];
            let (ab, ac) = ([abx[k], aby[k], abz[k]], [acx[k], acy[k], acz[k]]);
            let (bb, bc, cc) = (dot(ab, ab), dot(ab, ac), dot(ac, ac));
            let (d1, d2) = (dot(ab, ap), dot(ac, ap));
            let (d3, d4, d5, d6) = (d1 - bb, d2 - bc, d1 - bc, d2 - cc);
            let (va, vb, vc) = (d3 * d6 - d5 * d4, d5 * d2 - d1 * d6, d1 * d4 - d3 * d2);
            // Difference of squared distances to the corner: a quadratic form of the edge weights.
            let beside =
                |v: f32, w: f32| v * (v * bb - 2.0 * d1) + w * (w * cc - 2.0 * d2) + 2.0 * v * w * bc;
            let (along_ab, along_ac) = (unit(d1 / bb), unit(d2 / cc));
            let along_bc = unit((d4 - d3) / ((d4 - d3) + (d5 - d6)));
            let edge = least(beside(along_ab, 0.0), beside(0.0, along_ac));
            let edge = least(edge, beside(1.0 - along_bc, along_bc));
            let scale = 1.0 / (va + vb + vc);
            let face = beside(vb * scale, vc * scale);
            let above = least(va, least(vb, vc)) > 0.0;
            squares[k] = dot(ap, ap) + if above { face } else { edge };
        }
        let mut best = (0, f32::INFINITY);
        for (lane, &square) in squares.iter().enumerate() {
            if square < best.1 {
                best = (lane, square);
            }
        }
        best
    }
}

impl Pack {
    /// Cosine and sine of half the solid angle of each triangle seen from a point, up to a common factor; the
    /// sine is positive from behind (Van Oosterom and Strackee 1983, "The solid angle of a plane triangle",
    /// equation 8).
    #[inline]
    pub(super) fn half_solid_angles(&self, p: Vec3) -> ([f32; LANES], [f32; LANES]) {
        let (mut cosines, mut sines) = ([0.0; LANES], [0.0; LANES]);
        let (mut lengths, mut dots) = ([[0.0; LANES]; 3], [[0.0; LANES]; 3]);
        let [[abx, aby, abz], [acx, acy, acz]] = &self.edges;
        for k in 0..LANES {
            let a = [self.corner[0][k] - p.x, self.corner[1][k] - p.y, self.corner[2][k] - p.z];
            let (ab, ac) = ([abx[k], aby[k], abz[k]], [acx[k], acy[k], acz[k]]);
            let (b, c) =
                ([a[0] + ab[0], a[1] + ab[1], a[2] + ab[2]], [a[0] + ac[0], a[1] + ac[1], a[2] + ac[2]]);
            // The determinant of the three corners equals that of one corner and the two edges from it.
            sines[k] = a[0] * (ab[1] * ac[2] - ab[2] * ac[1])
                + a[1] * (ab[2] * ac[0] - ab[0] * ac[2])
                + a[2] * (ab[0] * ac[1] - ab[1] * ac[0]);
            (lengths[0][k], lengths[1][k], lengths[2][k]) = (dot(a, a), dot(b, b), dot(c, c));
            (dots[0][k], dots[1][k], dots[2][k]) = (dot(b, c), dot(c, a), dot(a, b));
        }
        // Square roots vectorise in a loop of their own.
        for row in &mut lengths {
            for length in row {
                *length = length.sqrt();
            }
        }
        for k in 0..LANES {
            let [a, b, c] = [lengths[0][k], lengths[1][k], lengths[2][k]];
            cosines[k] = a * b * c + dots[0][k] * a + dots[1][k] * b + dots[2][k] * c;
        }
        (cosines, sines)
    }
}

fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// One instruction, unlike [`f32::min`]; NaN gives `b`.
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Clamps to 0..=1.
fn unit(x: f32) -> f32 {
    least(if x > 0.0 { x } else { 0.0 }, 1.0)
}
