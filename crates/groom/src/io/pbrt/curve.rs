//! One `Shape "curve"`: its parameters, and the polyline of its control points.

use glam::Vec3;

use crate::io::basis::{Basis, Shape, Spread, Wrap};

/// The parameters of a curve, as far as the geometry needs them. Reused from curve to curve.
#[derive(Clone, Debug, Default)]
pub(super) struct Parameters {
    /// Coordinates of the control points.
    pub(super) points: Vec<f32>,
    pub(super) width: Option<f32>,
    pub(super) width0: Option<f32>,
    pub(super) width1: Option<f32>,
    pub(super) degree: Option<f32>,
    /// The part of the curve that covers what is behind it; 0 hides it.
    pub(super) alpha: Option<f32>,
    pub(super) is_bspline: bool,
    /// A value that is no number, or a basis that is not known.
    pub(super) is_broken: bool,
}

impl Parameters {
    /// Makes them those of a curve about which nothing but `defaults` is stated.
    pub(super) fn reset(&mut self, defaults: &Self) {
        let mut points = std::mem::take(&mut self.points);
        points.clone_from(&defaults.points);
        *self = Self { points, ..*defaults };
    }

    /// Whether the curve is cut out by its alpha.
    pub(super) fn is_invisible(&self) -> bool {
        self.alpha.is_some_and(|alpha| alpha <= 0.0)
    }

    /// Whether the curve states a width.
    pub(super) fn has_width(&self) -> bool {
        self.width.or(self.width0).or(self.width1).is_some()
    }

    /// Appends the polyline of the curve and the width at each point. Returns the number of points, or `None` if the
    /// number of control points does not fit the degree and the basis.
    pub(super) fn polyline(&mut self, points: &mut Vec<Vec3>, widths: &mut Vec<f32>) -> Option<u32> {
        let degree = self.degree.unwrap_or(3.0);
        if self.is_broken || (degree != 2.0 && degree != 3.0) {
            return None;
        }
        let (triples, rest) = self.points.as_chunks::<3>();
        let given = triples.len();
        let fits = match (self.is_bspline, degree == 2.0) {
            (true, quadratic) => given >= if quadratic { 3 } else { 4 },
            (false, true) => given >= 3 && given % 2 == 1,
            (false, false) => given >= 4 && given % 3 == 1,
        };
        if !fits || !rest.is_empty() {
            return None;
        }
        let control: Vec<Vec3> = triples.iter().map(|&point| Vec3::from(point)).collect();
        let ends = [self.width0, self.width1].map(|width| width.or(self.width).unwrap_or(1.0));
        let begin = points.len();
        if self.is_bspline && degree == 3.0 {
            let shape = Shape::new(Basis::Bspline, Wrap::Nonperiodic);
            points.extend(shape.spread(Spread::Vertex, &control, &[given]));
            let last = (points.len() - begin - 1).max(1) as f32;
            widths.extend((0..points.len() - begin).map(|i| between(ends, i as f32 / last)));
        } else {
            let control = if degree == 2.0 {
                cubic(&if self.is_bspline { chain_of_parabolas(&control) } else { control })
            } else {
                control
            };
            beziers(&control, ends, points, widths);
        }
        Some((points.len() - begin) as u32)
    }
}

fn between([a, b]: [f32; 2], u: f32) -> f32 {
    a + (b - a) * u
}

/// Quadratic Bézier spans of a quadratic B-spline with uniform knots: they meet in the middle between control points.
fn chain_of_parabolas(control: &[Vec3]) -> Vec<Vec3> {
    let mut chain = vec![control[0].midpoint(control[1])];
    for [_, b, c] in control.array_windows() {
        chain.extend([*b, b.midpoint(*c)]);
    }
    chain
}

/// The same curve with cubic spans in place of quadratic ones.
fn cubic(quadratic: &[Vec3]) -> Vec<Vec3> {
    let mut out = vec![quadratic[0]];
    for span in 0..quadratic.len() / 2 {
        let [a, b, c] = [0, 1, 2].map(|k| quadratic[2 * span + k]);
        out.extend([a.lerp(b, 2.0 / 3.0), c.lerp(b, 2.0 / 3.0), c]);
    }
    out
}

