//! One substep of one block.

use super::Plan;
use super::follow::correct_velocities;
use super::lock::{hold_together, rub};
use super::relaxation::relax;
use crate::Integrator;
use crate::block::{Block, Depth, Work, project_position, project_velocity};
use crate::colliders::boxes::{apart, bounds};
use crate::colliders::contact::{
    Near, NearField, field_root_penetration, penetration, place_point, root_penetration,
};
use crate::lanes::{LANES, Lane, Map, Turns, ZERO, ZERO3, at, choose, direction_or, greater, lesser, put};
use crate::motion::Substep;
use crate::rates::rubbed;
use crate::rope;
use glam::Vec3;

/// Advances the block by substep `s`.
#[inline(always)]
pub(crate) fn run(block: &mut Block, plan: &Plan, s: usize) {
    forces(block, plan, s);
    if plan.settings.integrator == Integrator::Direct {
        project_velocity(
            plan.first_free,
            &block.position,
            &block.rest.inv_length,
            &mut block.velocity,
            plan.h,
            &mut block.work.next,
            &mut block.work.lengths,
        );
    } else {
        step_positions(block, plan.h);
    }
    shape_memory(block, plan, s);
    if plan.settings.integrator == Integrator::Direct {
        apply_contact_push(block, plan);
    }
    hold_together(block, plan, s);
    if let Some(found) = &block.in_rope {
        let passed = (s + 1) as f32 * plan.h;
        let next = &mut block.work.next;
        rope::hold(found, plan.ropes, plan.first_free.max(1), passed, plan.h, next);
    }
    // One placement pass serves all integrators, so that it is compiled only once per vector width.
    let link_length = match plan.settings.integrator {
        Integrator::Direct => {
            lengths(block, plan, s);
            LinkLength::Rest
        }
        Integrator::Relaxation => {
            relax(plan, &block.rest.length, &mut block.work.next);
            LinkLength::Current
        }
        Integrator::FollowTheLeader => LinkLength::FollowLeader,
    };
    find_near(block, plan, s);
    place_points(block, plan, s, link_length);
    if plan.settings.integrator == Integrator::FollowTheLeader {
        correct_velocities(block, plan);
    }
}

/// The length that the placement pass gives to links.
#[derive(Clone, Copy, PartialEq, Eq)]
enum LinkLength {
    /// The rest length.
    Rest,
    /// The rest length, but the rest of the guide does not follow the displacement of a point: the next link
    /// pulls it.
    FollowLeader,
    /// Their current length.
    Current,
}

/// One Newton step of the lengths, in the metric of the bends.
#[inline(always)]
fn lengths(block: &mut Block, plan: &Plan, s: usize) {
    if block.bending.is_chain() {
        project_position(plan.first_free, &block.rest.length, &mut block.work.next, &mut block.work.lengths);
    } else {
        let to_head = Map { turn: plan.substeps[s].head.turn.transpose(), shift: Vec3::ZERO };
        block.coupled.project(
            plan.first_free,
            &block.rest.length,
            &mut block.work.next,
            &block.bending,
            &mut block.work.lengths,
            &mut block.work.residual,
            s.is_multiple_of(FACTOR_CHECK_INTERVAL).then_some(&to_head),
        );
    }
}

/// Applies forces to velocities, and sets the velocities of points that the scalp carries.
#[inline(always)]
fn forces(block: &mut Block, plan: &Plan, s: usize) {
    let (substep, h, inv_h) = (&plan.substeps[s], plan.h, 1.0 / plan.h);
    let even = Lane::splat(1.0 - (-plan.settings.settle * h).exp());
    for i in 0..plan.first_free {
        let (rest, x) = (&block.rest.position[i], &block.position[i]);
        let mut v = ZERO3;
        for k in 0..LANES {
            put(&mut v, k, (substep.head.apply(at(rest, k)) - at(x, k)) * inv_h);
        }
        block.velocity[i] = v;
    }
    for i in plan.first_free..block.points() {
        let (x, push, keep) = (&block.position[i], &block.work.push[i], &block.work.keep[i]);
        let settle = match &block.factors {
            Some(factors) => factors.settle[i],
            None => even,
        };
        let (carried, friction) = (&block.work.carried[i], plan.rows[i].hair_friction);
        let mut v = block.velocity[i];
        for k in 0..LANES {
            let (was, head) = (at(&v, k), substep.rigid_velocity(at(x, k)));
            // Friction acts on the velocity before the forces: what these add is partly balanced by the tension of the
            // links, and hair would drift if friction took some of it away first.
            let relative = head - was;
            let settled = was + relative * greater(settle[k], rubbed(friction * carried[k], relative));
            put(&mut v, k, settled * keep[k] + at(push, k));
        }
        if block.locks > 0 {
            rub(block.locks, plan.rows[i].lock_friction, &mut v);
        }
        block.velocity[i] = v;
    }
}

