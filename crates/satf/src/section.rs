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
    /// How far along the hair a place of the disk of the guides lies, metres: at the scalp, where hair lies flat, strands of a wisp begin
    /// before and behind each other.
    pub slope: Vec2,
    /// From the disk of the strands to the disk of the guides: they fill an ellipse of their own within the triangle or beyond it.
    pub fill: Mat2,
    pub offset: Vec2,
    pub crossings: Vec<Crossing>,
}

impl Section {
    /// A place of the strands' disk in the disk of the guides.
    pub fn in_guides(&self, disk: Vec2) -> Vec2 {
        self.offset + self.fill * disk
    }

    /// A place of the strands' disk in head space.
    pub fn place(&self, disk: Vec2) -> Vec3 {
        let d = self.in_guides(disk);
        self.middle + self.frame * (self.guides * d).extend(self.slope.dot(d.clamp_length_max(1.0)))
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
    let mut sections: Vec<Section> = (0..=steps)
        .map(|i| {
            let u = end * i as f32 / steps as f32;
            let (middle, frame) = (curve.blend([1.0 / 3.0; 3], u), curve.frame(u));
            let (guides, slope) =
                spanned(GUIDES.map(|only| frame.transpose() * (curve.blend(only, u) - middle)));
            let back = guides.inverse();
            let mut crossings = Vec::with_capacity(strands.len());
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
                let aside = Vec2::new(mix(&set.offset_normal), mix(&set.offset_binormal));
                let weights = set.weights[*strand];
                let at = (0..3).map(|g| reference(g) * weights[g]).sum::<Vec2>() + back * aside;
                if at.is_finite() {
                    crossings.push(Crossing { strand: k, at, taper: mix(&set.taper).max(0.0) });
                }
            }
            let (fill, offset) = (Mat2::IDENTITY, Vec2::ZERO);
            Section { u, middle, frame, guides, slope, fill, offset, crossings }
        })
        .collect();
    if !sections.iter().all(|s| s.middle.is_finite() && s.guides.is_finite() && s.slope.is_finite()) {
        return Vec::new();
    }
    fill(&mut sections);
    sections
}

