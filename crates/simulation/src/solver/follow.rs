//! Dynamic follow-the-leader: the effect of the placement pass on velocities, and its correction.
//!
//! The pass from root to tip moves only the follower of a link, as if every point were infinitely heavier
//! than the next. With velocities derived from positions alone, a chain gains energy. Müller, Kim and
//! Chentanez (2012) therefore give each leader part of its follower's correction with opposite sign:
//! `v_i = (p_i - x_i) / h - s d_(i+1) / h`, where `d` is the displacement by the pass.

use super::Plan;
use crate::block::Block;
use crate::lanes::{LANES, at, direction_or, put};

/// Corrects the velocities of the free points after the placement pass; `next` still holds the unconstrained
/// positions. Displacements by contacts are not part of the follower's correction and do not count.
#[inline(always)]
pub(crate) fn correct_velocities(block: &mut Block, plan: &Plan) {
    let scale = plan.settings.follow_damping / plan.h;
    for i in plan.first_free..block.points().saturating_sub(1) {
        let (leader, wanted, length) = (block.position[i], block.work.next[i + 1], block.rest.length[i + 1]);
        let mut velocity = block.velocity[i];
        for k in 0..LANES {
            let link = at(&wanted, k) - at(&leader, k);
            let (direction, now) = direction_or(link, link);
            let v = at(&velocity, k) - direction * ((length[k] - now) * scale);
            put(&mut velocity, k, v);
        }
        block.velocity[i] = velocity;
    }
}