/// Advances the positions into `next`.
#[inline(always)]
fn step_positions(block: &mut Block, h: f32) {
    for i in 0..block.points() {
        let (x, v) = (&block.position[i], &block.velocity[i]);
        let mut next = ZERO3;
        for k in 0..LANES {
            put(&mut next, k, at(x, k) + at(v, k) * h);
        }
        block.work.next[i] = next;
    }
}

/// Marks a missing direction in its first component.
const NO_DIRECTION: f32 = 2.0;

/// Carries the head's frame along `next` by smallest rotations. Writes the direction of each link to `links`,
/// and to `next_bend` the direction that the following link would have if the guide continued in its rest
/// shape.
///
/// The dependency from row to row is kept as short as possible; everything else is computed row by row,
/// before and after.
#[inline(always)]
fn carry_frames(block: &mut Block, substep: &Substep) {
    let count = block.points();
    if count < 2 {
        return;
    }
    for i in 1..count - 1 {
        let (a, b) = (&block.work.next[i - 1], &block.work.next[i]);
        let mut link = ZERO3;
        for k in 0..LANES {
            let (direction, _) = direction_or(at(b, k) - at(a, k), Vec3::splat(NO_DIRECTION));
            put(&mut link, k, direction);
        }
        block.work.links[i] = link;
    }
    let mut frames = Turns::splat(substep.head_turn);
    let (mut expected, first) = (ZERO3, block.rest.direction[1]);
    for k in 0..LANES {
        put(&mut expected, k, substep.head.rotate(at(&first, k)));
    }
    for i in 1..count - 1 {
        let (mut link, next_direction) = (block.work.links[i], &block.rest.direction[i + 1]);
        for k in 0..LANES {
            let was_expected = at(&expected, k);
            let now = choose(link[0][k] < NO_DIRECTION, at(&link, k), was_expected);
            let frame = frames.at(k).then_smallest(was_expected, now);
            frames.put(k, frame);
            put(&mut expected, k, frame.apply(at(next_direction, k)));
            put(&mut link, k, now);
        }
        block.work.links[i] = link;
        block.work.next_bend[i] = expected;
    }
}

/// Pulls `next` toward the rest bends in the frames carried along it, and toward the style near the roots.
#[inline(always)]
fn shape_memory(block: &mut Block, plan: &Plan, s: usize) {
    let (substep, count) = (&plan.substeps[s], block.points());
    carry_frames(block, substep);
    // c [(1 + gamma) (D p - b*) - gamma (D x - b*_old)] at every inner point.
    for i in 1..count.saturating_sub(1) {
        let (p0, p1, p2) = (&block.work.next[i - 1], &block.work.next[i], &block.work.next[i + 1]);
        let (x0, x1, x2) = (&block.position[i - 1], &block.position[i], &block.position[i + 1]);
        let (link, goes_on, rest_bend) =
            (&block.work.links[i], &block.work.next_bend[i], &block.rest.bend[i]);
        let (length, next_length) = (&block.rest.length[i], &block.rest.length[i + 1]);
        let (old, c, head_share) = (&block.bend[i], block.bending.stiffness(i), block.bending.head_share(i));
        let gamma = block.bending.gamma(i);
        let (mut bend, mut residual) = (ZERO3, ZERO3);
        for k in 0..LANES {
            // The rest bend is the next link minus this one, both at rest length.
            let with_lock = at(goes_on, k) * next_length[k] - at(link, k) * length[k];
            let with_head = substep.head.rotate(at(rest_bend, k));
            let wanted = with_lock + (with_head - with_lock) * head_share[k];
            let now = at(p0, k) - 2.0 * at(p1, k) + at(p2, k);
            let before = at(x0, k) - 2.0 * at(x1, k) + at(x2, k);
            let r = (now - wanted) * (1.0 + gamma[k]) - (before - at(old, k)) * gamma[k];
            put(&mut bend, k, wanted);
            put(&mut residual, k, r * c[k]);
        }
        block.work.next_bend[i] = bend;
        block.work.residual[i] = residual;
    }
    block.work.residual[0] = ZERO3;
    block.work.residual[count - 1] = ZERO3;
    // -D^T r and the pull toward the style, in place, followed directly by the forward elimination.
    let (mut one, mut two) = (ZERO3, ZERO3);
    let mut left = if plan.first_free > 0 { block.work.residual[plan.first_free - 1] } else { ZERO3 };
    for i in plan.first_free..count {
        let middle = block.work.residual[i];
        let right = block.work.residual.get(i + 1).unwrap_or(&ZERO3);
        let (rest, p, hold) = (&block.rest.position[i], &block.work.next[i], block.bending.hold(i));
        let mut force = ZERO3;
        for k in 0..LANES {
            let styled = substep.head.apply(at(rest, k)) - at(p, k);
            let f = 2.0 * at(&middle, k) - at(&left, k) - at(right, k) + styled * hold[k];
            put(&mut force, k, f);
        }
        left = middle;
        force = block.bending.forward(i, &force, &one, &two);
        block.work.residual[i] = force;
        (two, one) = (one, force);
    }
    let Work { residual, next, .. } = &mut block.work;
    block.bending.finish(plan.first_free, residual, next);
}

