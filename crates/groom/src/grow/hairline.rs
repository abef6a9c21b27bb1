//! The edge of the hairy scalp: where roots thin out, and where baby hairs grow.

use glam::Vec3;
use lovelock_base::numbers::smoothstep;
use lovelock_base::random::SplitMix64;
use lovelock_base::triangle::closest_barycentric;
use rayon::prelude::*;

use crate::{GroomSettings, Scalp, ScalpIndex, ScalpPoint};

/// Width of the strip along the edge in which baby hairs are rooted, as a fraction of the softness and in metres at least.
const BABY_STRIP: f32 = 0.5;
const LEAST_STRIP: f32 = 0.002;
/// How much farther distances are measured than the density varies, metres.
const BEYOND: f32 = 0.008;
/// How far the edge of the roots retreats at most, as a fraction of the softness.
const RETREAT: f32 = 0.35;
/// Wavelengths of the irregular edge, metres: a hairline wavers by centimetres, and single roots stand apart by
/// millimetres.
const WAVES: [f32; 6] = [0.034, 0.026, 0.019, 0.014, 0.010, 0.007];

/// The distance to the edge of the hairy scalp, and the density of roots near it.
pub(super) struct Hairline<'a> {
    scalp: &'a Scalp,
    /// Signed distance of each vertex from the edge, metres; positive where hair grows, and limited to `reach`.
    distances: Vec<f32>,
    softness: f32,
    /// Wave vectors of the irregular edge, radians per metre, and phases.
    waves: [(Vec3, f32); WAVES.len()],
}

impl<'a> Hairline<'a> {
    /// Measures the edge of the scalp at the mask's threshold of the settings.
    pub(super) fn new(settings: &GroomSettings, scalp: &'a Scalp) -> Self {
        let softness = settings.hairline_softness;
        // Farther than the density varies, because distances are interpolated over triangles of several millimetres.
        let reach = (1.0 + RETREAT) * softness + BEYOND;
        let edge = edge(scalp, settings.hairline);
        let index = ScalpIndex::new(&edge);
        let distances = (0..scalp.positions.len())
            .into_par_iter()
            .map(|v| {
                let p = scalp.positions[v];
                let near = index.closest_within(p, reach).map_or(reach, |on| on.position.distance(p));
                if scalp.mask[v] >= settings.hairline { near } else { -near }
            })
            .collect();
        let mut rng = SplitMix64::of_stream(settings.seed, 0xed6e);
        let waves = WAVES.map(|length| {
            let direction = rng.signed_vec3().normalize_or(Vec3::X);
            (direction * (std::f32::consts::TAU / length), rng.angle())
        });
        Self { scalp, distances, softness, waves }
    }

    /// Distance of a point of the scalp from the edge, metres; negative outside, and exact only near the edge.
    pub(super) fn distance(&self, point: &ScalpPoint) -> f32 {
        let corners = self.scalp.triangles[point.triangle as usize].map(|v| v as usize);
        let b = closest_barycentric(point.position, &corners.map(|v| self.scalp.positions[v]));
        (0..3).map(|i| self.distances[corners[i]] * b[i]).sum()
    }

    /// Density of roots at a point relative to that inside the scalp: 1 far from the edge, 0 beyond it.
    pub(super) fn density(&self, point: &ScalpPoint) -> f32 {
        if self.softness <= 0.0 {
            return 1.0;
        }
        let wobble: f32 =
            self.waves.iter().map(|(wave, phase)| (wave.dot(point.position) + phase).sin()).sum();
        // The sum of six waves is within ±3.5 nearly everywhere.
        let retreat = RETREAT * (0.5 + wobble / 7.0).clamp(0.0, 1.0);
        smoothstep(0.0, 1.0, self.distance(point) / self.softness - retreat)
    }

    /// Whether baby hairs grow at a point.
    pub(super) fn has_baby_hairs(&self, point: &ScalpPoint) -> bool {
        (0.0..BABY_STRIP * self.softness + LEAST_STRIP).contains(&self.distance(point))
    }
}

