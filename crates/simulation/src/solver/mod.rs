//! Advances one block of guides by one step.
//!
//! A substep consists of: forces on velocities; projection of the velocities so that no link stretches; a
//! step of the positions; implicit shape memory; one Newton step of the lengths; and the placement pass from
//! root to tip, which makes the lengths exact and keeps points out of the body. The velocities follow from
//! the positions.

mod follow;
mod forces;
mod lock;
mod plan;
mod relaxation;
mod substep;

pub(crate) use forces::CONSTANTS as FORCE_CONSTANTS;
pub(crate) use lock::CONSTANTS as LOCK_CONSTANTS;
pub(crate) use plan::{Ending, Plan};
pub(crate) use substep::{CONSTANTS as SUBSTEP_CONSTANTS, FACTOR_CHECK_INTERVAL};

use crate::block::{Block, Outcome, stretch_of};
use crate::colliders::field::PlaneRow;
use crate::lanes::{LANES, ZERO, at, greater, put};

/// Advances `block` by the step of `plan`.
#[inline(always)]
pub(crate) fn advance(block: &mut Block, plan: &Plan) {
    block.outcome = Outcome::default();
    block.work.fit(block.position.len());
    forces::prepare(block, plan);
    if plan.field.is_some() {
        for (planes, skin) in block.work.planes.iter_mut().zip(&block.skin) {
            *planes = PlaneRow::unknown(*skin);
        }
    }
    for i in 0..plan.substeps.len() {
        substep::run(block, plan, i);
    }
    if plan.field.is_some() {
        for (planes, skin) in block.work.planes.iter().zip(&mut block.skin) {
            *skin = planes.rest;
        }
    }
    measure(block, &plan.ending());
}

/// Resets guides that are not finite and measures the others.
#[inline(always)]
pub(crate) fn measure(block: &mut Block, ending: &Ending) {
    let count = block.points();
    let mut size = ZERO;
    for i in 0..count {
        let (p, v) = (&block.position[i], &block.velocity[i]);
        for k in 0..LANES {
            size[k] += at(p, k).length_squared() + at(v, k).length_squared();
        }
    }
    for k in 0..LANES {
        // Hair further than 300 m from its head counts as lost.
        if size[k].is_nan() || size[k] > 1e5 * count as f32 {
            restore(block, ending, k);
            block.has_contact_push = block.any_contact_push();
            if k < block.used {
                block.outcome.recovered += 1;
                block.outcome.first_recovered.get_or_insert(k);
            }
        }
    }
    let (mut stretch, mut energy, mut fastest) = (ZERO, ZERO, ZERO);
    for i in ending.first_free.max(1)..count {
        let (a, b) = (&block.position[i - 1], &block.position[i]);
        let (v, inv) = (&block.velocity[i], &block.rest.inv_length[i]);
        for k in 0..LANES {
            stretch[k] = greater(stretch[k], stretch_of(at(b, k) - at(a, k), inv[k]));
            let speed = at(v, k).length_squared();
            energy[k] += 0.5 * speed;
            fastest[k] = greater(fastest[k], speed);
        }
    }
    let out = &mut block.outcome;
    for k in 0..block.used {
        out.max_stretch = greater(out.max_stretch, stretch[k]);
        out.max_speed_squared = greater(out.max_speed_squared, fastest[k]);
        out.energy += f64::from(energy[k]);
    }
}

/// Resets lane `k` to its pose at the beginning of the step, carried along with the head; to its rest pose
/// where that pose was not finite either.
#[cold]
fn restore(block: &mut Block, ending: &Ending, k: usize) {
    let last = ending.last.as_ref();
    let known = block.work.start_pose.iter().all(|row| at(row, k).is_finite());
    for i in 0..block.points() {
        let was = ending.carry_all.apply(at(&block.work.start_pose[i], k));
        let rest = at(&block.rest.position[i], k);
        let p = if known { was } else { last.map_or(rest, |s| s.head.apply(rest)) };
        put(&mut block.position[i], k, p);
        put(&mut block.contact_push[i], k, glam::Vec3::ZERO);
        let v = last.map_or(glam::Vec3::ZERO, |s| s.rigid_velocity(p));
        put(&mut block.velocity[i], k, v);
        let bend = last.map_or(at(&block.rest.bend[i], k), |s| s.head.rotate(at(&block.rest.bend[i], k)));
        put(&mut block.bend[i], k, bend);
    }
}
