//! Puts strands into bricks: first which bricks hold hair, then density.

use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use glam::Vec3;
use rayon::prelude::*;

use super::Lattice;
use super::grid::{BRICK_WORDS, DEPTH_ONE, MOST, places};
use crate::ShadowInput;
use crate::cpu::safe_extinction;

/// Strands per parallel task.
const STRANDS_PER_TASK: usize = 64;

/// What a piece of strand as long as a cell adds, in fixed point: `s w ℓ π/4 / a²` with ℓ and a the edge of a cell, because the mean of
/// the sine over all directions is π/4.
pub(super) fn depth_per_cell(extinction_scale: f32, strand_width: f32, cell_size: f32) -> f32 {
    let depth = safe_extinction(extinction_scale) * strand_width * std::f32::consts::FRAC_PI_4 / cell_size;
    if depth > 0.0 { (depth * DEPTH_ONE).min(1e30) } else { 0.0 }
}

/// Calls `add` for the cell of every sample, with its depth in fixed point, of the strands of a task.
fn samples(
    input: &ShadowInput,
    lattice: &Lattice,
    each: f32,
    task: usize,
    mut add: impl FnMut(glam::UVec3, u32),
) {
    let strands = input.strands;
    let first = task * STRANDS_PER_TASK;
    for strand in first..(first + STRANDS_PER_TASK).min(strands.count()) {
        let points = strands.first_point[strand] as usize..strands.first_point[strand + 1] as usize;
        for (a, b) in points.clone().zip(points.skip(1)) {
            let [from, to] = [a, b].map(|at| lattice.window_from_world(strands.point(at)));
            if !lattice.holds(from) || !lattice.holds(to) {
                continue;
            }
            let step = to - from;
            let length = length_of(step);
            // Neighbouring samples are at most half a cell apart.
            let count = (2.0 * length) as u32 + 1;
            let inverse = 1.0 / count as f32;
            let depth = (each * length * inverse + 0.5).min(MOST as f32) as u32;
            if depth == 0 {
                continue;
            }
            for sample in 0..count {
                let t = ((sample as f32 + 0.5) * inverse).min(1.0);
                add((from + step * t).as_uvec3(), depth);
            }
        }
    }
}

fn for_each_sample(
    input: &ShadowInput,
    lattice: &Lattice,
    each: f32,
    add: impl Fn(glam::UVec3, u32) + Sync,
) -> u64 {
    let tasks = input.strands.count().div_ceil(STRANDS_PER_TASK);
    let run = |task| {
        let mut count = 0;
        samples(input, lattice, each, task, |cell, depth| {
            count += 1;
            add(cell, depth);
        });
        count
    };
    (0..tasks).into_par_iter().map(run).sum()
}

/// The number of each brick with hair plus 1, in the order of the window, and how many there are.
pub(super) fn bricks_of(input: &ShadowInput, lattice: &Lattice, each: f32) -> (Vec<u32>, usize) {
    let mut marks: Vec<AtomicU32> = (0..lattice.count()).map(|_| AtomicU32::new(0)).collect();
    for_each_sample(input, lattice, each, |cell, _| {
        for (brick, _) in places(lattice, cell) {
            marks[brick as usize].store(1, Relaxed);
        }
    });
    let mut count = 0;
    let number = |mark: &mut AtomicU32| {
        count += *mark.get_mut();
        *mark.get_mut() * count
    };
    let index = marks.iter_mut().map(number).collect();
    (index, count as usize)
}

/// The density of all bricks, and the number of samples. Integers give the same sums in any order; a sum that is too large stays so.
pub(super) fn fill(
    input: &ShadowInput,
    lattice: &Lattice,
    each: f32,
    (index, count): (&[u32], usize),
    cells: &mut Vec<AtomicU32>,
) -> u64 {
    cells.clear();
    cells.resize_with(count * BRICK_WORDS, AtomicU32::default);
    let cells = &cells[..];
    for_each_sample(input, lattice, each, |cell, depth| {
        for (brick, at) in places(lattice, cell) {
            let Some(number) = index[brick as usize].checked_sub(1) else { continue };
            let cell = &cells[number as usize * BRICK_WORDS + at as usize];
            let before = cell.fetch_add(depth, Relaxed);
            if before.checked_add(depth).is_none() {
                // Only who sees the sum wrap around sets this bit: it outlasts all that are added before the next time.
                cell.fetch_or(1 << 31, Relaxed);
            }
        }
    })
}

/// The length of a segment in cells.
#[inline]
fn length_of(step: Vec3) -> f32 {
    (step.x * step.x + step.y * step.y + step.z * step.z).sqrt()
}
