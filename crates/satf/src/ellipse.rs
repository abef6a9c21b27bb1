//! A linear map of the plane as two rotations and two semi-axes.

use glam::{Mat2, Vec2};

/// The map `R(phi) · diag(a, b) · R(theta)`: from the unit disk to an ellipse.
///
/// The point `(v cos u, v sin u)` of the disk becomes `R(phi) · (a v cos(theta + u), b v sin(theta + u))`. The paper's
/// equation 1 has no `phi`; without it, the axes of the ellipse cannot turn in the normal plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ellipse {
    /// The first semi-axis, not negative: the longer one.
    pub a: f32,
    /// The second semi-axis, negative where the map mirrors.
    pub b: f32,
    /// Angle of the first axis, radians.
    pub phi: f32,
    /// Twist: where on the ellipse the disk's first axis is, radians.
    pub theta: f32,
}

impl Ellipse {
    /// The factors of `m`, by the closed form of the singular value decomposition in two dimensions.
    pub fn of(m: Mat2) -> Self {
        let [[a, c], [b, d]] = m.to_cols_array_2d();
        let (e, f) = (0.5 * (a + d), 0.5 * (a - d));
        let (g, h) = (0.5 * (c + b), 0.5 * (c - b));
        let (turning, mirroring) = (e.hypot(h), f.hypot(g));
        let (sum, difference) = (h.atan2(e), g.atan2(f));
        Self {
            a: turning + mirroring,
            b: turning - mirroring,
            phi: 0.5 * (sum + difference),
            theta: 0.5 * (sum - difference),
        }
    }

    /// With semi-axes of at least `least`, and at least a tenth of the other one.
    pub fn widened(self, least: f32) -> Self {
        let least = least.max(0.1 * self.a.max(self.b.abs()));
        Self { a: self.a.max(least), b: self.b.abs().max(least).copysign(self.b), ..self }
    }

    /// The map.
    pub fn matrix(&self) -> Mat2 {
        let scale = Mat2::from_diagonal(Vec2::new(self.a, self.b));
        Mat2::from_angle(self.phi) * scale * Mat2::from_angle(self.theta)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(x: Mat2, y: Mat2) -> bool {
        x.abs_diff_eq(y, 2e-5)
    }

    #[test]
    fn the_factors_make_the_map_whether_it_mirrors_or_not() {
        for [a, b, phi, theta] in
            [[2.0, 1.0, 0.3, -2.0], [3.0, -0.5, 2.5, 1.0], [1.0, -1.0, 0.4, 0.9], [0.0; 4]]
        {
            let m = Ellipse { a, b, phi, theta }.matrix();
            let found = Ellipse::of(m);
            assert!(close(found.matrix(), m), "{found:?}");
            assert!((found.a - a).abs() < 1e-6 && (found.b - b).abs() < 1e-6);
        }
    }

    #[test]
    fn lines_and_points_become_ellipses() {
        let line = Ellipse::of(Mat2::from_cols(Vec2::new(2.0, 0.0), Vec2::new(1.0, 0.0))).widened(0.01);
        assert!((line.b - 0.1 * line.a).abs() < 1e-6 && line.a > 2.2);
        let point = Ellipse::of(Mat2::ZERO).widened(0.01);
        assert_eq!((point.a, point.b), (0.01, 0.01));
        let p = Vec2::new(0.003, -0.002);
        assert!((line.matrix() * (line.matrix().inverse() * p)).abs_diff_eq(p, 1e-6));
    }
}
