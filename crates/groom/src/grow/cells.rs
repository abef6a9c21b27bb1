//! Divides the scalp among the wisps: centroidal Voronoi cells, each filled with roots.

use glam::{Vec3, Vec4};
use rayon::prelude::*;

use super::comb::Comb;
use crate::{GroomSettings, ScalpIndex, ScalpPoint};
use lovelock_base::random::SplitMix64;

/// Samples of the scalp per cell while the cells relax.
const SAMPLES_PER_CELL: usize = 32;
/// Iterations of Lloyd's relaxation.
const ROUNDS: usize = 8;
/// Distance that the parting adds between its sides while the cells relax, so that no cell crosses it; metres.
const PART_GAP: f32 = 0.03;

/// The part of the scalp that one wisp covers.
pub(super) struct Cell {
    /// Its centre.
    pub centre: ScalpPoint,
    /// Root mean square distance of its roots from the centre, metres.
    pub spread: f32,
    /// The side of the parting: 1 on the wearer's left, -1 on the right.
    pub side: f32,
    /// 1 for a wisp of the fringe, else 0.
    pub fringe: f32,
    /// The roots of its strands.
    pub roots: Vec<ScalpPoint>,
    /// A number for its own random streams.
    pub stream: u64,
}

/// Divides the scalp into the number of cells and roots of the settings. Empty if the scalp is too small for any sample
/// to hit it.
pub(super) fn divide(settings: &GroomSettings, index: &ScalpIndex<'_>, comb: &Comb) -> Vec<Cell> {
    let wisps = settings.wisps as usize;
    let each = settings.strands_per_wisp as usize;
    let per_cell = SAMPLES_PER_CELL.max(each * if each <= 64 { 3 } else { 2 });
    let samples = index.scalp().sample(wisps * per_cell, settings.hairline, settings.seed);
    if samples.is_empty() {
        return Vec::new();
    }
    let features: Vec<Vec4> = samples
        .par_iter()
        .map(|s| s.position.extend(0.5 * PART_GAP * comb.divided_side(s.position)))
        .collect();
    // Samples are independent, so the first ones are as good as any.
    let few = &features[..features.len().min(wisps * SAMPLES_PER_CELL)];
    let mut centres = spaced(few, wisps);
    for _ in 0..ROUNDS {
        let owners: Vec<u32> = few.par_iter().map(|f| nearest(&centres, *f)).collect();
        let mut sums = vec![(Vec4::ZERO, 0.0_f32); centres.len()];
        for (f, &owner) in few.iter().zip(&owners) {
            sums[owner as usize].0 += *f;
            sums[owner as usize].1 += 1.0;
        }
        for (centre, (sum, count)) in centres.iter_mut().zip(&sums) {
            if *count > 0.0 {
                *centre = *sum / *count;
            }
        }
    }
    let owners: Vec<u32> = features.par_iter().map(|f| nearest(&centres, *f)).collect();
    let mut members = vec![Vec::new(); centres.len()];
    for (sample, &owner) in samples.iter().zip(&owners) {
        members[owner as usize].push(*sample);
    }
    (0..centres.len())
        .into_par_iter()
        .map(|w| cell(settings, index, comb, centres[w].truncate(), &members[w], w as u64))
        .collect()
}

/// One cell, from the samples inside it.
fn cell(
    settings: &GroomSettings,
    index: &ScalpIndex<'_>,
    comb: &Comb,
    middle: Vec3,
    members: &[ScalpPoint],
    stream: u64,
) -> Cell {
    let mut rng = SplitMix64::of_stream(settings.seed, 0xce11_0000 + stream);
    let on_scalp = index.closest(middle).expect("a scalp with samples has triangles");
    let own = [on_scalp];
    let members = if members.is_empty() { &own[..] } else { members };
    let centre = if on_scalp.mask >= settings.hairline { on_scalp } else { members[0] };
    let roots = choose(settings, index, members, settings.strands_per_wisp as usize, &mut rng);
    let squares: f32 = members.iter().map(|m| m.position.distance_squared(centre.position)).sum();
    let p = (centre.position - comb.centre) / comb.half;
    let before = p.z > 0.45 && p.x.abs() < 0.6 && p.y > 0.2;
    Cell {
        centre,
        spread: (squares / members.len() as f32).sqrt().max(5e-4),
        side: comb.side(centre.position),
        fringe: f32::from(before && rng.unit() < settings.fringe),
        roots,
        stream,
    }
}

/// Chooses `count` samples, each as far as possible from the earlier ones (farthest point sampling), which leaves
/// neither clusters nor rows. If there are too few samples, more are interpolated between them.
fn choose(
    settings: &GroomSettings,
    index: &ScalpIndex<'_>,
    members: &[ScalpPoint],
    count: usize,
    rng: &mut SplitMix64,
) -> Vec<ScalpPoint> {
    let mut chosen = Vec::with_capacity(count);
    if count > 300 {
        chosen.extend_from_slice(&members[..count.min(members.len())]);
    } else {
        let mut gaps = vec![f32::INFINITY; members.len()];
        let mut next = 0;
        while chosen.len() < count.min(members.len()) {
            let pick = members[next];
            chosen.push(pick);
            let mut widest = -1.0;
            for (m, (member, gap)) in members.iter().zip(&mut gaps).enumerate() {
                *gap = gap.min(member.position.distance_squared(pick.position));
                if *gap > widest {
                    (widest, next) = (*gap, m);
                }
            }
        }
    }
    while chosen.len() < count {
        let mut pick = || members[(rng.unit() * members.len() as f32) as usize % members.len()];
        let (a, b) = (pick(), pick());
        let between = index.closest(a.position.lerp(b.position, rng.unit())).unwrap_or(a);
        chosen.push(if between.mask >= settings.hairline { between } else { a });
    }
    chosen
}

/// Chooses `count` features by farthest point sampling.
fn spaced(features: &[Vec4], count: usize) -> Vec<Vec4> {
    let mut gaps = vec![f32::INFINITY; features.len()];
    let mut chosen = Vec::with_capacity(count);
    let mut next = 0;
    for _ in 0..count {
        let pick = features[next];
        chosen.push(pick);
        let mut widest = -1.0;
        for (i, (f, gap)) in features.iter().zip(&mut gaps).enumerate() {
            *gap = gap.min(f.distance_squared(pick));
            if *gap > widest {
                (widest, next) = (*gap, i);
            }
        }
    }
    chosen
}

fn nearest(centres: &[Vec4], f: Vec4) -> u32 {
    let mut best = (f32::INFINITY, 0);
    for (w, centre) in centres.iter().enumerate() {
        let d2 = centre.distance_squared(f);
        if d2 < best.0 {
            best = (d2, w as u32);
        }
    }
    best.1
}
