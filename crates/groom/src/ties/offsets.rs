//! The offsets of a tied wisp's strands: flattened before the ring.

use glam::{Quat, Vec3};

use super::lay::{self, GatheredHair};
use super::{HairTie, TieKind};
use crate::{Hairstyle, Obstacle, WispCurve};

/// Distance over which a strand's root blends into the curve of its guides, metres.
const ROOT_JOIN: f32 = 0.02;
/// Fraction of the offsets that remains in the ring, and before it at a tightness of 1 and of 0.
const RING: f32 = 0.12;
const TAUT: [f32; 2] = [0.2, 0.5];
/// Distance beyond the ring after which a tail has its full curls and waves again, metres.
const OPENS: f32 = 0.08;
/// Fraction of its curls and waves that a bun keeps.
const WOUND: f32 = 0.3;
/// Smallest distance of strands from the skin, metres.
const SKIN: f32 = 0.001;

/// The offsets of all points of a wisp's strands, in its new frame.
pub(super) fn of_wisp(
    before: &Hairstyle,
    after: &Hairstyle,
    wisp: usize,
    laid: &GatheredHair,
    tie: &HairTie,
    obstacle: &dyn Obstacle,
) -> Vec<Vec3> {
    let (set, wisp) = (&before.strands, &before.wisps[wisp]);
    let old = WispCurve::at_rest(&before.guides, wisp);
    let new = WispCurve::at_rest(&after.guides, wisp);
    let link = (laid.guides[0][1] - laid.guides[0][0]).length();
    let ring = laid.ring_point.iter().sum::<usize>() as f32 / 3.0 - 0.5;
    let taut = TAUT[1] + (TAUT[0] - TAUT[1]) * tie.tightness;
    let mut out = Vec::new();
    for strand in wisp.first_strand as usize..(wisp.first_strand + wisp.strand_count) as usize {
        let range = set.first_point[strand] as usize..set.first_point[strand + 1] as usize;
        let weights = set.weights[strand];
        let offset =
            |i: usize| Vec3::new(set.offset_normal[i], set.offset_binormal[i], set.offset_tangent[i]);
        let first = range.start;
        let root = old.point(weights, set.guide_param[first], offset(first));
        let from_guides = root - new.blend(weights, set.guide_param[first]);
        for i in range {
            let u = set.guide_param[i];
            let arc = u * link;
            let join = (1.0 - arc / ROOT_JOIN).max(0.0).powi(2);
            let mut point = new.blend(weights, u)
                + from_guides * join
                + new.frame(u) * (offset(i) * share(tie, taut, u, ring, link));
            // Beyond the ring, hair hangs free of the head; before it, hair lies on the skin.
            if u < ring + 1.0 && i > first {
                for _ in 0..2 {
                    let (distance, n) = obstacle.distance(point);
                    point += n * (SKIN.min(0.3 * arc) - distance).max(0.0);
                }
            }
            out.push(new.offset_to(weights, u, point));
        }
    }
    out
}

/// The offsets of all points of the strands of a wisp that is left out, in its new frame: each strand keeps its place beside the
/// guides, outside the body.
pub(super) fn of_left_out(
    before: &Hairstyle,
    after: &Hairstyle,
    wisp: usize,
    obstacle: &dyn Obstacle,
) -> Vec<Vec3> {
    let (set, wisp) = (&before.strands, &before.wisps[wisp]);
    let old = WispCurve::at_rest(&before.guides, wisp);
    let new = WispCurve::at_rest(&after.guides, wisp);
    let links = (before.guides.points_per_guide - 1) as f32;
    let link = lay::length(&before.guides, wisp.guides[0] as usize) / links;
    let mut out = Vec::new();
    for strand in wisp.first_strand as usize..(wisp.first_strand + wisp.strand_count) as usize {
        let range = set.first_point[strand] as usize..set.first_point[strand + 1] as usize;
        let (weights, first) = (set.weights[strand], range.start);
        let offset =
            |i: usize| Vec3::new(set.offset_normal[i], set.offset_binormal[i], set.offset_tangent[i]);
        let turned = |i: usize| {
            let u = set.guide_param[i];
            let (from, to) = (old.frame(u), new.frame(u));
            new.blend(weights, u) + Quat::from_rotation_arc(from.z_axis, to.z_axis) * (from * offset(i))
        };
        // Roots stay where they are.
        let from_root = old.point(weights, set.guide_param[first], offset(first)) - turned(first);
        for i in range {
            let u = set.guide_param[i];
            let arc = u * link;
            let mut point = turned(i) + from_root * (1.0 - arc / ROOT_JOIN).max(0.0).powi(2);
            if i > first {
                for _ in 0..2 {
                    let (distance, n) = obstacle.distance(point);
                    point += n * (SKIN.min(0.3 * arc) - distance).max(0.0);
                }
            }
            out.push(new.offset_to(weights, u, point));
        }
    }
    out
}

/// The fraction of its offset that a point `u` links from the root keeps, with the ring at `ring`.
fn share(tie: &HairTie, taut: f32, u: f32, ring: f32, link: f32) -> f32 {
    if u < ring {
        // From zero at the root, where the root's own offset applies, to the ring.
        let leaves = (u * link / ROOT_JOIN).min(1.0);
        let nears = ((ring - u) * link / 0.04).min(1.0);
        leaves * (RING + (taut - RING) * nears)
    } else {
        let opens = ((u - ring) * link / OPENS).min(1.0);
        let open = match tie.kind {
            TieKind::Ponytail => 1.0,
            TieKind::Bun => WOUND,
        };
        RING + (open - RING) * opens * opens * (3.0 - 2.0 * opens)
    }
}
