//! The effect of the density grid on hair.

use std::ops::Range;

use glam::{IVec3, Mat3, Vec3};

use super::cell::{NUMBERS, PARTS};
use super::direction::{crossing, friction_target, push_across};
use super::pieces::tangents;
use super::{DensityGrid, MAX_SHARE_OF_A_CELL, MOMENTUM, OFFSETS, SIDES, index};
use crate::block::Block;
#[cfg(test)]
use crate::lanes::splat3;
use crate::lanes::{LANES, Lane, Lane3, Map, ZERO, ZERO3, at, lesser, put, row_barrier, transposed};
use crate::rates::{RowRates, rubbed};
use crate::settings::RepulsionMode;
use crate::trilinear::gradient;

/// Distance from the centre of a cell within which the published force is faded, as a fraction of a cell.
pub(super) const NEAR_CENTRE: f32 = 0.1;

/// The head and the time step for which [`DensityGrid::act`] computes forces.
pub(crate) struct GridStep<'a> {
    /// Substep length, seconds.
    pub(crate) h: f32,
    /// The number of substeps in a step.
    pub(crate) substeps: f32,
    /// Fraction of the velocity relative to the surrounding hair that vanishes in a step.
    pub(crate) cohesion: f32,
    /// What changes along a guide.
    pub(crate) rows: &'a [RowRates],
    /// Carries head space to the space of the block's positions.
    pub(crate) last_head: &'a Map,
    /// The inverse of `last_head`.
    pub(crate) head_from_last: &'a Map,
}

/// The grid around a row of points, in head space; only lanes with `found` have hair around them.
struct RowSample {
    found: [bool; LANES],
    /// Direction away from over-dense places, 1/m, to be multiplied by the strength.
    push: Lane3,
    /// Mean velocity of the surrounding hair, metres per second, in the axes in which it was deposited.
    mean_velocity: Lane3,
    /// Fraction of the surrounding hair that crosses the given direction; 0 if nothing uses it.
    crossing: Lane,
    /// How densely hair surrounds the point: 1 as at rest inside the hair or denser. A lock alone in the air has
    /// its own density, a small part of that.
    inside: Lane,
}

impl DensityGrid {
    /// Samples the grid at the points `p` for hair along `t`, both in head space.
    #[inline(always)]
    fn sample_row(&self, p: &Lane3, t: &Lane3) -> RowSample {
        let corners = self.lattice.corners(p);
        let (weights, cells) = (corners.weights(), self.cells());
        // Gathers lane by lane first, so that the arithmetic can run over all lanes at once.
        let (mut around, mut excesses) = ([ZERO; LANES], [ZERO; 8]);
        for k in 0..LANES {
            if !corners.inside[k] {
                continue;
            }
            let mut all = [0.0_f32; NUMBERS];
            for n in 0..8 {
                let (cell, weight) = (&cells[corners.base[k] as usize + OFFSETS[n]], weights[n][k]);
                for (sum, value) in all.iter_mut().zip(cell.0).take(PARTS) {
                    *sum += weight * value as f32;
                }
                excesses[n][k] = cell.excess();
                row_barrier();
            }
            around[k] = Lane(all);
        }
        let sums = transposed(&around);
        let mut out = RowSample {
            found: [false; LANES],
            push: ZERO3,
            mean_velocity: ZERO3,
            crossing: ZERO,
            inside: ZERO,
        };
        let (mut crowded, inv_full) = ([false; LANES], 1.0 / self.full());
        for k in 0..LANES {
            let excess: [f32; 8] = std::array::from_fn(|n| excesses[n][k]);
            crowded[k] = excess.iter().any(|&e| e > 0.0);
            let mass = sums[0][k];
            out.found[k] = mass >= 1.0;
            out.inside[k] = lesser(mass * inv_full, 1.0);
            let mean = Vec3::new(sums[1][k], sums[2][k], sums[3][k]) / (mass * MOMENTUM);
            put(&mut out.mean_velocity, k, mean);
            let directions = [sums[4][k], sums[5][k], sums[6][k], sums[7][k], sums[8][k], sums[9][k]];
            let across = crossing(&directions, mass, at(t, k));
            out.crossing[k] = if crowded[k] && self.repulsion.anisotropy > 0.0 { across } else { 0.0 };
            put(&mut out.push, k, -gradient(&excess, at(&corners.fraction, k)) / self.lattice.cell);
        }
        if self.repulsion.mode == RepulsionMode::Centre {
            for k in (0..LANES).filter(|&k| crowded[k]) {
                put(&mut out.push, k, self.away_from_centre(at(p, k)));
            }
        }
        out
    }

    /// The published force: away from the centre of the cell that contains `p`, if that cell is over-dense.
    /// It has full strength up to the faces, because hair must leave the cell: a force that fades toward the
    /// faces only moves hair within its cell, and the hair keeps no more volume than without. It is faded near
    /// the centre, where it has no direction.
    #[cold]
    fn away_from_centre(&self, p: Vec3) -> Vec3 {
        let cell = ((p - self.lattice.min) / self.lattice.cell).as_ivec3().clamp(IVec3::ZERO, SIDES - 1);
        let out = p - (self.lattice.min + (cell.as_vec3() + 0.5) * self.lattice.cell);
        let excess = self.cells()[index(cell)].excess();
        out * (excess / (out.length().max(NEAR_CENTRE * self.lattice.cell) * self.lattice.cell))
    }