/// The weights of each guide alone.
const GUIDES: [[f32; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The map from the unit disk that takes the reference triangle to the guides at `q`: its part in the plane of the section, and that
/// along the hair. Guides on a line or in a point would span no section: theirs keeps some thickness.
fn spanned(q: [Vec3; 3]) -> (Mat2, Vec2) {
    let (mut m, mut slope) = (Mat2::ZERO, Vec2::ZERO);
    for (g, q) in q.into_iter().enumerate() {
        let r = reference(g) * (2.0 / 3.0);
        m += Mat2::from_cols(q.truncate() * r.x, q.truncate() * r.y);
        slope += r * q.z;
    }
    (Ellipse::of(m).widened(2.0 * LEAST_RADIUS).matrix(), slope)
}

/// Mean and covariance of the places of strands in a section.
type Spread = (Vec2, [f32; 3]);

/// Fits the ellipse of each section to its strands: a disk that is filled evenly has a quarter of its squared radius as the
/// variance along every axis.
fn fill(sections: &mut [Section]) {
    let mut spreads: Vec<Spread> = Vec::with_capacity(sections.len());
    for section in sections.iter() {
        let crossings = &section.crossings;
        let n = crossings.len() as f32;
        // Two strands or one, at the tip of the longest, say nothing of a section: it keeps the shape of the one before.
        if crossings.len() < 3 {
            let before = spreads.last().copied();
            let mean = crossings.iter().map(|c| c.at).sum::<Vec2>() / n.max(1.0);
            let (own, [xx, xy, yy]) = before.unwrap_or((mean, [0.25, 0.0, 0.25]));
            spreads.push((own, [0.8 * xx, 0.8 * xy, 0.8 * yy]));
            continue;
        }
        let mean = crossings.iter().map(|c| c.at).sum::<Vec2>() / n;
        let mut c = [0.0; 3];
        for at in crossings.iter().map(|crossing| crossing.at - mean) {
            for (sum, product) in c.iter_mut().zip([at.x * at.x, at.x * at.y, at.y * at.y]) {
                *sum += product / n;
            }
        }
        spreads.push((mean, c));
    }
    for _ in 0..2 {
        smooth(&mut spreads);
    }
    for (section, (mean, c)) in sections.iter_mut().zip(spreads) {
        section.offset = mean;
        section.fill = root(c, section.guides) * 2.0;
        let back = section.fill.inverse();
        for crossing in &mut section.crossings {
            crossing.at = back * (crossing.at - mean);
        }
    }
}

/// Replaces each item by a weighted mean with its neighbours, so that strands that end do not make steps.
fn smooth(spreads: &mut [Spread]) {
    let before = spreads.to_vec();
    let last = before.len().saturating_sub(1);
    for (i, (mean, c)) in spreads.iter_mut().enumerate() {
        let near = [before[i.saturating_sub(1)], before[i], before[i], before[(i + 1).min(last)]];
        *mean = near.iter().map(|(mean, _)| *mean).sum::<Vec2>() / 4.0;
        *c = std::array::from_fn(|k| near.iter().map(|(_, c)| c[k]).sum::<f32>() / 4.0);
    }
}

/// The symmetric square root of a covariance in the disk of the guides, whose sections keep a thickness.
fn root([xx, xy, yy]: [f32; 3], guides: Mat2) -> Mat2 {
    let size = (0.5 * (guides.x_axis.length_squared() + guides.y_axis.length_squared())).sqrt();
    // A tenth of the larger axis, and a thickness that a few hairs have.
    let floor = (0.5 * LEAST_RADIUS / size.max(LEAST_RADIUS)).powi(2).max(0.01 * xx.max(yy)).max(1e-6);
    let (xx, yy) = (xx + floor, yy + floor);
    let area = (xx * yy - xy * xy).max(0.0).sqrt();
    let scale = 1.0 / (xx + yy + 2.0 * area).sqrt();
    Mat2::from_cols(Vec2::new(xx + area, xy) * scale, Vec2::new(xy, yy + area) * scale)
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
        let c = [0.3, 0.1, 0.2];
        let m = root(c, Mat2::IDENTITY);
        let square = m * m;
        // The floor adds a hundredth of the larger axis.
        assert!((square.x_axis.x - 0.303).abs() < 1e-4, "{square}");
        assert!((square.x_axis.y - 0.1).abs() < 1e-4 && (square.y_axis.y - 0.203).abs() < 1e-4, "{square}");
    }

    #[test]
    fn guides_on_a_line_span_a_thin_section() {
        let (line, _) = spanned([Vec3::ZERO, Vec3::new(0.01, 0.0, 0.0), Vec3::new(0.03, 0.0, 0.0)]);
        assert!(line.determinant() > 1e-6, "{line}");
        let (round, slope) = spanned([0, 1, 2].map(|g| (reference(g) * 0.01).extend(0.2 * reference(g).x)));
        assert!((slope - Vec2::new(0.2, 0.0)).length() < 1e-6, "{slope}");
        assert!((round - Mat2::IDENTITY * 0.01).to_cols_array().iter().all(|x| x.abs() < 1e-7), "{round}");
        assert!(spanned([Vec3::ZERO; 3]).0.determinant().abs() > 0.0);
    }

    #[test]
    fn constant_weights_are_the_published_ellipse_with_the_angle_of_its_axes() {
        let q = [Vec2::new(0.011, 0.002), Vec2::new(-0.004, 0.009), Vec2::new(-0.006, -0.008)];
        let middle = (q[0] + q[1] + q[2]) / 3.0;
        let (m, _) = spanned(q.map(|q| (q - middle).extend(0.0)));
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
