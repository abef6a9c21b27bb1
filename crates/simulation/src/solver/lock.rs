//! The three guides of a wisp as one lock.
//!
//! Cohesion bounds the distance of each guide from the middle of its lock. A guide beyond the bound is pulled back
//! with a time constant, so that a lock splits on an obstacle and closes again behind it. Friction inside the lock
//! lets its guides take on each other's velocity. The bound is wider for a lock that moves fast or touches the body.
//! Cohesion and friction keep the momentum of the lock: they add nothing to its mean.

use glam::Vec3;

use super::Plan;
use crate::block::Block;
use crate::lanes::{LANES, Lane3, ZERO3, at, choose, direction_or, greater, lesser, put};
use crate::packing::mean_of_lock;

/// A guide is free up to this multiple of its distance at rest.
const FREE: f32 = 1.2;

/// A lock is at least this wide, metres.
const LEAST_RADIUS: f32 = 0.004;

/// Speed relative to the head at which a lock opens fully, metres per second.
const FAST: f32 = 4.0;

/// Guides this far from the middle of their lock are lost, and will be reset, metres.
const LOST: f32 = 4.0;

/// Guides that move faster than this relative to their lock are lost too, metres per second.
const FASTEST: f32 = 1e3;

/// Pulls the guides of each lock to within its bound.
#[inline(always)]
pub(super) fn hold_together(block: &mut Block, plan: &Plan, s: usize) {
    if block.locks == 0 {
        return;
    }
    let (substep, opening) = (&plan.substeps[s], plan.settings.locks.opening);
    for i in plan.first_free.max(1)..block.points() {
        let (row, radius) = (&plan.rows[i], &block.rest.lock_radius[i]);
        let p = &mut block.work.next[i];
        let middle = mean_of_lock(p);
        let (velocity, touch) = (mean_of_lock(&block.velocity[i]), mean_of_lock(&block.contact_push[i]));
        let mut pull = ZERO3;
        for k in 0..LANES {
            let (out, distance) = direction_or(at(p, k) - at(&middle, k), Vec3::ZERO);
            let relative = at(&velocity, k) - substep.rigid_velocity(at(&middle, k));
            let fast = lesser(relative.length_squared() * (1.0 / (FAST * FAST)), 1.0);
            let touched = if at(&touch, k).length_squared() > 0.0 { 1.0 } else { 0.0 };
            let opened = 1.0 + opening * greater(fast, touched);
            let bound = greater(FREE * radius[k], LEAST_RADIUS) * opened;
            // False for NaN.
            let held = distance > bound && distance < LOST && k < 3 * block.locks;
            let back = (bound - distance) * row.cohesion;
            put(&mut pull, k, choose(held, out * back, Vec3::ZERO));
        }
        *p = without_mean(p, &pull);
    }
}

/// Damps the velocities `v` of the guides of each lock relative to each other, by the fraction `share`.
#[inline(always)]
pub(super) fn rub(locks: usize, share: f32, v: &mut Lane3) {
    let mean = mean_of_lock(v);
    for k in 0..LANES {
        let relative = at(&mean, k) - at(v, k);
        // False for NaN.
        let rubs = relative.length_squared() < FASTEST * FASTEST && k < 3 * locks;
        let slower = at(v, k) + choose(rubs, relative * share, Vec3::ZERO);
        put(v, k, slower);
    }
}

/// `p` plus what `change` differs from its mean over each lock.
#[inline(always)]
fn without_mean(p: &Lane3, change: &Lane3) -> Lane3 {
    let mean = mean_of_lock(change);
    let mut out = ZERO3;
    for axis in 0..3 {
        out[axis] = p[axis].plus(change[axis].minus(mean[axis]));
    }
    out
}