/// Fraction of the last substep's contact displacement that is applied in advance in the next.
const CONTACT_PUSH_KEPT: f32 = 0.9;

/// The displacement is applied only to points whose hold on the style exceeds this fraction of the first
/// point's. Further out, where a guide may lie between a shoulder and an arm, moving it away from the one
/// would push it into the other.
const NEAR_ROOT: f32 = 0.25;

/// The placement pass may move points this far outside the box of their unconstrained positions, metres.
const BESIDE_BOX: f32 = 0.03;

/// The constants of contacts in a substep by name, for other devices.
pub(crate) const CONSTANTS: [(&str, f64); 3] = [
    ("CONTACT_PUSH_KEPT", CONTACT_PUSH_KEPT as f64),
    ("NEAR_ROOT", NEAR_ROOT as f64),
    ("BESIDE_BOX", BESIDE_BOX as f64),
];

/// The factors of the coupled lengths are checked once per this many substeps.
pub(crate) const FACTOR_CHECK_INTERVAL: usize = 4;

/// Moves points in advance by most of the contact displacement of the last substep, together with everything
/// beyond them.
///
/// Hair that lies against skin is pulled into it by its stiffness and pushed out again. If every substep
/// started from scratch, a stiff guide would swing back and forth by degrees, and the energy of that motion
/// would drive it.
#[inline(always)]
fn apply_contact_push(block: &mut Block, plan: &Plan) {
    if !block.has_contact_push {
        return;
    }
    let (mut moved, mut moved_before) = (ZERO3, ZERO3);
    let root = *block.bending.hold(plan.first_free.clamp(1, block.points() - 1));
    for i in plan.first_free.max(1)..block.points() {
        let shift = block.bending.follow(i - 1, &moved_before, &moved);
        let (pull, hold) = (block.work.residual[i], *block.bending.hold(i));
        let (mut push, mut next) = (block.contact_push[i], block.work.next[i]);
        moved_before = moved;
        for k in 0..LANES {
            let (out, size) = direction_or(at(&push, k), Vec3::ZERO);
            // At most as far as the stiffness pulls inward.
            let against = greater(0.0, lesser(size, -at(&pull, k).dot(out)));
            let near_root = hold[k] > NEAR_ROOT * root[k];
            let against = if near_root { against } else { 0.0 };
            put(&mut push, k, out * (CONTACT_PUSH_KEPT * against));
            put(&mut moved, k, at(&shift, k) + at(&push, k));
            let p = at(&next, k) + at(&moved, k);
            put(&mut next, k, p);
        }
        (block.contact_push[i], block.work.next[i]) = (push, next);
    }
}

/// Lists the colliders whose boxes the block may reach.
#[inline(always)]
fn find_near(block: &mut Block, plan: &Plan, s: usize) {
    block.work.active.clear();
    block.work.boxes.clear();
    block.work.root_penetration.clear();
    let shapes = &plan.shapes[s * plan.shapes_per_substep..][..plan.shapes_per_substep];
    if shapes.is_empty() {
        return;
    }
    let (mut low, mut high) = (block.work.next[0], block.work.next[0]);
    for row in &block.work.next[1..] {
        for axis in 0..3 {
            for k in 0..LANES {
                low[axis][k] = lesser(low[axis][k], row[axis][k]);
                high[axis][k] = greater(high[axis][k], row[axis][k]);
            }
        }
    }
    let ((min, _), (_, max)) = (bounds(&low), bounds(&high));
    let reach = plan.rules.reach() + BESIDE_BOX;
    let carried = plan.first_free.saturating_sub(1);
    for (c, mover) in shapes.iter().enumerate() {
        if mover.shape.is_some() && !apart(min, max, mover, reach) {
            block.work.active.push(c as u32);
            block.work.boxes.push(mover);
            block.work.root_penetration.push(root_penetration(
                &block.work.next[carried],
                mover,
                &block.rest_distance[c * block.points() + carried],
            ));
        }
    }
}

