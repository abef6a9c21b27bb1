//! The light along a ray through a chosen hair, as each pane's method sees it.

use glam::Vec3;
use lovelock_groom::Strands;
use lovelock_render::{Light, RayStructure, RenderError, Renderer, ValueRenderer};
use lovelock_session::snapshot::FrameSnapshot;

use super::round::input_of;
use crate::probe::{LiveProbe, ProbeCurve, ProbeMark, ProbePlace, ProbedHair};
use crate::request::LiveRequest;

/// Points of a curve.
const SAMPLES: usize = 257;

/// Hair this near to the ray is what the plot must reach from end to end, metres.
const NEAR: f32 = 0.006;

/// Room before the first hair and behind the last one, metres.
const MARGIN: f32 = 0.008;

/// The farthest from the point that is plotted, metres.
const FARTHEST: f32 = 0.6;

/// The hair that is followed.
#[derive(Default)]
pub(super) struct Probes {
    followed: Option<Followed>,
}

/// A point of hair that somebody chose.
struct Followed {
    number: u64,
    /// The strand, and the point among those of all strands; none where no hair was at the place.
    hair: Option<(usize, usize)>,
}

impl Probes {
    /// Finds the hair that `place` means in the pane as it was shown.
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

    /// The chosen hair on this instant, without curves.
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
            let range = reach(strands, position, direction(light));
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

/// Where a point is.
fn point_of(strands: &Strands, point: usize) -> Option<Vec3> {
    Some(Vec3::new(*strands.x.get(point)?, *strands.y.get(point)?, *strands.z.get(point)?))
}

/// The way the light travels.
pub(super) fn direction(light: &Light) -> Vec3 {
    light.direction.normalize_or(Vec3::NEG_Y)
}

/// From the first hair near the ray to the last one, with some room, metres along the light.
fn reach(strands: &Strands, at: Vec3, along: Vec3) -> [f32; 2] {
    let (mut low, mut high) = (0.0_f32, 0.0_f32);
    for ((&x, &y), &z) in strands.x.iter().zip(&strands.y).zip(&strands.z) {
        let from = Vec3::new(x, y, z) - at;
        let depth = from.dot(along);
        if (from - along * depth).length_squared() < NEAR * NEAR {
            (low, high) = (low.min(depth), high.max(depth));
        }
    }
    [(low - MARGIN).max(-FARTHEST), (high + MARGIN).min(FARTHEST)]
}

/// What the maps of a pane's last picture say along the ray, and what they keep there: on a graphics card, where they
/// cannot be looked into, what `definition` finds.
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
