//! The transmittance of each pane's method along a ray through a chosen strand point.

use glam::Vec3;
use lovelock_groom::Strands;
use lovelock_render::{Light, RayStructure, RenderError, Renderer, ValueRenderer};
use lovelock_session::snapshot::FrameSnapshot;

use super::round::input_of;
use crate::probe::{LiveProbe, ProbeCurve, ProbeMark, ProbePlace, ProbedHair};
use crate::request::LiveRequest;

/// Number of points of a curve.
const SAMPLES: usize = 257;

/// The plot covers all hair within this distance of the ray, metres.
const NEAR: f32 = 0.006;

/// Margin before the first hair and behind the last one, metres.
const MARGIN: f32 = 0.008;

/// Largest plotted distance from the point, metres.
const FARTHEST: f32 = 0.6;

/// The hair that is followed.
#[derive(Default)]
pub(super) struct Probes {
    followed: Option<Followed>,
}

/// A strand point that the user chose.
struct Followed {
    number: u64,
    /// The strand, and the point among those of all strands; `None` if there was no hair at the position.
    hair: Option<(usize, usize)>,
}

impl Probes {
    /// Finds the hair at `place` in the pane as it was shown.
    pub(super) fn choose(
        &mut self,
        values: &mut ValueRenderer,
        place: ProbePlace,
        shown: &LiveRequest,
        strands: &Strands,
    ) {
        if self.followed.as_ref().is_some_and(|followed| followed.number == place.number) {
            return;
        }
        let camera = shown.snapshot.camera(&shown.project.camera);
        let input = input_of(&shown.snapshot, &shown.project, strands, &camera);
        let pixel = [place.x * shown.width as f32, place.y * shown.height as f32];
        let hit = values.pick(&input, shown.width, shown.height, pixel);
        self.followed = Some(Followed { number: place.number, hair: hit.map(|hit| (hit.strand, hit.point)) });
    }

    /// The chosen hair at this instant, without curves.
    pub(super) fn follow(
        &self,
        snapshot: &FrameSnapshot,
        strands: &Strands,
        light: &Light,
    ) -> Option<LiveProbe> {
        let followed = self.followed.as_ref()?;
        let hair = followed.hair.and_then(|(strand, point)| {
            let position = point_of(strands, point)?;
            let first = *snapshot.scene.style.strands.first_point.get(strand)? as usize;
            let range = reach(strands, position, way_at(light, position));
            let point = point.saturating_sub(first) as u32;
            Some(ProbedHair {
                strand: strand as u32,
                point,
                position,
                range,
                steps: Vec::new(),
                curves: Vec::new(),
            })
        });
        Some(LiveProbe { number: followed.number, hair })
    }
}

/// Position of a point.
fn point_of(strands: &Strands, point: usize) -> Option<Vec3> {
    Some(Vec3::new(*strands.x.get(point)?, *strands.y.get(point)?, *strands.z.get(point)?))
}

/// The direction in which the light travels at a point.
pub(super) fn way_at(light: &Light, p: Vec3) -> Vec3 {
    light.normalized().way_to(p)
}

/// Range from the first hair near the ray to the last one, with a margin, metres along the light.
fn reach(strands: &Strands, at: Vec3, along: Vec3) -> [f32; 2] {
    let (mut low, mut high) = (0.0_f32, 0.0_f32);
    let split = |point: usize| {
        let from = point_of(strands, point)? - at;
        let depth = from.dot(along);
        Some((depth, from - along * depth))
    };
    for ends in strands.first_point.windows(2) {
        let mut before = None;
        for point in ends[0] as usize..ends[1] as usize {
            let Some((depth, across)) = split(point) else { break };
            // The place of the segment that is nearest to the ray: points may be further apart than the ray is from their segment.
            let (start, off) = before.unwrap_or((depth, across));
            let step: Vec3 = across - off;
            let t = (-off.dot(step) / step.length_squared().max(1e-12)).clamp(0.0, 1.0);
            if (off + t * step).length_squared() < NEAR * NEAR {
                let depth = start + t * (depth - start);
                (low, high) = (low.min(depth), high.max(depth));
            }
            before = Some((depth, across));
        }
    }
    [(low - MARGIN).max(-FARTHEST), (high + MARGIN).min(FARTHEST)]
}

/// The transmittance of a pane's last maps along the ray, and what they store there. On the GPU, where the maps cannot be read,
/// the marks come from `definition`.
pub(super) fn curve(
    renderer: &mut Renderer,
    (light, along): (usize, Vec3),
    hair: &ProbedHair,
    definition: impl FnOnce() -> Result<RayStructure, RenderError>,
) -> Result<ProbeCurve, RenderError> {
    let [low, high] = hair.range;
    let depth = |i: usize| low + (high - low) * i as f32 / (SAMPLES - 1) as f32;
    let mut points: Vec<Vec3> = (0..SAMPLES).map(|i| hair.position + along * depth(i)).collect();
    points.push(hair.position);
    let mut found = renderer.transmittance_at(light, &points)?;
    let value = found.pop().unwrap_or(1.0);
    let curve = found.into_iter().enumerate().map(|(i, t)| (depth(i), t)).collect();
    let kept = match renderer.along_ray(light, hair.position)? {
        Some(kept) => kept,
        None => definition()?,
    };
    let marks = kept.marks.iter().map(|mark| ProbeMark {
        kind: mark.kind.label.to_lowercase(),
        start: mark.start,
        end: mark.end,
        weight: mark.optical_depth,
    });
    Ok(ProbeCurve { method: String::new(), curve, value, marks: marks.collect() })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    #[test]
    fn the_plot_begins_before_a_segment_whose_points_are_far_from_the_ray() {
        let mut strands = Strands::default();
        (strands.x, strands.y, strands.z) = (vec![-0.05, 0.05, 0.05], vec![0.1, 0.12, 0.3], vec![0.0; 3]);
        strands.first_point = Arc::from([0, 2, 3]);
        let [low, high] = reach(&strands, Vec3::ZERO, Vec3::NEG_Y);
        assert!((low + 0.11 + MARGIN).abs() < 1e-5, "{low}");
        assert!((high - MARGIN).abs() < 1e-6, "{high}: no strand goes on from the last point of another");
        strands.first_point = Arc::from([0, 1, 2, 3]);
        assert_eq!(reach(&strands, Vec3::ZERO, Vec3::NEG_Y), [-MARGIN, MARGIN], "single points are far away");
    }
}
