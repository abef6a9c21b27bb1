//! The forces of a step, computed once and applied in every substep.

use glam::Vec3;

use super::Plan;
use crate::block::Block;
use crate::grid::GridStep;
use crate::lanes::{LANES, Lane, ZERO, ZERO3, at, direction_or, greater, lesser, put};

/// Distances from the place at rest between which the support fades, as fractions of the arc length from the
/// root.
const SUPPORT_FADES: [f32; 2] = [0.05, 0.25];

/// The acceleration that carries a point at rest, faded with its displacement `d` from there, and the remaining
/// share; `support` is the acceleration at rest and `length` the arc length from the root.
///
/// Flung hair falls with its whole weight. The force has the potential `-(S . d) w(|d|)` with the smoothstep `w`
/// from 1 down to 0: a force that faded with the direction of the guide alone would have none, and would drive
/// the guide for ever.
#[inline(always)]
fn faded_support(support: Vec3, d: Vec3, length: f32) -> (Vec3, f32) {
    let [full, none] = SUPPORT_FADES;
    let inv_range = 1.0 / ((none - full) * length);
    let (out, distance) = direction_or(d, Vec3::ZERO);
    let t = lesser(greater((none * length - distance) * inv_range, 0.0), 1.0);
    let (w, slope) = (t * t * (3.0 - 2.0 * t), -6.0 * t * (1.0 - t) * inv_range);
    (support * w + out * (support.dot(d) * slope), w)
}

/// Moves the block into the working space of this step and collects the forces on each point.
///
/// Over a substep of `h` seconds cohesion, settling and the air relax the velocity toward the mean of the
/// neighbours, the head's motion and the wind.
#[inline(always)]
pub(crate) fn prepare(block: &mut Block, plan: &Plan) {
    let settings = &plan.settings;
    let cohesion = 1.0 - (-settings.repulsion.cohesion * plan.h).exp();
    let rest = &block.rest;
    if block.bending.prepare(plan.bending, &rest.mean_link, &rest.inv_length, &rest.bend, &block.tie_hold) {
        block.coupled.prepare(&block.bending, plan.first_free, block.position.len());
    }
    let gravity = Vec3::new(0.0, -settings.gravity, 0.0);
    let carried = settings.style_support * settings.gravity;
    let windy = plan.wind.blows();
    for i in 0..block.points() {
        let (support, rest, here) = (&block.rest.support[i], &block.rest.position[i], &block.position[i]);
        let (mut push, mut near_rest) = (ZERO3, ZERO);
        for k in 0..LANES {
            let support = plan.last_head.rotate(at(support, k));
            let d = at(here, k) - plan.last_head.apply(at(rest, k));
            let length = block.rest.mean_link[k] * i as f32 + 1e-6;
            let (support, share) = faded_support(support, d, length);
            let a = gravity + support * carried;
            near_rest[k] = share;
            put(&mut push, k, a * plan.h);
        }
        (block.work.push[i], block.work.carried[i]) = (push, near_rest);
    }
    let grid_step = GridStep {
        h: plan.h,
        cohesion,
        rows: plan.rows,
        last_head: &plan.last_head,
        head_from_last: &plan.head_from_last,
    };
    plan.grid.act(block, &grid_step);
    for i in 0..block.points() {
        let mut position = block.position[i];
        for (axis, shift) in position.iter_mut().zip(plan.rebase.to_array()) {
            for v in axis.iter_mut() {
                *v += shift;
            }
        }
        (block.position[i], block.work.start_pose[i]) = (position, position);
        let (mut push, mut keep) = (block.work.push[i], block.work.keep[i]);
        let (velocity, inside) = (&block.velocity[i], &block.work.inside[i]);
        let mut carried = block.work.carried[i];
        let (mut air, mut open) = (ZERO3, Lane::splat(1.0));
        if windy {
            (air, open) = (plan.wind.velocity(&position), plan.wakes.exposure(&position));
        }
        for k in 0..LANES {
            let wind = at(&air, k) * open[k];
            let kept =
                kept_in_air(plan.rows[i].drag, wind - at(velocity, k), settings.air_shelter * inside[k]);
            let pushed = at(&push, k) * kept + wind * (1.0 - kept);
            put(&mut push, k, pushed);
            keep[k] *= kept;
            carried[k] *= inside[k];
        }
        block.work.carried[i] = carried;
        block.work.push[i] = push;
        block.work.keep[i] = keep;
    }
}

/// Speed of the air relative to hair at which its drag is twice that of slow air, metres per second.
const FAST_AIR: f32 = 3.0;

/// Fraction of its velocity relative to the air that a point keeps in a substep; `drag` is the rate in slow air
/// times the substep, and `sheltered` the fraction of the air that the surrounding hair keeps away.
///
/// The drag of a thin fibre grows in proportion to the speed in slow air, and with its square in fast air. Solved
/// implicitly, so that falling hair reaches exactly the speed at which drag balances weight.
#[inline(always)]
fn kept_in_air(drag: f32, relative: Vec3, sheltered: f32) -> f32 {
    let speed = relative.length_squared().sqrt();
    1.0 / (1.0 + drag * (1.0 + speed * (1.0 / FAST_AIR)) * (1.0 - sheltered))
}
