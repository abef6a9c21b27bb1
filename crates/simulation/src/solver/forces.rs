//! The forces of a step, computed once and applied in every substep.

use glam::Vec3;

use super::Plan;
use crate::block::Block;
use crate::grid::GridStep;
use crate::lanes::{LANES, Lane, ZERO3, at, direction_or, greater, lesser, put};

/// Distances from the place at rest between which the support fades, as fractions of the arc length from the
/// root.
const SUPPORT_FADES: [f32; 2] = [0.05, 0.25];

/// The acceleration that carries a point at rest, faded with its displacement `d` from there; `support` is the
/// acceleration at rest and `length` the arc length from the root.
///
/// Flung hair falls with its whole weight. The force has the potential `-(S . d) w(|d|)` with the smoothstep `w`
/// from 1 down to 0: a force that faded with the direction of the guide alone would have none, and would drive
/// the guide for ever.
#[inline(always)]
fn faded_support(support: Vec3, d: Vec3, length: f32) -> Vec3 {
    let [full, none] = SUPPORT_FADES;
    let inv_range = 1.0 / ((none - full) * length);
    let (out, distance) = direction_or(d, Vec3::ZERO);
    let t = lesser(greater((none * length - distance) * inv_range, 0.0), 1.0);
    let (w, slope) = (t * t * (3.0 - 2.0 * t), -6.0 * t * (1.0 - t) * inv_range);
    support * w + out * (support.dot(d) * slope)
}

/// Moves the block into the working space of this step and collects the forces on each point.
///
/// Over a substep of `h` seconds drag, cohesion and settling relax the velocity toward the wind, the mean of
/// the neighbours and the head's motion. Each relaxation is exact: `1 - e^(-rate h)`.
#[inline(always)]
pub(crate) fn prepare(block: &mut Block, plan: &Plan) {
    let settings = &plan.settings;
    let take = |rate: f32| 1.0 - (-rate * plan.h).exp();
    let (drag, cohesion) = (take(settings.drag), take(settings.repulsion.cohesion));
    let rest = &block.rest;
    if block.bending.prepare(plan.bending, &rest.mean_link, &rest.inv_length, &rest.bend, &block.tie_hold) {
        block.coupled.prepare(&block.bending, plan.first_free, block.position.len());
    }
    let gravity = Vec3::new(0.0, -settings.gravity, 0.0);
    let carried = settings.style_support * settings.gravity;
    let windy = plan.wind.blows();
    for i in 0..block.points() {
        let (support, rest, here) = (&block.rest.support[i], &block.rest.position[i], &block.position[i]);
        let mut push = ZERO3;
        for k in 0..LANES {
            let support = plan.last_head.rotate(at(support, k));
            let d = at(here, k) - plan.last_head.apply(at(rest, k));
            let length = block.rest.mean_link[k] * i as f32 + 1e-6;
            let a = gravity + faded_support(support, d, length) * carried;
            put(&mut push, k, a * plan.h);
        }
        block.work.push[i] = push;
    }
    let grid_step = GridStep { h: plan.h, last_head: &plan.last_head, head_from_last: &plan.head_from_last };
    plan.grid.act(block, &grid_step, cohesion);
    for i in 0..block.points() {
        let mut position = block.position[i];
        for (axis, shift) in position.iter_mut().zip(plan.rebase.to_array()) {
            for v in axis.iter_mut() {
                *v += shift;
            }
        }
        (block.position[i], block.work.start_pose[i]) = (position, position);
        let (mut push, mut keep) = (block.work.push[i], block.work.keep[i]);
        let (mut air, mut open) = (ZERO3, Lane::splat(1.0));
        if windy {
            (air, open) = (plan.wind.velocity(&position), plan.wakes.exposure(&position));
        }
        for k in 0..LANES {
            let pushed = at(&push, k) + at(&air, k) * (open[k] * drag);
            put(&mut push, k, pushed);
            keep[k] *= 1.0 - drag;
        }
        block.work.push[i] = push;
        block.work.keep[i] = keep;
    }
}
