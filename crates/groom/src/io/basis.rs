//! Evaluates curves between their control points.

use glam::Vec3;

/// Line segments per span of a cubic curve; a Bézier span covers three control points.
const PIECES: usize = 4;
const BEZIER_PIECES: usize = 8;

/// The basis of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Basis {
    Linear,
    Bezier,
    Bspline,
    CatmullRom,
}

/// What a curve does at its ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Wrap {
    Nonperiodic,
    Periodic,
    Pinned,
}

/// How the values of an attribute are distributed over the curves of a prim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Spread {
    /// One value for all.
    Constant,
    /// One value per curve.
    Uniform,
    /// One value at each end of a span, linear in between.
    Varying,
    /// One value per control point, interpolated like the points.
    Vertex,
}

/// Basis and wrap of a prim's curves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    basis: Basis,
    wrap: Wrap,
}

impl Shape {
    pub(super) fn new(basis: Basis, wrap: Wrap) -> Self {
        Self { basis, wrap }
    }

    /// Number of spans of a curve with this many control points; leftover points at its end belong to none.
    fn spans(self, points: usize) -> usize {
        match (self.basis, self.wrap) {
            (Basis::Linear, Wrap::Periodic) => points,
            (Basis::Linear, _) => points.saturating_sub(1),
            (Basis::Bezier, Wrap::Periodic) => points / 3,
            (Basis::Bezier, _) => points.saturating_sub(1) / 3,
            (_, Wrap::Periodic) => {
                if points < 3 {
                    0
                } else {
                    points
                }
            }
            (_, Wrap::Pinned) => points.saturating_sub(1),
            (_, Wrap::Nonperiodic) => points.saturating_sub(3),
        }
    }

    fn pieces(self) -> usize {
        match self.basis {
            Basis::Linear => 1,
            Basis::Bezier => BEZIER_PIECES,
            Basis::Bspline | Basis::CatmullRom => PIECES,
        }
    }

    /// Number of polyline points of a curve with this many control points; 0 if it has no span.
    pub(super) fn polyline_points(self, points: usize) -> usize {
        match self.spans(points) {
            0 => 0,
            spans => spans.saturating_mul(self.pieces()).saturating_add(1),
        }
    }

    /// Number of values at the span ends of a curve.
    fn varying(self, points: usize) -> usize {
        match (self.spans(points), self.wrap) {
            (spans, Wrap::Periodic) => spans,
            (spans, _) => spans + 1,
        }
    }

    /// One value for each point of the polylines.
    pub(super) fn spread(self, spread: Spread, values: &[Vec3], counts: &[usize]) -> Vec<Vec3> {
        let mut out = Vec::with_capacity(counts.iter().map(|&count| self.polyline_points(count)).sum());
        let mut rest = values;
        for (curve, &count) in counts.iter().enumerate() {
            let made = self.polyline_points(count);
            match spread {
                Spread::Constant => out.extend(std::iter::repeat_n(values[0], made)),
                Spread::Uniform => out.extend(std::iter::repeat_n(values[curve], made)),
                Spread::Varying => {
                    let (own, after) = rest.split_at(self.varying(count));
                    rest = after;
                    self.straight(own, count, &mut out);
                }
                Spread::Vertex => {
                    let (own, after) = rest.split_at(count);
                    rest = after;
                    self.along(own, &mut out);
                }
            }
        }
        out
    }

    fn straight(self, values: &[Vec3], count: usize, out: &mut Vec<Vec3>) {
        let (spans, pieces) = (self.spans(count), self.pieces());
        for span in 0..spans {
            let (a, b) = (values[span], values[(span + 1) % values.len()]);
            out.extend((0..pieces).map(|piece| a.lerp(b, piece as f32 / pieces as f32)));
        }
        if spans > 0 {
            out.push(values[spans % values.len()]);
        }
    }

    fn along(self, values: &[Vec3], out: &mut Vec<Vec3>) {
        let (n, spans) = (values.len(), self.spans(values.len()));
        if spans == 0 {
            return;
        }
        let stride = if self.basis == Basis::Bezier { 3 } else { 1 };
        // The first control point of span 0; for a pinned curve it lies before the first one.
        let before = usize::from(
            self.wrap == Wrap::Pinned && matches!(self.basis, Basis::Bspline | Basis::CatmullRom),
        );
        let control = |i: usize| {
            if before == 1 && i == 0 {
                2.0 * values[0] - values[1]
            } else if before == 1 && i > n {
                2.0 * values[n - 1] - values[n - 2]
            } else {
                values[(i - before) % n]
            }
        };
        let pieces = self.pieces();
        for piece in 0..=spans * pieces {
            // The last point is the end of the last span.
            let span = (piece / pieces).min(spans - 1);
            let t = (piece - span * pieces) as f32 / pieces as f32;
            let at = span * stride;
            out.push(match self.basis {
                Basis::Linear if t == 0.0 => control(at),
                Basis::Linear => control(at + 1),
                _ => {
                    let [a, b, c, d] = self.weights(t);
                    control(at) * a + control(at + 1) * b + control(at + 2) * c + control(at + 3) * d
                }
            });
        }
    }