/// The line on the scalp at which its mask crosses `hairline`, as triangles without area: segments.
fn edge(scalp: &Scalp, hairline: f32) -> Scalp {
    let mut edge = Scalp::default();
    for &triangle in &scalp.triangles {
        let mut crossings = (0..3).filter_map(|i| {
            let [a, b] = [triangle[i] as usize, triangle[(i + 1) % 3] as usize];
            let (from, to) = (scalp.mask[a] - hairline, scalp.mask[b] - hairline);
            let crosses = (from >= 0.0) != (to >= 0.0);
            crosses.then(|| scalp.positions[a].lerp(scalp.positions[b], from / (from - to)))
        });
        if let (Some(a), Some(b)) = (crossings.next(), crossings.next()) {
            let first = edge.positions.len() as u32;
            edge.positions.extend([a, b]);
            edge.triangles.push([first, first + 1, first + 1]);
        }
    }
    edge.normals = vec![Vec3::Y; edge.positions.len()];
    edge.mask = vec![1.0; edge.positions.len()];
    edge
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flat square of 0.1 m in steps of 5 mm. Its mask crosses 0.5 at x = 0.02 m and rises with x.
    fn square() -> Scalp {
        let mut scalp = Scalp::default();
        for j in 0..=20_u32 {
            for i in 0..=20_u32 {
                scalp.positions.push(Vec3::new(i as f32, 0.0, j as f32) * 0.005);
                scalp.normals.push(Vec3::Y);
                scalp.mask.push((0.5 + (i as f32 - 4.0) * 0.3).clamp(0.0, 1.0));
                if i < 20 && j < 20 {
                    let v = j * 21 + i;
                    scalp.triangles.extend([[v, v + 21, v + 1], [v + 1, v + 21, v + 22]]);
                }
            }
        }
        scalp
    }

    fn settings(softness: f32) -> GroomSettings {
        GroomSettings { hairline: 0.5, hairline_softness: softness, ..GroomSettings::default() }
    }

    #[test]
    fn distances_are_those_from_the_edge() {
        let scalp = square();
        let hairline = Hairline::new(&settings(0.012), &scalp);
        let index = ScalpIndex::new(&scalp);
        for x in [0.008, 0.0151, 0.0212, 0.027, 0.0333_f32] {
            let point = index.closest(Vec3::new(x, 0.0, 0.047)).expect("a scalp");
            // The edge is straight here, so the interpolated distance is exact up to rounding.
            assert!(
                (hairline.distance(&point) - (x - 0.02)).abs() < 1e-6,
                "{x}: {}",
                hairline.distance(&point)
            );
            assert_eq!(hairline.has_baby_hairs(&point), (0.02..0.028).contains(&x), "{x}");
        }
    }

    #[test]
    fn density_rises_over_the_softness_along_an_irregular_edge() {
        let scalp = square();
        let index = ScalpIndex::new(&scalp);
        let along = |softness: f32, from_edge: f32| -> Vec<f32> {
            let hairline = Hairline::new(&settings(softness), &scalp);
            let places = (0..90).map(|k| Vec3::new(0.02 + from_edge, 0.0, 0.005 + 0.001 * k as f32));
            places.map(|p| hairline.density(&index.closest(p).expect("a scalp"))).collect()
        };
        let mean = |values: &[f32]| values.iter().sum::<f32>() / values.len() as f32;
        assert!(along(0.012, -0.001).iter().all(|d| *d == 0.0));
        assert!(along(0.012, 0.0165).iter().all(|d| *d == 1.0));
        let half = along(0.012, 0.008);
        assert!((0.3..0.8).contains(&mean(&half)), "{}", mean(&half));
        let spread = half.iter().map(|d| (d - mean(&half)).abs()).fold(0.0, f32::max);
        assert!(spread > 0.1, "{spread}: the edge is irregular");
        assert!(mean(&along(0.012, 0.003)) < 0.2);
        // Control: a hard hairline does not thin.
        assert!(along(0.0, 0.001).iter().all(|d| *d == 1.0));
    }

    #[test]
    fn a_scalp_without_an_edge_is_dense_everywhere() {
        let scalp = Scalp { mask: vec![1.0; 441], ..square() };
        let hairline = Hairline::new(&settings(0.012), &scalp);
        let points = scalp.sample(50, 0.5, 1);
        assert!(points.iter().all(|p| hairline.density(p) == 1.0 && !hairline.has_baby_hairs(p)));
    }
}