/// Cubic Bézier spans as a polyline. A span that runs straight and evenly, as in a polyline that was written as curves,
/// becomes one segment.
fn beziers(control: &[Vec3], ends: [f32; 2], points: &mut Vec<Vec3>, widths: &mut Vec<f32>) {
    let shape = Shape::new(Basis::Bezier, Wrap::Nonperiodic);
    let spans = control.len() / 3;
    points.push(control[0]);
    widths.push(ends[0]);
    for span in 0..spans {
        let four = [0, 1, 2, 3].map(|k| control[3 * span + k]);
        let [a, b, c, d] = four;
        // What the rounding of the numbers allows.
        let near = 1e-4 * a.distance(d) + 4e-7 * (a.abs().max_element() + d.abs().max_element());
        let is_straight =
            b.distance(a.lerp(d, 1.0 / 3.0)) <= near && c.distance(a.lerp(d, 2.0 / 3.0)) <= near;
        let width = |t: f32| between(ends, (span as f32 + t) / spans as f32);
        if is_straight {
            points.push(d);
            widths.push(width(1.0));
        } else {
            let fine = shape.spread(Spread::Vertex, &four, &[4]);
            points.extend(&fine[1..]);
            widths.extend((1..fine.len()).map(|i| width(i as f32 / (fine.len() - 1) as f32)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polyline(points: &[[f32; 3]], degree: f32, is_bspline: bool) -> Option<(Vec<Vec3>, Vec<f32>)> {
        let mut parameters = Parameters {
            points: points.as_flattened().to_vec(),
            degree: Some(degree),
            is_bspline,
            width0: Some(2.0),
            width1: Some(0.0),
            ..Parameters::default()
        };
        let (mut out, mut widths) = (Vec::new(), Vec::new());
        let count = parameters.polyline(&mut out, &mut widths)?;
        assert_eq!((count as usize, out.len()), (out.len(), widths.len()));
        Some((out, widths))
    }

    #[test]
    fn parabolas_are_those_of_the_formula() {
        // (1 - t)^2 a + 2 t (1 - t) b + t^2 c with a = (0,0), b = (1,2), c = (2,0): y = 4 t (1 - t), x = 2 t.
        let (points, widths) =
            polyline(&[[0.0; 3], [1.0, 2.0, 0.0], [2.0, 0.0, 0.0]], 2.0, false).expect("fits");
        assert_eq!(points.len(), 9);
        for (i, (p, width)) in points.iter().zip(widths).enumerate() {
            let t = i as f32 / 8.0;
            assert!(p.distance(Vec3::new(2.0 * t, 4.0 * t * (1.0 - t), 0.0)) < 1e-6, "{p}");
            assert!((width - 2.0 * (1.0 - t)).abs() < 1e-6);
        }
    }

    #[test]
    fn a_quadratic_b_spline_starts_between_its_points() {
        // Uniform quadratic B-spline: (1-t)^2/2 a + (1/2 + t (1-t)) b + t^2/2 c.
        let control = [[0.0; 3], [1.0, 2.0, 0.0], [2.0, 0.0, 0.0], [3.0, 2.0, 1.0]];
        let (points, _) = polyline(&control, 2.0, true).expect("fits");
        assert_eq!(points.len(), 17);
        assert!(points[0].distance(Vec3::new(0.5, 1.0, 0.0)) < 1e-6);
        assert!(
            points[4].distance(Vec3::new(1.0, 0.125 * 0.0 + 0.75 * 2.0 + 0.0, 0.0)) < 1e-6,
            "{}",
            points[4]
        );
        assert!(points[16].distance(Vec3::new(2.5, 1.0, 0.5)) < 1e-6);
        // The cubic one: 1/6, 4/6, 1/6 at its start.
        let (points, _) = polyline(&control, 3.0, true).expect("fits");
        assert!(points[0].distance(Vec3::new(1.0, 8.0 / 6.0, 0.0)) < 1e-6);
    }

    #[test]
    fn straight_even_spans_stay_one_segment() {
        let even: Vec<[f32; 3]> = (0..7).map(|i| [60.0, 0.001 * i as f32, 1.0]).collect();
        assert_eq!(polyline(&even, 3.0, false).expect("fits").0.len(), 3);
        // The control: straight, but not even.
        let uneven: Vec<[f32; 3]> = [0.0, 0.1, 0.2, 3.0].map(|y| [0.0, y, 0.0]).to_vec();
        assert_eq!(polyline(&uneven, 3.0, false).expect("fits").0.len(), 9);
    }

    #[test]
    fn counts_that_do_not_fit_give_nothing() {
        for (count, degree, is_bspline, fits) in [
            (5, 3.0, false, false),
            (4, 2.0, false, false),
            (5, 2.0, false, true),
            (3, 3.0, true, false),
            (3, 2.0, true, true),
            (4, 4.0, false, false),
            (0, 3.0, false, false),
        ] {
            let points = vec![[0.0, 1.0, 2.0]; count];
            assert_eq!(polyline(&points, degree, is_bspline).is_some(), fits, "{count} of degree {degree}");
        }
    }
}
