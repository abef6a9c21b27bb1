//! The forces of a step, worked out once and applied in every substep.

use glam::Vec3;

use super::Plan;
use crate::block::Block;
use crate::grid::GridStep;
use crate::lanes::{LANES, Lane, ZERO3, at, direction_or, greater, lesser, put};

/// A point that has gone no further along its support than this part of the lock up to it is carried in full, and one that
/// has gone further than the second not at all: a lock that stood out level, 24 and 64 degrees down.
const CARRIED: f32 = 0.4;
const LOST: f32 = 0.9;

/// Moves the block into this step's working space and gathers what acts on each point.
///
/// In a substep of `h` seconds drag, cohesion and friction against the hair around relax the velocity toward
/// the wind, the mean of the neighbours and the head at their rates, exactly (`1 - e^(-rate h)`).
#[inline(always)]
pub(crate) fn prepare(block: &mut Block, plan: &Plan) {
    let settings = &plan.settings;
    let take = |rate: f32| 1.0 - (-rate * plan.h).exp();
    let (drag, cohesion) = (take(settings.drag), take(settings.repulsion.cohesion));
    let rest = &block.rest;
    if block.bending.prepare(plan.bending, &rest.mean_link, &rest.inv_length, &rest.bend, &block.held) {
        block.coupled.prepare(&block.bending, plan.first_free, block.position.len());
    }
    let gravity = Vec3::new(0.0, -settings.gravity, 0.0);
    let carried = settings.style_support * settings.gravity;
    let windy = plan.wind.blows();
    for i in 0..block.points() {
        let (support, rest, here) = (&block.rest.support[i], &block.rest.position[i], &block.position[i]);
        let mut push = ZERO3;
        for k in 0..LANES {
            // The bends that carry a lock at rest carry it no more once it has left its shape: flung hair falls
            // with its whole weight. How much is left depends on how far the point has gone along its support alone, so
            // that the force has a potential: one that heeds the lock's direction drives locks around for ever.
            let support = plan.last_head.rotate(at(support, k));
            let (along, _) = direction_or(support, Vec3::ZERO);
            let gone = (at(here, k) - plan.last_head.apply(at(rest, k))).dot(along);
            let lock = block.rest.mean_link[k] * i as f32 + 1e-6;
            let share = (LOST - greater(gone, -gone) / lock) * (1.0 / (LOST - CARRIED));
            let a = gravity + support * (carried * lesser(greater(share, 0.0), 1.0));
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
        (block.position[i], block.work.good[i]) = (position, position);
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
