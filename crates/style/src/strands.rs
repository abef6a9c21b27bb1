//! Changing drawn strands: their offsets from the guides and the number of their points.

use glam::Vec3;
use lovelock_groom::{Hairstyle, MAX_POINTS, StrandSet};
use rayon::prelude::*;

use crate::Scope;

/// A point of a strand that an operation moves.
#[derive(Clone, Copy, Debug)]
pub struct StrandPoint {
    /// Index of the strand.
    pub strand: usize,
    /// Index of its wisp.
    pub wisp: usize,
    /// [`Scope::at`] the root of the strand.
    pub strength: f32,
    /// The place along the strand: 0 is the root, 1 the tip.
    pub place: f32,
    /// Distance from the root along the guides, metres.
    pub metres: f32,
    /// Offset from the guides along the frame's normal, binormal and tangent, metres.
    pub offset: Vec3,
}

/// Changes the offsets of every point of the strands on which the layer acts. `change` returns the new offset.
pub fn displace(style: &mut Hairstyle, scope: &Scope<'_>, change: impl Fn(&StrandPoint) -> Vec3 + Sync) {
    let strengths = scope.strands(style);
    let links = links_of_strands(style);
    let set = &style.strands;
    let moved: Vec<Option<Vec<Vec3>>> = (0..set.count())
        .into_par_iter()
        .map(|strand| {
            if strengths[strand] == 0.0 {
                return None;
            }
            let range = set.first_point[strand] as usize..set.first_point[strand + 1] as usize;
            let end = set.guide_param[range.end - 1].max(1e-6);
            let point = |i: usize| StrandPoint {
                strand,
                wisp: set.wisp[strand] as usize,
                strength: strengths[strand],
                place: set.guide_param[i] / end,
                metres: set.guide_param[i] * links[strand],
                offset: Vec3::new(set.offset_normal[i], set.offset_binormal[i], set.offset_tangent[i]),
            };
            let new = |i: usize| {
                let old = point(i);
                let offset = change(&old);
                if offset.is_finite() { offset } else { old.offset }
            };
            Some(range.map(new).collect())
        })
        .collect();
    let set = &mut style.strands;
    for (strand, offsets) in moved.into_iter().enumerate() {
        let first = set.first_point[strand] as usize;
        for (k, offset) in offsets.into_iter().flatten().enumerate() {
            set.offset_normal[first + k] = offset.x;
            set.offset_binormal[first + k] = offset.y;
            set.offset_tangent[first + k] = offset.z;
        }
    }
}

/// Mean length of the links that each strand follows, metres.
pub fn links_of_strands(style: &Hairstyle) -> Vec<f32> {
    let links: Vec<f32> = (0..style.guides.count())
        .map(|guide| style.guides.point(guide, 0).distance(style.guides.point(guide, 1)))
        .collect();
    let set = &style.strands;
    let of = |(&wisp, weights): (&u32, &[f32; 3])| -> f32 {
        let guides = style.wisps[wisp as usize].guides;
        guides.iter().zip(weights).map(|(&g, w)| links[g as usize] * w).sum::<f32>().max(0.0)
    };
    set.wisp.iter().zip(&set.weights).map(of).collect()
}

/// Adds points to the strands on which the layer acts until no segment is longer than `segment` metres, within the most points that a
/// hairstyle may have.
pub fn refine(style: &mut Hairstyle, scope: &Scope<'_>, segment: f32) {
    let strengths = scope.strands(style);
    refine_where(style, |strand| (strengths[strand] != 0.0).then_some((0.0, segment)));
}