    /// Adds the forces of the grid to a block whose positions are still those of the last step, and finds how
    /// densely hair surrounds each point.
    #[inline(always)]
    pub(crate) fn act(&self, block: &mut Block, step: &GridStep) {
        block.work.inside.fill(ZERO);
        if !self.has_effect() {
            return;
        }
        let count = block.points();
        let (mut from, mut to) = (0, 0);
        let mut row = GridEffect { dv: ZERO3, mean: ZERO3, inside: ZERO };
        loop {
            let next = self.effect(block, step, to);
            if to > 0 {
                add_interpolated(
                    block,
                    from..if to + 1 == count { count } else { to },
                    to - from,
                    &row,
                    &next,
                    step,
                );
            }
            if to + 1 >= count {
                break;
            }
            (row, from, to) = (next, to, (to + self.lattice.stride).min(count - 1));
        }
    }

    #[inline(always)]
    fn effect(&self, block: &Block, step: &GridStep, i: usize) -> GridEffect {
        let most = MAX_SHARE_OF_A_CELL * self.lattice.cell / step.h;
        let turn: Mat3 = step.last_head.turn;
        // The published force is isotropic.
        let anisotropy = match self.repulsion.mode {
            RepulsionMode::Pressure => self.repulsion.anisotropy,
            RepulsionMode::Centre => 0.0,
        };
        let (tangent, here, velocity) = (tangents(block, i), block.position[i], block.velocity[i]);
        let (mut p, mut along) = (ZERO3, ZERO3);
        for k in 0..LANES {
            put(&mut p, k, step.head_from_last.apply(at(&here, k)));
            put(&mut along, k, step.head_from_last.rotate(at(&tangent, k)));
        }
        let sample = self.sample_row(&p, &along);
        let mut out = GridEffect { dv: ZERO3, mean: ZERO3, inside: sample.inside };
        for k in 0..LANES {
            let (t, v) = (at(&tangent, k), at(&velocity, k));
            let push = push_across(turn * at(&sample.push, k), t, sample.crossing[k], anisotropy);
            let dv = push * (self.repulsion.strength * step.h);
            let size = dv.length_squared();
            let shorter = (dv / size.sqrt()) * most;
            let mean = friction_target(at(&sample.mean_velocity, k), v, t, anisotropy);
            let (long, found) = (size > most * most, sample.found[k]);
            let pick = |long: bool, a: f32, b: f32| if long { a } else { b };
            for axis in 0..3 {
                let dv = pick(long, shorter[axis], dv[axis]);
                out.dv[axis][k] = pick(found, dv, 0.0);
                out.mean[axis][k] = pick(found, mean[axis], v[axis]);
            }
        }
        out
    }

    /// The sample at one point: push, mean velocity and crossing fraction.
    #[cfg(test)]
    pub(super) fn sample(&self, p: Vec3, t: Vec3) -> Option<(Vec3, Vec3, f32)> {
        let sample = self.sample_row(&splat3(p), &splat3(t));
        let lane = LANES / 3;
        let found = sample.found[lane];
        found.then(|| (at(&sample.push, lane), at(&sample.mean_velocity, lane), sample.crossing[lane]))
    }
}

/// The effect of the grid on a row of points: the change of velocity per substep, and the neighbours' mean
/// velocity.
struct GridEffect {
    dv: Lane3,
    mean: Lane3,
    inside: Lane,
}

/// Interpolates the effect over `points` from `row`, at the first of them, to `next`, `run` points further
/// on.
#[inline(always)]
fn add_interpolated(
    block: &mut Block,
    points: Range<usize>,
    run: usize,
    row: &GridEffect,
    next: &GridEffect,
    step: &GridStep,
) {
    for i in points.clone() {
        let t = (i - points.start) as f32 / run as f32;
        let (mut push, mut inside) = (block.work.push[i], ZERO);
        let (velocity, friction) = (&block.velocity[i], step.rows[i].hair_friction * step.substeps);
        for k in 0..LANES {
            let dv = at(&row.dv, k).lerp(at(&next.dv, k), t);
            let mean = at(&row.mean, k).lerp(at(&next.mean, k), t);
            inside[k] = row.inside[k] + (next.inside[k] - row.inside[k]) * t;
            // The mean is that at the start of the step. Hair takes on part of its difference from it, spread over the
            // substeps: if hair were drawn toward the mean itself, it would not take part in what the neighbours
            // gain or lose meanwhile, and friction would add energy.
            let relative = mean - at(velocity, k);
            let taken = 1.0 - (1.0 - step.cohesion) * (1.0 - rubbed(friction * inside[k], relative));
            let pushed = at(&push, k) + dv + relative * (taken / step.substeps);
            put(&mut push, k, pushed);
        }
        (block.work.push[i], block.work.inside[i]) = (push, inside);
    }
}
