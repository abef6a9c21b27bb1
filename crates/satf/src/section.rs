//! Cross-sections of a wisp at rest, as ellipses that its strands fill.

use glam::{Mat2, Mat3, Vec2, Vec3};
use lovelock_groom::{Hairstyle, Wisp, WispCurve};

use crate::ellipse::Ellipse;

/// A section of a cluster is at least this wide from its middle, metres.
const LEAST_RADIUS: f32 = 0.0005;

/// The places of the guides in the unit disk: an equal-sided triangle (`r_g` of the exact construction).
pub(crate) fn reference(guide: usize) -> Vec2 {
    let angle = std::f32::consts::FRAC_PI_2 + std::f32::consts::TAU / 3.0 * guide as f32;
    Vec2::new(angle.cos(), angle.sin())
}

/// The weights of the guides at the place `d` of the disk: `sum(w_g r_g) = d` and `sum(w_g) = 1`.
pub(crate) fn weights_of(d: Vec2) -> [f32; 3] {
    [0, 1, 2].map(|g| 1.0 / 3.0 + 2.0 / 3.0 * d.dot(reference(g)))
}

/// One strand in one section.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    /// Index of the strand within its wisp.
    pub strand: usize,
    /// Its place in the disk of the section's ellipse: 1 away from the middle is the edge.
    pub at: Vec2,
    /// Its width as a fraction of the full one.
    pub taper: f32,
}

/// A section of a cluster at rest.
#[derive(Clone, Debug)]
pub(crate) struct Section {
    /// Parameter along the guides, links.
    pub u: f32,
    /// The mean of the guides and their frame (normal, binormal, tangent), head space.
    pub middle: Vec3,
    pub frame: Mat3,
    /// From the disk of the guides to the plane of the section, metres: `M(t)` with the reference triangle on the guides.
    pub guides: Mat2,
    /// The middle of the strands in the frame, metres.
    pub centre: Vec3,
    /// From the disk of the strands to the plane of the section, metres: they fill an ellipse of their own within the triangle of the
    /// guides or beyond it.
    pub shape: Mat2,
    /// How far along the hair a place of the disk of the strands lies, metres: at the scalp, where hair lies flat, and in bends, strands
    /// of a wisp are before and behind each other.
    pub slope: Vec2,
    pub crossings: Vec<Crossing>,
}

impl Section {
    /// A place of the strands' disk in the disk of the guides.
    pub fn in_guides(&self, disk: Vec2) -> Vec2 {
        self.guides.inverse() * (self.centre.truncate() + self.shape * disk)
    }

    /// A place of the strands' disk in head space.
    pub fn place(&self, disk: Vec2) -> Vec3 {
        self.middle + self.frame * (self.centre + (self.shape * disk).extend(self.slope.dot(disk)))
    }
}

/// Sections of a wisp at equal steps from its root to the end of its longest strand; empty if it has no strand or is not finite.
pub(crate) fn sections_of(style: &Hairstyle, wisp: &Wisp, steps: usize) -> Vec<Section> {
    let curve = WispCurve::at_rest(&style.guides, wisp);
    let set = &style.strands;
    let first = wisp.first_strand as usize;
    let strands: Vec<_> = (first..first + wisp.strand_count as usize)
        .map(|s| (s, set.first_point[s] as usize..set.first_point[s + 1] as usize))
        .collect();
    let end = strands.iter().map(|(_, points)| set.guide_param[points.end - 1]).fold(0.0, f32::max);
    if strands.is_empty() || end.is_nan() || end <= 0.0 {
        return Vec::new();
    }
    let (mut sections, places): (Vec<Section>, Vec<Vec<Vec3>>) = (0..=steps)
        .map(|i| {
            let u = end * i as f32 / steps as f32;
            let (middle, frame) = (curve.blend([1.0 / 3.0; 3], u), curve.frame(u));
            let corners = GUIDES.map(|only| frame.transpose() * (curve.blend(only, u) - middle));
            let mut crossings = Vec::with_capacity(strands.len());
            let mut places = Vec::with_capacity(strands.len());
            for (k, (strand, points)) in strands.iter().enumerate() {
                let params = &set.guide_param[points.clone()];
                // A hair beyond its end for rounding alone still counts.
                if u > params[params.len() - 1] + 1e-4 {
                    continue;
                }
                let after = params.partition_point(|&p| p < u).clamp(1, params.len() - 1);
                let (low, high) = (params[after - 1], params[after]);
                let t = ((u - low) / (high - low).max(1e-6)).clamp(0.0, 1.0);
                let i = points.start + after - 1;
                let mix = |of: &[f32]| of[i] + (of[i + 1] - of[i]) * t;
                let own =
                    Vec3::new(mix(&set.offset_normal), mix(&set.offset_binormal), mix(&set.offset_tangent));
                let weights = set.weights[*strand];
                let place = (0..3).map(|g| corners[g] * weights[g]).sum::<Vec3>() + own;
                if place.is_finite() {
                    crossings.push(Crossing { strand: k, at: Vec2::ZERO, taper: mix(&set.taper).max(0.0) });
                    places.push(place);
                }
            }
            let (guides, shape) = (spanned(corners), Mat2::IDENTITY);
            (
                Section { u, middle, frame, guides, centre: Vec3::ZERO, shape, slope: Vec2::ZERO, crossings },
                places,
            )
        })
        .unzip();
    if !sections.iter().all(|s| s.middle.is_finite() && s.guides.is_finite()) {
        return Vec::new();
    }
    fit(&mut sections, &places);
    sections
}