/// Adds points to strands until no segment is longer than `segment` metres that ends at or beyond a place along the guides, in links;
/// `of` returns both for a strand, or none where it stays as it is. Stays within the most points that a hairstyle may have.
pub fn refine_where(style: &mut Hairstyle, of: impl Fn(usize) -> Option<(f32, f32)>) {
    let links = links_of_strands(style);
    let set = &style.strands;
    let range = |strand: usize| set.first_point[strand] as usize..set.first_point[strand + 1] as usize;
    // From where on segments are divided, and into how many parts.
    let parts = |strand: usize| -> (f32, u32) {
        let Some((from, segment)) = of(strand) else { return (0.0, 1) };
        let params = &set.guide_param[range(strand)];
        let metres = (params[params.len() - 1] - params[0]) * links[strand];
        let now = (params.len() - 1) as f32;
        (from, (metres / (now * segment)).ceil().clamp(1.0, 16.0) as u32)
    };
    let mut parts: Vec<(f32, u32)> = (0..set.count()).map(parts).collect();
    let divided_segments = |strand: usize, from: f32| -> u64 {
        let params = &set.guide_param[range(strand)];
        params[1..].iter().filter(|u| **u >= from).count() as u64
    };
    let reach: Vec<u64> =
        parts.iter().enumerate().map(|(strand, (from, _))| divided_segments(strand, *from)).collect();
    let points = |parts: &[(f32, u32)]| -> u64 {
        let added = |(reach, (_, n)): (&u64, &(f32, u32))| reach * u64::from(n - 1);
        set.points() as u64 + reach.iter().zip(parts).map(added).sum::<u64>()
    };
    while points(&parts) > u64::from(MAX_POINTS) && parts.iter().any(|(_, n)| *n > 1) {
        for (_, n) in &mut parts {
            *n = (*n - 1).max(1);
        }
    }
    if parts.iter().all(|(_, n)| *n == 1) {
        return;
    }
    style.strands = divided(set, &parts);
}

/// The strands with each segment that ends at or beyond a place divided into equal parts; `parts` has both for each strand.
fn divided(set: &StrandSet, parts: &[(f32, u32)]) -> StrandSet {
    let mut out = StrandSet { first_point: vec![0], ..StrandSet::default() };
    out.wisp.clone_from(&set.wisp);
    out.weights.clone_from(&set.weights);
    out.shade.clone_from(&set.shade);
    out.colours.clone_from(&set.colours);
    let range = |strand: usize| set.first_point[strand] as usize..set.first_point[strand + 1] as usize;
    let mut total = 0;
    for (strand, &(from, n)) in parts.iter().enumerate() {
        let params = &set.guide_param[range(strand)];
        let divided = params[1..].iter().filter(|u| **u >= from).count() as u32;
        total += params.len() as u32 + divided * (n - 1);
        out.first_point.push(total);
    }
    let spread = |values: &[f32]| -> Vec<f32> {
        let mut new = vec![0.0; total as usize];
        slices(&mut new, &out.first_point).into_par_iter().enumerate().for_each(|(strand, new)| {
            let (from, n) = parts[strand];
            let (values, params) = (&values[range(strand)], &set.guide_param[range(strand)]);
            let mut at = 0;
            for (pair, end) in values.windows(2).zip(&params[1..]) {
                let n = if *end < from { 1 } else { n };
                for k in 0..n {
                    let t = k as f32 / n as f32;
                    new[at] = if k == 0 { pair[0] } else { pair[0] + (pair[1] - pair[0]) * t };
                    at += 1;
                }
            }
            new[at] = values[values.len() - 1];
        });
        new
    };
    out.guide_param = spread(&set.guide_param);
    out.offset_normal = spread(&set.offset_normal);
    out.offset_binormal = spread(&set.offset_binormal);
    out.offset_tangent = spread(&set.offset_tangent);
    out.taper = spread(&set.taper);
    out
}

/// The parts of a list that begin at `firsts`; the last of those is its length.
pub fn slices<'a>(values: &'a mut [f32], firsts: &[u32]) -> Vec<&'a mut [f32]> {
    let mut rest = values;
    let mut out = Vec::with_capacity(firsts.len() - 1);
    for pair in firsts.windows(2) {
        let (part, after) = rest.split_at_mut((pair[1] - pair[0]) as usize);
        out.push(part);
        rest = after;
    }
    out
}

/// Multiplies the width of the strands on which the layer acts. `factor` returns the factor at a place along the strand.
pub fn widen(style: &mut Hairstyle, scope: &Scope<'_>, factor: impl Fn(f32) -> f32) {
    let strengths = scope.strands(style);
    let set = &mut style.strands;
    for (strand, strength) in strengths.into_iter().enumerate() {
        let range = set.first_point[strand] as usize..set.first_point[strand + 1] as usize;
        let end = set.guide_param[range.end - 1].max(1e-6);
        for i in range {
            let place = set.guide_param[i] / end;
            let change = (factor(place) - 1.0) * strength * scope.along(place);
            set.taper[i] *= (1.0 + change).max(0.0);
        }
    }
}
