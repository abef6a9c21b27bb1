//! Which wisps and strands of two hairstyles become each other.

use std::collections::BTreeMap;

use glam::Vec3;
use lovelock_groom::Hairstyle;
use rayon::prelude::*;

/// Wisps match if their roots are nearer than this many times the usual distance of neighbours.
const REACH: f32 = 2.0;
/// Strands of a pair of wisps are matched by distance up to this many comparisons, and in their order beyond it.
const MAX_COMPARISONS: usize = 4_000_000;

/// A wisp of a morph.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct WispMatch {
    /// The wisps of the two hairstyles; one of them may be missing.
    pub of: [Option<u32>; 2],
    /// The strands of the wisp, in each hairstyle; one of them may be missing.
    pub strands: Vec<[Option<u32>; 2]>,
}

/// Matches two hairstyles by the places of their roots. Each wisp and each strand of either stands in the result: each strand once, a
/// wisp once or more.
pub(super) fn matched(styles: [&Hairstyle; 2]) -> Vec<WispMatch> {
    let roots = styles.map(wisp_roots);
    let reach = REACH * roots.each_ref().map(|roots| spacing(roots)).into_iter().fold(0.0, f32::max);
    let [mut pairs, back] = [(0, 1), (1, 0)].map(|(from, to)| {
        let nearest = nearest(&roots[from], &roots[to], reach);
        let pair = |(w, near): (usize, Option<usize>)| near.map(|near| (w as u32, near as u32));
        nearest.into_iter().enumerate().filter_map(pair).collect::<Vec<_>>()
    });
    pairs.extend(back.into_iter().map(|(b, a)| (a, b)));
    pairs.sort_unstable();
    pairs.dedup();

    let mut partners = [BTreeMap::<u32, Vec<usize>>::new(), BTreeMap::new()];
    for (at, &(a, b)) in pairs.iter().enumerate() {
        partners[0].entry(a).or_default().push(at);
        partners[1].entry(b).or_default().push(at);
    }
    let mut strands = vec![[Vec::new(), Vec::new()]; pairs.len()];
    let mut alone = Vec::new();
    for (side, style) in styles.into_iter().enumerate() {
        for (w, wisp) in style.wisps.iter().enumerate() {
            let all = wisp.first_strand..wisp.first_strand + wisp.strand_count;
            let Some(pairs_of_wisp) = partners[side].get(&(w as u32)) else {
                alone.push(alone_wisp(side, w as u32, all));
                continue;
            };
            let root_of_pair = |pair: usize| {
                let (a, b) = pairs[pair];
                roots[1 - side][[b, a][side] as usize]
            };
            for strand in all {
                let root = strand_root(style, strand);
                let distance = |pair: &usize| root_of_pair(*pair).distance_squared(root);
                let nearest =
                    pairs_of_wisp.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b)));
                if let Some(pair) = nearest {
                    strands[pair][side].push(strand);
                }
            }
        }
    }
    let both = |(&(a, b), of): (&(u32, u32), &[Vec<u32>; 2])| WispMatch {
        of: [Some(a), Some(b)],
        strands: strand_pairs(styles, of),
    };
    let mut out: Vec<WispMatch> = pairs.par_iter().zip(&strands).map(both).collect();
    out.extend(alone);
    out
}

/// A wisp that only one of the hairstyles has.
fn alone_wisp(side: usize, wisp: u32, strands: std::ops::Range<u32>) -> WispMatch {
    let on_side = |index| {
        let mut of = [None; 2];
        of[side] = Some(index);
        of
    };
    WispMatch { of: on_side(wisp), strands: strands.map(on_side).collect() }
}

/// Pairs the strands of two wisps: each of the shorter list with the nearest one that is free. The rest stay alone.
fn strand_pairs(styles: [&Hairstyle; 2], of: &[Vec<u32>; 2]) -> Vec<[Option<u32>; 2]> {
    let few = usize::from(of[0].len() > of[1].len());
    let many = 1 - few;
    let [few_roots, many_roots] =
        [few, many].map(|side| of[side].iter().map(|&s| strand_root(styles[side], s)).collect::<Vec<_>>());
    let by_distance = few_roots.len() * many_roots.len() <= MAX_COMPARISONS;
    let mut free: Vec<bool> = vec![true; many_roots.len()];
    let mut out = Vec::with_capacity(many_roots.len());
    for (i, root) in few_roots.iter().enumerate() {
        let distance = |j: &usize| many_roots[*j].distance_squared(*root);
        let nearest = (0..free.len()).filter(|&j| free[j]);
        let nearest = nearest.min_by(|a, b| distance(a).total_cmp(&distance(b)));
        // The list of the side with fewer strands is never longer, so one is always free.
        let j = if by_distance { nearest.unwrap_or(i) } else { i };
        free[j] = false;
        let mut pair = [None; 2];
        (pair[few], pair[many]) = (Some(of[few][i]), Some(of[many][j]));
        out.push(pair);
    }
    for (j, _) in free.into_iter().enumerate().filter(|(_, free)| *free) {
        let mut alone = [None; 2];
        alone[many] = Some(of[many][j]);
        out.push(alone);
    }
    out
}

/// The mean root of the guides of each wisp, head space.
fn wisp_roots(style: &Hairstyle) -> Vec<Vec3> {
    let root =
        |guides: [u32; 3]| guides.map(|g| style.guides.point(g as usize, 0)).iter().sum::<Vec3>() / 3.0;
    style.wisps.iter().map(|wisp| root(wisp.guides)).collect()
}

/// The root of a strand without its offset, head space.
fn strand_root(style: &Hairstyle, strand: u32) -> Vec3 {
    let set = &style.strands;
    let guides = style.wisps[set.wisp[strand as usize] as usize].guides;
    let weights = set.weights[strand as usize];
    guides.iter().zip(weights).map(|(&g, w)| style.guides.point(g as usize, 0) * w).sum()
}

/// The nearest of `to` for each of `from`, if it is within `reach`.
fn nearest(from: &[Vec3], to: &[Vec3], reach: f32) -> Vec<Option<usize>> {
    let nearest = |p: &Vec3| {
        let by_distance =
            |a: &usize, b: &usize| to[*a].distance_squared(*p).total_cmp(&to[*b].distance_squared(*p));
        (0..to.len()).min_by(by_distance).filter(|&j| to[j].distance(*p) <= reach)
    };
    from.par_iter().map(nearest).collect()
}

/// The median distance of places from their nearest neighbour; 0 for fewer than two.
fn spacing(places: &[Vec3]) -> f32 {
    let of = |(i, p): (usize, &Vec3)| {
        let others = places.iter().enumerate().filter(|(j, _)| *j != i);
        others.map(|(_, other)| other.distance(*p)).fold(f32::MAX, f32::min)
    };
    let mut nearest: Vec<f32> = places.par_iter().enumerate().map(of).collect();
    nearest.sort_unstable_by(f32::total_cmp);
    nearest.get(nearest.len() / 2).copied().filter(|d| *d < f32::MAX).unwrap_or(0.0)
}