/// The placement pass, and the velocities that follow from it.
#[inline(always)]
fn place_points(block: &mut Block, plan: &Plan, s: usize, link_length: LinkLength) {
    let (count, inv_h) = (block.points(), 1.0 / plan.h);
    let carried = plan.first_free.saturating_sub(1);
    // Not a closure: closures keep the baseline instruction set.
    let mut field = None;
    if let Some(moving) = plan.field {
        let (substep, passed) = (&plan.substeps[s], (s + 1) as f32 / plan.substeps.len() as f32);
        let (rest_distance, root) = (&block.field_distance[..], &block.work.next[carried]);
        let plane = &mut block.work.planes[carried];
        let root_penetration =
            field_root_penetration(root, moving, substep, passed, &rest_distance[carried], plane);
        let (first, reach) = (plan.first_free.clamp(1, count), plan.rules.reach());
        let Work { next, planes, searches, .. } = &mut block.work;
        // With follow-the-leader the points are not yet where they will be.
        if link_length != LinkLength::FollowLeader {
            moving.prefetch_planes(&next[first..], substep, passed, reach, &mut planes[first..], searches);
        }
        field = Some(NearField { moving, substep, passed, rest_distance, root_penetration });
    }
    let near = Near {
        shapes: &plan.shapes[s * plan.shapes_per_substep..][..plan.shapes_per_substep],
        active: &block.work.active,
        boxes: &block.work.boxes,
        rest_distance: &block.rest_distance,
        points: count,
        carried,
        root_penetration: &block.work.root_penetration,
        link: &block.rest.mean_link,
        friction: match &block.factors {
            Some(factors) => &factors.friction,
            None => &[],
        },
        field,
    };
    let last = s + 1 == plan.substeps.len();
    let touches = near.field.is_some() || !near.active.is_empty();
    let mut deepest = [Depth::default(); LANES];
    std::mem::swap(&mut block.position, &mut block.work.previous);
    let mut before = ZERO3;
    let mut was_before = &ZERO3;
    // The guide beyond a point follows its displacement by contacts and lengths as its stiffness demands.
    // Otherwise a stiff guide on a shoulder would be bent there in every substep, and the shoulder would do
    // work on it.
    let (mut moved, mut moved_before) = (ZERO3, ZERO3);
    for i in 0..count {
        let (was, wanted) = (&block.work.previous[i], &block.work.next[i]);
        let mut placed = *wanted;
        if i >= plan.first_free.max(1) && link_length != LinkLength::FollowLeader {
            let shift = block.bending.follow(i - 1, &moved_before, &moved);
            for k in 0..LANES {
                let p = at(&placed, k) + at(&shift, k);
                put(&mut placed, k, p);
            }
        }
        if i >= plan.first_free.max(1) {
            let (inv, mut length) = (&block.rest.inv_length[i], block.rest.length[i]);
            if link_length == LinkLength::Current {
                for k in 0..LANES {
                    length[k] = (at(&placed, k) - at(&before, k)).length_squared().sqrt();
                }
            }
            let mut fallback = ZERO3;
            for k in 0..LANES {
                put(&mut fallback, k, (at(was, k) - at(was_before, k)) * inv[k]);
            }
            let planes = &mut block.work.planes[i];
            let result =
                place_point(i, &before, &placed, was, &fallback, &length, &near, &plan.rules, planes);
            placed = result.placed;
            if result.touched {
                let mut contact_push = block.contact_push[i];
                for k in 0..LANES {
                    let push = at(&placed, k) - at(&result.free, k);
                    let sum = at(&contact_push, k) + push;
                    put(&mut contact_push, k, choose(push.length_squared() > 0.0, sum, Vec3::ZERO));
                }
                block.contact_push[i] = contact_push;
            } else if block.has_contact_push {
                block.contact_push[i] = ZERO3;
            }
            if last && result.touched {
                let found = penetration(i, &placed, &near, &plan.rules, planes);
                for k in 0..LANES {
                    if found.is_unsure[k] && k < block.used {
                        block.outcome.unsure += 1;
                        block.outcome.first_unsure.get_or_insert((block.guides[k], i as u32));
                    }
                    if found.depth[k] > deepest[k].metres {
                        deepest[k] =
                            Depth { metres: found.depth[k], point: i as u32, collider: found.collider[k] };
                    }
                }
            }
        }
        moved_before = moved;
        let mut velocity = ZERO3;
        for k in 0..LANES {
            let p = at(&placed, k);
            put(&mut moved, k, p - at(wanted, k));
            put(&mut velocity, k, (p - at(was, k)) * inv_h);
        }
        block.position[i] = placed;
        block.velocity[i] = velocity;
        (before, was_before) = (placed, was);
    }
    block.has_contact_push = touches && block.any_contact_push();
    if touches && link_length == LinkLength::Rest {
        remove_bounces(block, plan, s);
        limit_energy(block, plan, s);
    }
    std::mem::swap(&mut block.bend, &mut block.work.next_bend);
    for (depth, &guide) in deepest.iter().zip(&block.guides).take(block.used) {
        if depth.metres > block.outcome.deepest.metres {
            (block.outcome.deepest, block.outcome.deepest_guide) = (*depth, guide);
        }
    }
}

