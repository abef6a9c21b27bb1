//! The points of fine strands on the CPU.
// Functions are inlined into the loops that `simd_versions!` compiles; calling those takes `unsafe`.
#![allow(clippy::inline_always, unsafe_code)]

use lovelock_base::memory::list_bytes;
use rayon::prelude::*;

use super::children::{FineStrands, MAX_POINTS};
use super::order::place;
use super::strand::FineStrand;
use crate::Strands;
use lovelock_base::simd::Width;
use lovelock_base::simd_versions;

/// Points of strands that are computed by one task.
const POINTS_PER_TASK: usize = 8192;

/// The stored strands of one frame, each with as many points as a fine strand.
///
/// Strands of another number of points are sampled at equal fractions of their points.
#[derive(Clone, Debug, Default)]
pub struct ParentPoints {
    points: usize,
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    /// Whether all stored strands have that number of points, so that they can be used as they are.
    even: bool,
    /// Whether the points of each stored strand are needed.
    needed: Vec<bool>,
}

impl ParentPoints {
    /// The memory of the points, bytes.
    pub fn bytes(&self) -> u64 {
        [&self.x, &self.y, &self.z].into_iter().map(list_bytes).sum()
    }

    /// Takes the strands of a frame that are parents of `children`.
    pub fn follow(&mut self, strands: &Strands, points: usize, children: &[FineStrand]) {
        self.points = points;
        self.even = strands.first_point.windows(2).all(|ends| (ends[1] - ends[0]) as usize == points);
        if self.even {
            return;
        }
        self.needed.clear();
        self.needed.resize(strands.count(), false);
        for &parent in children.iter().flat_map(|child| &child.parents) {
            if let Some(needed) = self.needed.get_mut(parent as usize) {
                *needed = true;
            }
        }
        let needed = &self.needed;
        for (to, from) in [(&mut self.x, &strands.x), (&mut self.y, &strands.y), (&mut self.z, &strands.z)] {
            to.resize(strands.count() * points, 0.0);
            let of_strands = to.par_chunks_mut(points).zip(strands.first_point.par_windows(2)).zip(needed);
            of_strands.filter(|(_, needed)| **needed).for_each(|((to, ends), _)| {
                let own = from.get(ends[0] as usize..ends[1] as usize).unwrap_or(&[]);
                let Some(links) = own.len().checked_sub(1).filter(|links| *links > 0) else {
                    to.fill(own.first().copied().unwrap_or(f32::NAN));
                    return;
                };
                for (k, to) in to.iter_mut().enumerate() {
                    let at = k as f32 / (points - 1) as f32 * links as f32;
                    let i = (at as usize).min(links - 1);
                    *to = own[i] + (own[i + 1] - own[i]) * (at - i as f32);
                }
            });
        }
    }

    fn axes<'a>(&'a self, strands: &'a Strands) -> [&'a [f32]; 3] {
        if self.even { [&strands.x, &strands.y, &strands.z] } else { [&self.x, &self.y, &self.z] }
    }
}

/// Writes the points `from` to `from + out.len()` of one axis of strands, of which each has `points`, moved by a random distance of up to
/// `reach` (metres), which is constant along a strand.
///
/// Shadows of a large light are soft: strands that look up the map of its middle at such places together take many samples of it.
pub fn moved_apart(
    positions: &[f32],
    (axis, from): (usize, usize),
    points: usize,
    reach: f32,
    out: &mut [f32],
) {
    out.par_chunks_mut(POINTS_PER_TASK).enumerate().for_each(|(piece, out)| {
        let first = from + piece * POINTS_PER_TASK;
        for (k, out) in out.iter_mut().enumerate() {
            let i = first + k;
            *out = positions[i] + reach * place((i / points) as u32)[axis];
        }
    });
}

/// Writes the points of the first `count` fine strands, of the stored `strands` of one frame, to `out`. The result has the same bytes for
/// any number of threads.
pub fn grow_fine(
    width: Width,
    fine: &FineStrands,
    count: usize,
    strands: &Strands,
    parents: &mut ParentPoints,
    out: &mut Strands,
) {
    let points = fine.points_per_strand.max(2);
    let count = count.min(fine.strands.len());
    if out.first_point.len() != count + 1 || out.first_point.get(1) != Some(&(points as u32)) {
        out.first_point = (0..=count).map(|i| (i * points) as u32).collect();
    }
    parents.follow(strands, points, &fine.strands[..count]);
    let from = parents.axes(strands);
    for axis in [&mut out.x, &mut out.y, &mut out.z] {
        axis.resize(count * points, 0.0);
    }
    let per_task = (POINTS_PER_TASK / points).max(1);
    fine.strands[..count]
        .par_chunks(per_task)
        .zip(out.x.par_chunks_mut(per_task * points))
        .zip(out.y.par_chunks_mut(per_task * points))
        .zip(out.z.par_chunks_mut(per_task * points))
        .for_each(|(((strands, x), y), z)| grow_run_simd(width, strands, points, &from, [x, y, z]));
}

simd_versions! {
    /// [`grow_run`] for the vectors of `width`.
    fn grow_run_simd(strands: &[FineStrand], points: usize, from: &[&[f32]; 3], out: [&mut [f32]; 3]) -> () {
        grow_run(strands, points, from, out)
    }
}

/// The points of consecutive strands.
#[inline(always)]
fn grow_run(strands: &[FineStrand], points: usize, from: &[&[f32]; 3], mut out: [&mut [f32]; 3]) {
    let links = points - 1;
    let mut share = [[0.0_f32; MAX_POINTS]; 2];
    let mut mixed = [0.0_f32; MAX_POINTS];
    for (s, strand) in strands.iter().enumerate() {
        let to = s * points..(s + 1) * points;
        let at = strand.parents.map(|parent| parent as usize * points);
        if strand.parents[0] == strand.parents[1] && strand.parents[0] == strand.parents[2] {
            for (out, from) in out.iter_mut().zip(from) {
                out[to.clone()].copy_from_slice(&from[at[0]..at[0] + points]);
            }
            continue;
        }
        for (share, control) in share.iter_mut().zip(&strand.weights) {
            let [w0, w1, w2, w3] = control.map(|w| f32::from(w) * (1.0 / 127.0));
            for (k, share) in share[..points].iter_mut().enumerate() {
                let t = k as f32 / links as f32;
                let u = 1.0 - t;
                *share = u * u * u * w0 + 3.0 * t * u * (u * w1 + t * w2) + t * t * t * w3;
            }
        }
        let length = strand.fraction(|| {
            let square = |from: &[f32], k: usize| (from[at[0] + k] - from[at[0] + k - 1]).powi(2);
            (1..points).map(|k| from.iter().map(|from| square(from, k)).sum::<f32>().sqrt()).sum()
        });
        for (out, from) in out.iter_mut().zip(from) {
            let [a, b, c] = at.map(|at| &from[at..at + points]);
            for k in 0..points {
                mixed[k] = a[k] + share[0][k] * (b[k] - a[k]) + share[1][k] * (c[k] - a[k]);
            }
            for (k, out) in out[to.clone()].iter_mut().enumerate() {
                let at = k as f32 * length;
                let i = (at as usize).min(links - 1);
                *out = mixed[i] + (mixed[i + 1] - mixed[i]) * (at - i as f32);
            }
        }
    }
}
