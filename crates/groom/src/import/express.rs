//! Expresses every strand as a blend of its wisp's guides plus its own offsets in the wisp's frame.

use glam::Vec3;
use rayon::prelude::*;

use super::{PlacedGroom, length};
use crate::{Guides, StrandSet, Wisp, WispCurve};

/// Limits of the weights, so that diverging guides do not throw a strand far from both.
const WEIGHT: [f32; 2] = [-0.5, 1.5];
/// Strength of the pull of the weights toward one third, relative to the distance between guides.
const EVEN: f32 = 0.02;
/// Number of points per strand to which its weights are fitted.
const FITTED: usize = 24;

/// The strands of `groom` in the order `order`, sorted by wisp; without taper and shade.
pub(super) fn express(groom: &PlacedGroom, order: &[u32], wisps: &[Wisp], guides: &Guides) -> StrandSet {
    let parts: Vec<StrandSet> = wisps
        .par_iter()
        .enumerate()
        .map(|(index, wisp)| {
            let members = &order[wisp.first_strand as usize..][..wisp.strand_count as usize];
            of_wisp(groom, members, index as u32, wisp, guides)
        })
        .collect();
    let (strands, points) = (order.len(), groom.points.len());
    let mut set = StrandSet {
        wisp: Vec::with_capacity(strands),
        weights: Vec::with_capacity(strands),
        first_point: Vec::with_capacity(strands + 1),
        guide_param: Vec::with_capacity(points),
        offset_normal: Vec::with_capacity(points),
        offset_binormal: Vec::with_capacity(points),
        offset_tangent: Vec::with_capacity(points),
        ..StrandSet::default()
    };
    let mut end = 0;
    set.first_point.push(0);
    for &strand in order {
        end += groom.strand(strand as usize).len() as u32;
        set.first_point.push(end);
    }
    for part in parts {
        set.wisp.extend(part.wisp);
        set.weights.extend(part.weights);
        set.guide_param.extend(part.guide_param);
        set.offset_normal.extend(part.offset_normal);
        set.offset_binormal.extend(part.offset_binormal);
        set.offset_tangent.extend(part.offset_tangent);
    }
    set
}

fn of_wisp(groom: &PlacedGroom, members: &[u32], index: u32, wisp: &Wisp, guides: &Guides) -> StrandSet {
    let curve = WispCurve::at_rest(guides, wisp);
    let links = (guides.points_per_guide - 1) as f32;
    let guide_length = wisp
        .guides
        .iter()
        .map(|&guide| {
            let points: Vec<Vec3> =
                (0..guides.points_per_guide).map(|point| guides.point(guide as usize, point)).collect();
            length(&points)
        })
        .sum::<f32>()
        / 3.0;
    let mut set = StrandSet::default();
    let mut params = Vec::new();
    for &member in members {
        let strand = groom.strand(member as usize);
        // A strand shorter than the guides follows their first part, link for link; a longer one is distributed over
        // all of them. In both cases each point stays beside the part of the wisp that it moves with.
        let links_per_metre = links / length(strand).max(guide_length);
        params.clear();
        let mut run = 0.0;
        params.push(0.0);
        for [a, b] in strand.array_windows() {
            run += a.distance(*b);
            params.push((run * links_per_metre).min(links));
        }
        let weights = weights(&curve, strand, &params);
        set.wisp.push(index);
        set.weights.push(weights);
        for (&point, &u) in strand.iter().zip(&params) {
            let offset = curve.offset_to(weights, u, point);
            set.guide_param.push(u);
            set.offset_normal.push(offset.x);
            set.offset_binormal.push(offset.y);
            set.offset_tangent.push(offset.z);
        }
    }
    set
}

/// The weights with sum 1 that bring the blended guides closest to the strand by least squares, pulled toward one third
/// each where the guides do not determine them.
fn weights(curve: &WispCurve, strand: &[Vec3], params: &[f32]) -> [f32; 3] {
    // With w = 1/3 + d and d0 = -d1 - d2, the blend is the mean plus d1 (g1 - g0) + d2 (g2 - g0).
    let (mut aa, mut ab, mut bb, mut ar, mut br) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for i in (0..strand.len()).step_by(strand.len().div_ceil(FITTED)) {
        let [g0, g1, g2] =
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|only| curve.blend(only, params[i]));
        let (a, b, rest) = (g1 - g0, g2 - g0, strand[i] - (g0 + g1 + g2) / 3.0);
        aa += a.dot(a);
        ab += a.dot(b);
        bb += b.dot(b);
        ar += a.dot(rest);
        br += b.dot(rest);
    }
    let even = EVEN * (aa + bb) + f32::MIN_POSITIVE;
    let (aa, bb) = (aa + even, bb + even);
    let determinant = aa * bb - ab * ab;
    let (d1, d2) = ((ar * bb - br * ab) / determinant, (br * aa - ar * ab) / determinant);
    let away = [-d1 - d2, d1, d2];
    // Shorten the step from equal weights until all are in range; the sum stays 1.
    let third = 1.0 / 3.0;
    let step = away.iter().fold(1.0_f32, |step, &d| {
        let room = if d > 0.0 { WEIGHT[1] - third } else { third - WEIGHT[0] };
        if d.abs() * step > room { room / d.abs() } else { step }
    });
    if away.iter().all(|d| d.is_finite()) { away.map(|d| third + step * d) } else { [third; 3] }
}
