//! A projected triangle as planes over a tile.
// Functions are inlined into the loops that `simd_versions!` compiles.
#![allow(clippy::inline_always)]

use crate::cpu::math::{max, three};

/// Whether the camera sees the back of a triangle, whose corners are pixels times w, and w. Pixels count downward, which reverses
/// the counter-clockwise orientation of front faces.
#[inline(always)]
pub(super) fn faces_away([p, q, r]: [[f32; 3]; 3]) -> bool {
    let volume = p[0] * (q[1] * r[2] - r[1] * q[2])
        + p[1] * (r[0] * q[2] - q[0] * r[2])
        + p[2] * (q[0] * r[1] - r[0] * q[1]);
    volume > 0.0
}

/// The three edges of a triangle as planes over a tile.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edges {
    /// The barycentric coordinate of the corner opposite to each edge is `a x + b y + c`, up to a common factor; not negative inside.
    pub planes: [[f32; 3]; 3],
    /// Their sum times this is 1/w.
    pub scale: f32,
}

impl Edges {
    /// `None` if the triangle has no area or is not finite.
    #[inline(always)]
    pub fn new(corners: [[f32; 3]; 3], origin: [f32; 2]) -> Option<Self> {
        let local = |[x, y, w]: [f32; 3]| [x - origin[0] * w, y - origin[1] * w, w];
        let [p, q, r] = [local(corners[0]), local(corners[1]), local(corners[2])];
        let cross = |a: [f32; 3], b: [f32; 3]| {
            [a[1] * b[2] - b[1] * a[2], b[0] * a[2] - a[0] * b[2], a[0] * b[1] - b[0] * a[1]]
        };
        let planes = [cross(q, r), cross(r, p), cross(p, q)];
        let volume = p[0] * planes[0][0] + p[1] * planes[0][1] + p[2] * planes[0][2];
        if !volume.is_finite() || volume == 0.0 {
            return None;
        }
        let sign = 1.0_f32.copysign(volume);
        Some(Self {
            planes: [scaled(planes[0], sign), scaled(planes[1], sign), scaled(planes[2], sign)],
            scale: sign / volume,
        })
    }

    /// The perspective-correct barycentric coordinates of a point of the tile; their sum is 1.
    #[inline(always)]
    pub fn shares(&self, x: f32, y: f32) -> [f32; 3] {
        // The centre of a partly covered pixel may lie outside: clamp it into the triangle.
        let e = three(|i| max(at(self.planes[i], x, y), 0.0));
        let sum = e[0] + e[1] + e[2];
        if sum > 0.0 { [e[0] / sum, e[1] / sum, e[2] / sum] } else { [1.0, 0.0, 0.0] }
    }
}

/// The value of a plane.
#[inline(always)]
pub(super) fn at([a, b, c]: [f32; 3], x: f32, y: f32) -> f32 {
    a * x + b * y + c
}

#[inline(always)]
fn scaled([a, b, c]: [f32; 3], by: f32) -> [f32; 3] {
    [a * by, b * by, c * by]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_of_the_corners() {
        let corners = [[0.0, 0.0, 1.0], [20.0, 0.0, 2.0], [0.0, 30.0, 3.0]];
        let edges = Edges::new(corners, [0.0, 0.0]).expect("an area");
        // Homogeneous: the corners lie at (0, 0), (10, 0) and (0, 10).
        for (corner, at) in [(0, [0.0, 0.0]), (1, [10.0, 0.0]), (2, [0.0, 10.0])] {
            assert!((edges.shares(at[0], at[1])[corner] - 1.0).abs() < 1e-5);
        }
        // Halfway on the screen is nearer to the near corner in space: shares 2/3 and 1/3 for w of 1 and 2.
        let [a, b, _] = edges.shares(5.0, 0.0);
        assert!((a - 2.0 / 3.0).abs() < 1e-5 && (b - 1.0 / 3.0).abs() < 1e-5, "{a} {b}");
    }
}
