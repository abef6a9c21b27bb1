//! The forces of a step, worked out once and applied in every substep.

use glam::Vec3;

use super::Plan;
use crate::block::Block;
use crate::lanes::{LANES, Lane, ZERO3, at, greater, lesser, put};

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
    let mut before = block.position[0];
    for i in 0..block.points() {
        let (support, direction, here) = (block.rest.support[i], block.rest.direction[i], block.position[i]);
        let inv = block.rest.inv_length[i];
        let mut push = ZERO3;
        for k in 0..LANES {
            // The bends that carry a lock at rest carry it no more once it has left its shape: flung hair falls
            // with its whole weight. Support fades from 37 to 66 degrees off the direction of rest.
            let link = (at(&here, k) - at(&before, k)) * inv[k];
            let along = link.dot(plan.last_head.rotate(at(&direction, k)));
            let share = if i == 0 { 1.0 } else { lesser(greater((along - 0.4) * 2.5, 0.0), 1.0) };
            let a = gravity + plan.last_head.rotate(at(&support, k)) * (carried * share);
            put(&mut push, k, a * plan.h);
        }
        before = here;
        block.work.push[i] = push;
    }
    plan.grid.act(block, plan, cohesion);
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