/// The weights of each guide alone.
const GUIDES: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The map from the unit disk to the plane of the section that takes the reference triangle to the guides at `q`. Guides on a line or in
/// a point would span no section: theirs keeps some thickness.
fn spanned(q: [Vec3; 3]) -> Mat2 {
    let mut m = Mat2::ZERO;
    for (g, q) in q.into_iter().enumerate() {
        m += outer(q.truncate(), reference(g) * (2.0 / 3.0));
    }
    Ellipse::of(m).widened(2.0 * LEAST_RADIUS).matrix()
}

/// `a bᵀ`.
fn outer(a: Vec2, b: Vec2) -> Mat2 {
    Mat2::from_cols(a * b.x, a * b.y)
}

/// Where the strands of a section are.
#[derive(Clone, Copy, Debug)]
struct Spread {
    /// Their mean in the frame, metres.
    mean: Vec3,
    /// Their covariance in the plane, square metres.
    covariance: Mat2,
    /// How much further along the hair they are per metre in the plane.
    tilt: Vec2,
}

impl Spread {
    fn of(places: &[Vec3]) -> Self {
        let n = places.len().max(1) as f32;
        let mean = places.iter().sum::<Vec3>() / n;
        let (mut covariance, mut along) = (Mat2::ZERO, Vec2::ZERO);
        for away in places.iter().map(|place| place - mean) {
            covariance += outer(away.truncate(), away.truncate()) * (1.0 / n);
            along += away.truncate() * (away.z / n);
        }
        Self { mean, covariance, tilt: floored(covariance).inverse() * along }
    }

    /// This spread of a neighbour, seen from a section with the spread `own`: strands keep either their places among the guides, if
    /// `turn` leads from the guides of the neighbour to those of the section, or their places in the plane. What leads nearer to
    /// `own` counts. Guides that are almost on a line in one section say nothing of the next.
    fn seen(self, own: Self, turn: Mat2) -> Self {
        let turned = Self {
            mean: (turn * self.mean.truncate()).extend(self.mean.z),
            covariance: turn * self.covariance * turn.transpose(),
            ..self
        };
        if turned.unlike(own) < self.unlike(own) { turned } else { self }
    }

    /// The difference of two spreads, square metres.
    fn unlike(self, other: Self) -> f32 {
        let difference = self.covariance - other.covariance;
        (difference.x_axis.length_squared() + difference.y_axis.length_squared()).sqrt()
            + (self.mean - other.mean).length_squared()
    }
}

/// Fits the ellipse of each section to its strands: a disk that is filled evenly has a quarter of its squared radius as the
/// variance along every axis.
fn fit(sections: &mut [Section], places: &[Vec<Vec3>]) {
    let mut spreads: Vec<Spread> = Vec::with_capacity(sections.len());
    for places in places {
        // Two strands or one, at the tip of the longest, do not span a section: around them it keeps the shape of the one before.
        let before = spreads.last().copied().filter(|_| places.len() < 3);
        let own = Spread::of(places);
        spreads.push(match before {
            Some(before) => Spread {
                mean: if places.is_empty() { before.mean } else { own.mean },
                covariance: before.covariance * 0.8,
                ..before
            },
            None => own,
        });
    }
    for _ in 0..2 {
        smooth(&mut spreads, sections);
    }
    for ((section, spread), places) in sections.iter_mut().zip(spreads).zip(places) {
        section.centre = spread.mean;
        // Turned as the guides are: the ellipse of the strands in the disk of the guides, without a rotation of its own.
        let back = section.guides.inverse();
        section.shape = section.guides * root(back * floored(spread.covariance) * back.transpose()) * 2.0;
        section.slope = section.shape.transpose() * spread.tilt;
        let back = section.shape.inverse();
        for (crossing, place) in section.crossings.iter_mut().zip(places) {
            crossing.at = back * (place - spread.mean).truncate();
        }
    }
}

