//! Chooses three strands of each wisp as its guides, and spaces their points equally.

use glam::Vec3;
use rayon::prelude::*;

use super::{PlacedGroom, length};
use crate::Guides;

/// Fraction of a wisp's strands, those closest to its mean, from which guides are chosen.
const ORDINARY: f32 = 0.7;
/// Distance between guides that have no strands of their own, metres.
const APART: f32 = 0.0015;
/// The links of a guide differ by no more than this fraction of their mean, if [`MAX_ROUNDS`] rounds are enough.
const UNEVEN: f32 = 1e-4;
const MAX_ROUNDS: usize = 64;

/// Three guides per wisp, in the order of the wisps, and the strand that each was made of.
pub(super) fn choose(groom: &PlacedGroom, wisps: &[Vec<u32>], points_per_guide: usize) -> (Guides, Vec<u32>) {
    let chosen: Vec<([Vec<Vec3>; 3], [u32; 3])> =
        wisps.par_iter().map(|members| guides_of(groom, members, points_per_guide)).collect();
    let mut guides = Guides { points_per_guide, ..Guides::default() };
    for guide in chosen.iter().flat_map(|(guides, _)| guides) {
        guides.push(guide);
    }
    (guides, chosen.into_iter().flat_map(|(_, strands)| strands).collect())
}

fn guides_of(groom: &PlacedGroom, members: &[u32], points: usize) -> ([Vec<Vec3>; 3], [u32; 3]) {
    let strands: Vec<&[Vec3]> = members.iter().map(|&member| groom.strand(member as usize)).collect();
    let chosen = triangle(&ordinary(&strands));
    let member = |chosen: &[Vec3]| strands.iter().position(|strand| std::ptr::eq(*strand, chosen));
    let made_of = chosen.map(|chosen| member(chosen).map_or(members[0], |at| members[at]));
    let mut guides = chosen.map(|strand| equally_spaced(strand, points));
    // Guides in one place span no triangle, so they are moved apart, as if the wisp had a small width.
    let along = (guides[0][points - 1] - guides[0][0]).normalize_or(Vec3::Y);
    let (side, other) = along.any_orthonormal_pair();
    for (later, direction) in [(1, side), (2, other)] {
        let twin = guides[..later].iter().any(|guide| guide[0].distance(guides[later][0]) < 0.1 * APART);
        if twin {
            guides[later].iter_mut().for_each(|point| *point += APART * direction);
        }
    }
    (guides, made_of)
}

/// The strands closest to the wisp's mean by root, middle and tip.
fn ordinary<'a>(strands: &[&'a [Vec3]]) -> Vec<&'a [Vec3]> {
    let places = |strand: &[Vec3]| [strand[0], strand[strand.len() / 2], strand[strand.len() - 1]];
    let mut mean = [Vec3::ZERO; 3];
    for strand in strands {
        for (mean, place) in mean.iter_mut().zip(places(strand)) {
            *mean += place / strands.len() as f32;
        }
    }
    let mut by_distance: Vec<(f32, &[Vec3])> = strands
        .iter()
        .map(|&strand| {
            (
                places(strand).iter().zip(&mean).map(|(place, mean)| place.distance_squared(*mean)).sum(),
                strand,
            )
        })
        .collect();
    by_distance.sort_by(|a, b| a.0.total_cmp(&b.0));
    let keep = ((ORDINARY * strands.len() as f32).ceil() as usize).max(3).min(strands.len());
    by_distance.into_iter().take(keep).map(|(_, strand)| strand).collect()
}

/// Three strands that span a wide triangle: the one farthest from the middle, the one farthest from that, and the one
/// that makes the largest triangle with both. One or two strands are repeated.
fn triangle<'a>(strands: &[&'a [Vec3]]) -> [&'a [Vec3]; 3] {
    // The midpoint counts like the root: wisps that start in one spot on the scalp may still fan out.
    let place = |strand: &[Vec3]| [strand[0], strand[strand.len() / 2]];
    let apart = |a: &[Vec3], b: &[Vec3]| {
        place(a).iter().zip(place(b)).map(|(a, b)| a.distance_squared(b)).sum::<f32>()
    };
    let area = |a: &[Vec3], b: &[Vec3], c: &[Vec3]| {
        let (a, b, c) = (place(a), place(b), place(c));
        (0..2).map(|i| (b[i] - a[i]).cross(c[i] - a[i]).length()).sum::<f32>()
    };
    let most = |score: &dyn Fn(&[Vec3]) -> f32| {
        let mut best = (f32::NEG_INFINITY, strands[0]);
        for &strand in strands {
            let score = score(strand);
            if score > best.0 {
                best = (score, strand);
            }
        }
        best.1
    };
    // The strands are sorted: the first is nearest to the mean.
    let first = most(&|strand| apart(strand, strands[0]));
    let second = most(&|strand| apart(strand, first));
    let third = most(&|strand| area(first, second, strand));
    [first, second, third]
}

/// `count` points along a polyline, including its ends, at equal distances from each other.
///
/// Equal lengths along the line are not enough: where it bends, the chords, which become the simulator's links, are
/// shorter. Repeated resampling rounds the bends until the chords are equal. The strand keeps in its offsets what the
/// guide loses of its shape.
fn equally_spaced(strand: &[Vec3], count: usize) -> Vec<Vec3> {
    let mut points = spaced_along(strand, count);
    for _ in 0..MAX_ROUNDS {
        let mean = length(&points) / (count - 1) as f32;
        if points.array_windows().all(|[a, b]| (a.distance(*b) - mean).abs() <= UNEVEN * mean) {
            break;
        }
        points = spaced_along(&points, count);
    }
    points
}

/// `count` points at equal lengths along a polyline, including its ends.
pub(super) fn spaced_along(line: &[Vec3], count: usize) -> Vec<Vec3> {
    let total = length(line);
    let (mut link, mut before) = (0, 0.0);
    let mut points: Vec<Vec3> = (0..count)
        .map(|i| {
            let wanted = total * i as f32 / (count - 1) as f32;
            let mut step = line[link].distance(line[link + 1]);
            while link + 2 < line.len() && before + step < wanted {
                before += step;
                link += 1;
                step = line[link].distance(line[link + 1]);
            }
            let along = if step > 0.0 { ((wanted - before) / step).clamp(0.0, 1.0) } else { 0.0 };
            line[link].lerp(line[link + 1], along)
        })
        .collect();
    points[count - 1] = line[line.len() - 1];
    points
}