/// The part of `v`, a velocity relative to the head, that exists only because contacts pushed the point at
/// the velocity `push`. Hair on a body does not bounce off it; hair that already moves outward keeps its
/// velocity.
#[inline(always)]
fn bounce(v: Vec3, push: Vec3) -> Vec3 {
    let (out, size) = direction_or(push, Vec3::ZERO);
    out * greater(0.0, lesser(v.dot(out), size))
}

/// Removes the [`bounce`] from the velocities.
#[inline(always)]
fn remove_bounces(block: &mut Block, plan: &Plan, s: usize) {
    let (substep, inv_h) = (&plan.substeps[s], 1.0 / plan.h);
    for i in 0..block.points() {
        let (p, was, wanted) = (&block.position[i], &block.work.previous[i], &block.work.next[i]);
        let mut velocity = block.velocity[i];
        for k in 0..LANES {
            let (push, v) = (at(p, k) - at(wanted, k), at(&velocity, k));
            let off = bounce(v - substep.rigid_velocity(at(was, k)), push * inv_h);
            put(&mut velocity, k, v - off);
        }
        block.velocity[i] = velocity;
    }
}

/// Removes the kinetic energy that the placement pass has added to a guide.
///
/// Contacts and lengths do no work in the head's frame, yet a push-out drags the rest of the guide along for
/// free: a guide between neck and shoulder would be whipped about for ever. Its velocities relative to the
/// head are scaled so that it has no more energy than before the pass. Where the pass has removed energy,
/// nothing is done.
#[inline(always)]
fn limit_energy(block: &mut Block, plan: &Plan, s: usize) {
    let (substep, inv_h) = (&plan.substeps[s], 1.0 / plan.h);
    let (mut before, mut after) = (ZERO, ZERO);
    for i in plan.first_free.max(1)..block.points() {
        let (x, wanted, v) = (&block.position[i], &block.work.next[i], &block.velocity[i]);
        for k in 0..LANES {
            let p = at(x, k);
            let own = at(v, k) - substep.rigid_velocity(p);
            let free = own + (at(wanted, k) - p) * inv_h;
            before[k] += free.length_squared();
            after[k] += own.length_squared();
        }
    }
    let mut keep = Lane::splat(1.0);
    for k in 0..LANES {
        // Guides that are not finite are reset at the end of the step.
        if after[k] > before[k] {
            keep[k] = (before[k] / after[k]).sqrt();
        }
    }
    for i in plan.first_free.max(1)..block.points() {
        let x = &block.position[i];
        let mut v = block.velocity[i];
        for k in 0..LANES {
            let head = substep.rigid_velocity(at(x, k));
            let kept = head + (at(&v, k) - head) * keep[k];
            put(&mut v, k, kept);
        }
        block.velocity[i] = v;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pushed_out_points_do_not_bounce() {
        let push = Vec3::new(0.0, 2.0, 0.0);
        // Points that came in slower than they were pushed, as fast, faster, and already on their way out.
        for (came, left) in [(-1.0, 0.0), (-2.0, 0.0), (-3.0, -1.0), (0.5, 0.5)] {
            let v = Vec3::new(0.7, came, 0.0) + push;
            assert_eq!(v - bounce(v, push), Vec3::new(0.7, left, 0.0), "{came}");
        }
        assert_eq!(bounce(Vec3::ONE, Vec3::ZERO), Vec3::ZERO, "where nothing pushes, nothing is lost");
    }
}