    fn weights(self, t: f32) -> [f32; 4] {
        let s = 1.0 - t;
        match self.basis {
            Basis::Linear => [s, t, 0.0, 0.0],
            Basis::Bezier => [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t],
            Basis::Bspline => [
                s * s * s / 6.0,
                (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
                (3.0 * s * s * s - 6.0 * s * s + 4.0) / 6.0,
                t * t * t / 6.0,
            ],
            Basis::CatmullRom => [
                -0.5 * t * s * s,
                1.0 + t * t * (1.5 * t - 2.5),
                1.0 + s * s * (1.5 * s - 2.5),
                -0.5 * s * t * t,
            ],
        }
    }
}

impl Spread {
    /// The stated interpolation if the number of values matches it, otherwise the one that the number matches.
    pub(super) fn of(said: Option<&str>, values: usize, counts: &[usize], shape: Shape) -> Option<Self> {
        let wanted = |spread: Self| match spread {
            Self::Constant => 1,
            Self::Uniform => counts.len(),
            Self::Varying => counts.iter().map(|&count| shape.varying(count)).sum(),
            Self::Vertex => counts.iter().sum(),
        };
        let said = match said {
            Some("constant") => Some(Self::Constant),
            Some("uniform") => Some(Self::Uniform),
            Some("varying" | "faceVarying") => Some(Self::Varying),
            Some("vertex") => Some(Self::Vertex),
            _ => None,
        };
        let usual = [Self::Vertex, Self::Varying, Self::Uniform, Self::Constant];
        said.into_iter().chain(usual).find(|&spread| wanted(spread) == values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(basis: Basis, wrap: Wrap) -> Shape {
        Shape::new(basis, wrap)
    }

    /// Control points on the line x = i: every correct basis gives x between its controls.
    fn line(n: usize) -> Vec<Vec3> {
        (0..n).map(|i| Vec3::new(i as f32, 0.0, 0.0)).collect()
    }

    #[test]
    fn every_basis_runs_straight_along_even_points() {
        for (basis, wrap, n, ends) in [
            (Basis::Linear, Wrap::Nonperiodic, 5, [0.0, 4.0]),
            (Basis::Bezier, Wrap::Nonperiodic, 7, [0.0, 6.0]),
            (Basis::Bezier, Wrap::Pinned, 4, [0.0, 3.0]),
            (Basis::Bspline, Wrap::Nonperiodic, 6, [1.0, 4.0]),
            (Basis::CatmullRom, Wrap::Nonperiodic, 6, [1.0, 4.0]),
            (Basis::Bspline, Wrap::Pinned, 5, [0.0, 4.0]),
            (Basis::CatmullRom, Wrap::Pinned, 2, [0.0, 1.0]),
        ] {
            let shape = shape(basis, wrap);
            let out = shape.spread(Spread::Vertex, &line(n), &[n]);
            assert_eq!(out.len(), shape.polyline_points(n), "{basis:?} {wrap:?}");
            assert!((out[0].x - ends[0]).abs() < 1e-6 && (out[out.len() - 1].x - ends[1]).abs() < 1e-6);
            let step = (ends[1] - ends[0]) / (out.len() - 1) as f32;
            for (i, point) in out.iter().enumerate() {
                let wanted = ends[0] + i as f32 * step;
                assert!((point.x - wanted).abs() < 1e-5, "{basis:?} {wrap:?}: {point} for {wanted}");
            }
        }
    }

    #[test]
    fn periodic_curves_end_where_they_begin() {
        let circle: Vec<Vec3> = (0..9)
            .map(|i| (i as f32 * std::f32::consts::TAU / 9.0).sin_cos())
            .map(|(x, y)| Vec3::new(x, y, 0.0))
            .collect();
        for basis in [Basis::Linear, Basis::Bezier, Basis::Bspline, Basis::CatmullRom] {
            let out = shape(basis, Wrap::Periodic).spread(Spread::Vertex, &circle, &[9]);
            assert!(out[0].distance(out[out.len() - 1]) < 1e-6, "{basis:?}");
            assert!(out[0].distance(out[out.len() / 2]) > 0.5, "{basis:?}: the control: not a single place");
        }
    }

    #[test]
    fn values_are_distributed_by_their_count() {
        let shape = shape(Basis::Bspline, Wrap::Nonperiodic);
        let counts = [5, 4];
        for (said, values, wanted) in [
            (None, 9, Some(Spread::Vertex)),
            (None, 5, Some(Spread::Varying)),
            (None, 2, Some(Spread::Uniform)),
            (None, 1, Some(Spread::Constant)),
            (Some("varying"), 5, Some(Spread::Varying)),
            (Some("vertex"), 2, Some(Spread::Uniform)),
            (None, 4, None),
        ] {
            assert_eq!(Spread::of(said, values, &counts, shape), wanted, "{said:?} of {values}");
        }
        let varying: Vec<Vec3> = [0.0, 4.0, 8.0, 100.0, 200.0].map(Vec3::splat).to_vec();
        let out = shape.spread(Spread::Varying, &varying, &counts);
        let x: Vec<f32> = out.iter().map(|v| v.x).collect();
        assert_eq!(x, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 100.0, 125.0, 150.0, 175.0, 200.0]);
        // A curve that is too short for its basis is dropped.
        assert_eq!(shape.spread(Spread::Vertex, &line(3), &[3]), []);
    }
}
