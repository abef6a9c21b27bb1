//! A linear map of the plane as two rotations and two semi-axes, continuous along a wisp.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::{Mat2, Vec2};

use crate::boundary::wrapped;

/// Semi-axes within this part of each other are those of a circle, which has no direction.
const ROUND: f32 = 1e-3;
/// Up to this difference, as a part of the longer one, the semi-axes may change places from sample to sample.
const ALMOST_ROUND: f32 = 0.2;
/// A second semi-axis below this part of the first does not say whether the map mirrors.
const FLAT: f32 = 0.02;

/// The map `R(phi) · diag(a, b) · R(theta)`: from the unit disk to an ellipse.
///
/// The point `(v cos u, v sin u)` of the disk becomes `R(phi) · (a v cos(theta + u), b v sin(theta + u))`. The paper's
/// equation 1 has no `phi`; without it, the axes of the ellipse cannot turn in the normal plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ellipse {
    /// The first semi-axis, not negative: the longer one, unless they have changed places along the wisp.
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

    /// The factors of `m` that are nearest to `before`, those of the sample before.
    ///
    /// Angles are unwrapped. A circle keeps the direction of its axes, and the change goes into the twist. An ellipse that is
    /// almost a line keeps its side.
    pub fn continued(m: Mat2, before: &Self) -> Self {
        let mut now = Self::of(m);
        if now.b.abs() < FLAT * now.a {
            now.b = now.b.abs().copysign(before.b);
        }
        let mirrored = now.b < 0.0;
        let apart = now.a - now.b.abs();
        if apart <= ROUND * now.a {
            // A circle's map depends on the sum of the angles alone, or on their difference if it mirrors.
            now.theta =
                if mirrored { before.phi - (now.phi - now.theta) } else { now.phi + now.theta - before.phi };
            now.phi = before.phi;
        } else {
            let swapped = Self {
                a: now.b.abs(),
                b: now.a.copysign(now.b),
                phi: now.phi + FRAC_PI_2,
                theta: now.theta + if mirrored { FRAC_PI_2 } else { -FRAC_PI_2 },
            };
            let turned = |of: Self| Self { phi: of.phi + PI, theta: of.theta + PI, ..of };
            let off = |of: &Self| wrapped(of.phi - before.phi).abs();
            let choices = if apart < ALMOST_ROUND * now.a { 4 } else { 2 };
            now = [now, turned(now), swapped, turned(swapped)][..choices]
                .iter()
                .copied()
                .min_by(|x, y| off(x).total_cmp(&off(y)))
                .unwrap_or(now);
        }
        now.phi = before.phi + wrapped(now.phi - before.phi);
        now.theta = before.theta + wrapped(now.theta - before.theta);
        now
    }

    /// With semi-axes of at least `least`, and at least a tenth of the other one.
    pub fn widened(self, least: f32) -> Self {
        let least = least.max(0.1 * self.a.max(self.b.abs()));
        Self { a: self.a.max(least), b: self.b.abs().max(least).copysign(self.b), ..self }
    }

    /// Scaled by `factor`.
    pub fn scaled(self, factor: f32) -> Self {
        Self { a: self.a * factor, b: self.b * factor, ..self }
    }

    /// The map.
    pub fn matrix(&self) -> Mat2 {
        let scale = Mat2::from_diagonal(Vec2::new(self.a, self.b));
        Mat2::from_angle(self.phi) * scale * Mat2::from_angle(self.theta)
    }

    /// The point of the unit disk that the map carries to `point`. The semi-axes must not be 0.
    pub fn disk_point(&self, point: Vec2) -> Vec2 {
        let along = Vec2::from_angle(-self.phi).rotate(point) / Vec2::new(self.a, self.b);
        Vec2::from_angle(-self.theta).rotate(along)
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
            let next = Ellipse::continued(m, &Ellipse { phi: 7.0, theta: 20.0, b: 1.0, ..found });
            assert!(close(next.matrix(), m) && (next.phi - 7.0).abs() <= PI + 1e-5, "{next:?}");
        }
    }

    #[test]
    fn angles_and_axes_are_continuous_through_a_circle_and_full_turns() {
        for side in [1.0, -1.0] {
            let exact = |i: f32| {
                // The axes change places halfway, while both angles turn.
                let b = side * (1.0 + 0.15 * (1.0 - i / 100.0));
                Ellipse { a: 1.0 + 0.15 * (i / 100.0), b, phi: 0.1 * i, theta: -0.07 * i }
            };
            let mut before = exact(0.0);
            let mut jumps_without_history = 0;
            for i in 1..=100 {
                let m = exact(i as f32).matrix();
                let now = Ellipse::continued(m, &before);
                assert!(close(now.matrix(), m), "{i}");
                let change = (now.phi - before.phi).abs().max((now.theta - before.theta).abs());
                assert!(change < 0.35 && (now.a - before.a).abs() < 0.01, "{i}: {before:?} to {now:?}");
                jumps_without_history += usize::from((Ellipse::of(m).phi - now.phi).abs() > 1.0);
                before = now;
            }
            assert!((before.phi - 10.0).abs() < 0.2 && (before.theta + 7.0).abs() < 0.2, "{before:?}");
            assert!(jumps_without_history > 10, "the plain decomposition jumps");
        }
    }

    #[test]
    fn lines_and_points_become_ellipses() {
        let line = Ellipse::of(Mat2::from_cols(Vec2::new(2.0, 0.0), Vec2::new(1.0, 0.0))).widened(0.01);
        assert!((line.b - 0.1 * line.a).abs() < 1e-6 && line.a > 2.2);
        let point = Ellipse::of(Mat2::ZERO).widened(0.01);
        assert_eq!((point.a, point.b), (0.01, 0.01));
        let p = Vec2::new(0.003, -0.002);
        assert!((line.matrix() * line.disk_point(p)).abs_diff_eq(p, 1e-6));
    }
}