/// Replaces each item by a weighted mean with its neighbours, so that strands that end do not make steps.
fn smooth(spreads: &mut [Spread], sections: &[Section]) {
    let before = spreads.to_vec();
    let last = before.len().saturating_sub(1);
    for (i, spread) in spreads.iter_mut().enumerate() {
        let own = before[i];
        let near = [i.saturating_sub(1), (i + 1).min(last)]
            .map(|k| before[k].seen(own, sections[i].guides * sections[k].guides.inverse()));
        spread.mean = own.mean * 0.5 + (near[0].mean + near[1].mean) * 0.25;
        spread.covariance = own.covariance * 0.5 + (near[0].covariance + near[1].covariance) * 0.25;
    }
}

/// A covariance with a tenth of the larger axis added along every axis, and a thickness that a few hairs have.
fn floored(c: Mat2) -> Mat2 {
    c + Mat2::IDENTITY * (0.25 * LEAST_RADIUS * LEAST_RADIUS).max(0.01 * c.x_axis.x.max(c.y_axis.y))
}

/// The symmetric square root of a covariance.
fn root(c: Mat2) -> Mat2 {
    let area = c.determinant().max(0.0).sqrt();
    (c + Mat2::IDENTITY * area) * (1.0 / (c.x_axis.x + c.y_axis.y + 2.0 * area).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_lead_back_to_their_place() {
        for d in [Vec2::ZERO, Vec2::new(0.3, -0.8), Vec2::new(-2.0, 1.0)] {
            let w = weights_of(d);
            let back: Vec2 = (0..3).map(|g| reference(g) * w[g]).sum();
            assert!((back - d).length() < 1e-5 && (w.iter().sum::<f32>() - 1.0).abs() < 1e-5, "{d}");
        }
    }

    #[test]
    fn the_root_of_a_covariance_is_its_root() {
        let c = Mat2::from_cols(Vec2::new(0.3, 0.1), Vec2::new(0.1, 0.2));
        assert!((root(c) * root(c)).abs_diff_eq(c, 1e-6));
        assert!(floored(c).abs_diff_eq(c + Mat2::IDENTITY * 0.003, 1e-6));
    }

    #[test]
    fn guides_on_a_line_span_a_thin_section() {
        let line = spanned([Vec3::ZERO, Vec3::new(0.01, 0.0, 0.0), Vec3::new(0.03, 0.0, 0.0)]);
        assert!(line.determinant() > 1e-6, "{line}");
        let round = spanned([0, 1, 2].map(|g| (reference(g) * 0.01).extend(0.2 * reference(g).x)));
        assert!(round.abs_diff_eq(Mat2::IDENTITY * 0.01, 1e-7), "{round}");
        assert!(spanned([Vec3::ZERO; 3]).determinant().abs() > 0.0);
    }

    #[test]
    fn strands_before_and_behind_each_other_tilt_their_section() {
        let places: Vec<Vec3> = (0..100)
            .map(|i| Vec2::from_angle(i as f32) * (0.01 * (i as f32 / 100.0).sqrt()))
            .map(|p| p.extend(0.002 + 0.5 * p.x - 2.0 * p.y))
            .collect();
        let found = Spread::of(&places);
        // The floor of the covariance takes a hundredth.
        assert!((found.tilt - Vec2::new(0.5, -2.0)).length() < 0.03, "{found:?}");
    }

    #[test]
    fn constant_weights_are_the_published_ellipse_with_the_angle_of_its_axes() {
        let q = [Vec2::new(0.011, 0.002), Vec2::new(-0.004, 0.009), Vec2::new(-0.006, -0.008)];
        let middle = (q[0] + q[1] + q[2]) / 3.0;
        let m = spanned(q.map(|q| (q - middle).extend(0.0)));
        let Ellipse { a, b, phi, theta } = Ellipse::of(m);
        for (v, u) in [(0.0, 0.0), (1.0, 0.3), (0.6, 2.0), (0.9, -1.7)] {
            let weights = weights_of(Vec2::from_angle(u) * v);
            let by_weights: Vec2 = (0..3).map(|g| q[g] * weights[g]).sum();
            let published = Vec2::new(a * v * (theta + u).cos(), b * v * (theta + u).sin());
            let by_axes = middle + Vec2::from_angle(phi).rotate(published);
            assert!((by_weights - by_axes).length() < 1e-7, "{by_weights} {by_axes}");
            // Without the angle of the axes, as printed, the ellipse cannot turn.
            assert!(v == 0.0 || (by_weights - middle - published).length() > 1e-3, "the control");
        }
    }
}
