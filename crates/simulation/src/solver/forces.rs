//! The forces of a step, computed once and applied in every substep.

use glam::Vec3;

use super::Plan;
use crate::block::Block;
use crate::grid::GridStep;
use crate::lanes::{LANES, Lane, ZERO3, at, direction_or, greater, lesser, put};

/// Limits of the displacement along the support, as fractions of the arc length from the root. Up to the
/// first the support is full, beyond the second it is 0. For a guide that was level they correspond to 24 and
/// 64 degrees below it.
const FULL_SUPPORT: f32 = 0.4;
const NO_SUPPORT: f32 = 0.9;

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
            // The support that carries a guide at rest fades once the guide leaves its shape, so that flung
            // hair falls with its whole weight. The remainder depends only on the displacement along the
            // support, so the force has a potential; if it depended on the guide's direction, it would drive
            // the guide for ever.
            let support = plan.last_head.rotate(at(support, k));
            let (along, _) = direction_or(support, Vec3::ZERO);
            let displacement = (at(here, k) - plan.last_head.apply(at(rest, k))).dot(along);
            let arc_length = block.rest.mean_link[k] * i as f32 + 1e-6;
            let share = (NO_SUPPORT - greater(displacement, -displacement) / arc_length)
                * (1.0 / (NO_SUPPORT - FULL_SUPPORT));
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
