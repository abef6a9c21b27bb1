//! Lays the guides of a wisp along its path through a ring.

use glam::Vec3;

use super::route::{Ring, SPARE, STEP};
use super::{CAUGHT, Gathered, HairTie};
use crate::frame::{reference_normal, transport};
use crate::polyline::{Reach, next_at, sample};
use crate::{Guides, Hairstyle, Obstacle};

/// Distance of the lowest tied hair above the skin, metres.
const SKIN: f32 = 0.002;
/// Distance between the lowest and the highest tied hair, metres, at a tightness of 1 and of 0.
const THICKNESS: [f32; 2] = [0.006, 0.014];
/// Width of a wisp in the ring, in radii of the ring.
const WISP: f32 = 0.2;

/// The guides of a wisp as laid by a tie.
pub(super) struct GatheredHair {
    /// The points of the three guides, head space.
    pub(super) guides: [Vec<Vec3>; 3],
    /// The first point of each guide beyond the ring.
    pub(super) ring_point: [usize; 3],
}

/// Length of a guide, metres.
pub(super) fn length(guides: &Guides, guide: usize) -> f32 {
    (1..guides.points_per_guide).map(|i| guides.point(guide, i).distance(guides.point(guide, i - 1))).sum()
}

/// The height above the skin of hair that has come `arc` metres from its root, with the fraction `layer` of the gathered hair below
/// it, metres.
pub(super) fn height(tie: &HairTie, layer: f32, arc: f32) -> f32 {
    let thick = THICKNESS[1] + (THICKNESS[0] - THICKNESS[1]) * tie.tightness;
    let rises = 1.0 - (-arc / 0.05).exp();
    (SKIN + thick * layer * rises).min(0.6 * arc + 0.0005)
}

/// Lays the guides of a wisp; `None` where one of them cannot reach beyond the ring.
pub(super) fn wisp(
    style: &Hairstyle,
    ring: &Ring,
    caught: &Gathered,
    middle: Vec3,
    obstacle: &dyn Obstacle,
) -> Option<GatheredHair> {
    let guides = style.wisps[caught.wisp].guides.map(|g| g as usize);
    let roots = guides.map(|g| style.guides.point(g, 0));
    let lengths = guides.map(|g| length(&style.guides, g));
    let root = (roots[0] + roots[1] + roots[2]) / 3.0;
    let [a, b] = ring.across;
    let through = ring.centre + (a * caught.disc[0] + b * caught.disc[1]) * ring.tie.radius;
    let height = |arc: f32| height(&ring.tie, caught.layer, arc);
    let mut way = Ring::over_head(obstacle, middle, root, through, &height);
    let to_ring = way.len() - 1;
    let arc: f32 = way.windows(2).map(|p| p[0].distance(p[1])).sum();
    let most = lengths.iter().copied().fold(0.0, f32::max);
    if !lengths.iter().all(|l| *l > arc + CAUGHT) {
        return None;
    }
    way.extend(ring.beyond(caught.disc, most - arc + SPARE));

    let frames = frames(&way);
    let local = roots.map(|own| {
        let d = own - way[0];
        let [n, b, t] = frames[0];
        [d.dot(n), d.dot(b), d.dot(t)]
    });
    let widest = local.iter().map(|l| Vec3::from_array(*l).length()).fold(1e-4, f32::max);
    let in_ring = (WISP * ring.tie.radius / widest).min(1.0);
    let mut laid = GatheredHair { guides: Default::default(), ring_point: [0; 3] };
    for n in 0..3 {
        let target: Vec<Vec3> = (0..way.len())
            .map(|i| {
                // The wisp narrows on its way to the ring and opens slightly beyond it.
                let before = (i as f32 / to_ring as f32).min(1.0);
                let beyond = i.saturating_sub(to_ring) as f32 * STEP;
                let opens = in_ring * ring.spread(beyond);
                let wide = 1.0 + (opens - 1.0) * before.powf(0.7);
                let [normal, binormal, tangent] = frames[i];
                let [x, y, z] = local[n];
                way[i] + (normal * x + binormal * y + tangent * (z * (1.0 - before))) * wide
            })
            .collect();
        let (guide, passed) = along(&target, to_ring, &style.guides, guides[n], roots[n], obstacle)?;
        laid.guides[n] = guide;
        laid.ring_point[n] = passed;
    }
    Some(laid)
}

/// Normal, binormal and tangent at each point of a path, by parallel transport.
fn frames(way: &[Vec3]) -> Vec<[Vec3; 3]> {
    let mut out: Vec<[Vec3; 3]> = Vec::with_capacity(way.len());
    let mut tangent = (way[1] - way[0]).normalize_or(Vec3::Y);
    let mut normal = Vec3::from(reference_normal(tangent.into()));
    for i in 0..way.len() {
        let next = (way[(i + 1).min(way.len() - 1)] - way[i.saturating_sub(1)]).normalize_or(tangent);
        normal = transport(normal.into(), tangent.into(), next.into()).into();
        tangent = next;
        out.push([normal, tangent.cross(normal), tangent]);
    }
    out
}

/// Lays a chain with the links of `guide` along `target`, outside `obstacle`. Returns it with its first point beyond
/// point `ring` of the target, if it reaches that far.
fn along(
    target: &[Vec3],
    ring: usize,
    guides: &Guides,
    guide: usize,
    root: Vec3,
    obstacle: &dyn Obstacle,
) -> Option<(Vec<Vec3>, usize)> {
    let points = guides.points_per_guide;
    let mut out = vec![root];
    let mut at = 0.0_f32;
    let mut passed = None;
    let mut direction = (target[1] - root).normalize_or(Vec3::Y);
    for i in 1..points {
        let from = out[i - 1];
        let link = guides.point(guide, i).distance(guides.point(guide, i - 1));
        at = next_at(target, at, from, link, Reach { beyond: link / STEP + 2.0, step: 0.5 });
        direction = (sample(target, at) - from).normalize_or(direction);
        let margin = 0.0015_f32.min(0.3 * link * i as f32);
        let (p, turned) = outside(from, direction, link, margin, obstacle);
        direction = turned;
        // Nothing beyond the last point could be held.
        if at >= ring as f32 && passed.is_none() && i + 1 < points {
            passed = Some(i);
        }
        out.push(p);
    }
    Some((out, passed?))
}

/// The end of a link from `from` along `direction`, which is turned until that end is `margin` outside `obstacle`, and the direction
/// that the link has then.
pub(super) fn outside(
    from: Vec3,
    mut direction: Vec3,
    link: f32,
    margin: f32,
    obstacle: &dyn Obstacle,
) -> (Vec3, Vec3) {
    let mut p = from + direction * link;
    for _ in 0..8 {
        let (distance, n) = obstacle.distance(p);
        if distance >= margin || link <= 0.0 {
            break;
        }
        direction = (p + n * (1.3 * (margin - distance) + 1e-5) - from).normalize_or(direction);
        p = from + direction * link;
    }
    (p, direction)
}
