//! The forces of a step, computed once and applied in every substep.

use glam::Vec3;

use super::Plan;
use crate::block::Block;
use crate::grid::GridStep;
use crate::lanes::{LANES, Lane, ZERO, ZERO3, at, direction_or, greater, lesser, put};
use crate::rope;

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
/// Over a substep of `h` seconds settling and the air relax the velocity toward the head's motion and the wind.
#[inline(always)]
pub(crate) fn prepare(block: &mut Block, plan: &Plan) {
    let settings = &plan.settings;
    let substeps = plan.substeps.len() as f32;
    let cohesion = 1.0 - (-settings.repulsion.cohesion * plan.h * substeps).exp();
    let rest = &block.rest;
    if let Some(factors) = &mut block.factors {
        factors.prepare(settings.settle, plan.h);
    }
    let factors = block.factors.as_deref();
    let (link, inv_length, tie_hold) = (&rest.mean_link, &rest.inv_length, &block.tie_hold);
    if block.bending.prepare(plan.bending, link, inv_length, &rest.bend, tie_hold, factors) {
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
        substeps,
        cohesion,
        rows: plan.rows,
        last_head: &plan.last_head,
        head_from_last: &plan.head_from_last,
    };
    if let Some(grid) = plan.grid {
        grid.act(block, &grid_step);
    }
    for i in 0..block.points() {
        let mut position = block.position[i];
        for (axis, shift) in position.iter_mut().zip(plan.rebase.to_array()) {
            for v in axis.iter_mut() {
                *v += shift;
            }
        }
        (block.position[i], block.work.start_pose[i]) = (position, position);
        let (mut push, mut keep) = (block.work.push[i], ZERO);
        if let Some(found) = &block.in_rope {
            rope::rub(found, plan.ropes, i, substeps, &block.velocity[i], &mut push);
        }
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
            keep[k] = kept;
            carried[k] *= inside[k];
        }
        block.work.carried[i] = carried;
        block.work.push[i] = push;
        block.work.keep[i] = keep;
    }
}

/// Speed of the air relative to hair at which its drag is twice that of slow air, metres per second.
const FAST_AIR: f32 = 3.0;

/// The constants of forces by name, for other devices.
pub(crate) const CONSTANTS: [(&str, f64); 3] = [
    ("SUPPORT_FULL", SUPPORT_FADES[0] as f64),
    ("SUPPORT_NONE", SUPPORT_FADES[1] as f64),
    ("FAST_AIR", FAST_AIR as f64),
];

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

#[cfg(test)]
mod tests {
    use super::*;

    const SUPPORT: Vec3 = Vec3::new(0.3, 0.9, -0.1);
    const LENGTH: f32 = 0.4;

    #[test]
    fn the_support_is_the_slope_of_its_potential_and_ends_in_every_direction() {
        let [full, none] = SUPPORT_FADES;
        let potential = |d: Vec3| {
            let t = ((none * LENGTH - d.length()) / ((none - full) * LENGTH)).clamp(0.0, 1.0);
            -SUPPORT.dot(d) * t * t * (3.0 - 2.0 * t)
        };
        for i in 0..200 {
            let angle = i as f32 * 2.4;
            let way = Vec3::new(angle.cos(), (1.3 * angle).sin(), angle.sin()).normalize_or(Vec3::X);
            let d = way * (0.12 * i as f32 / 200.0);
            let (force, share) = faded_support(SUPPORT, d, LENGTH);
            let e = 2e-3;
            let slope = [Vec3::X, Vec3::Y, Vec3::Z]
                .map(|a| (potential(d - a * e) - potential(d + a * e)) / (2.0 * e));
            // Central differences of a function whose third derivative is about 1 / range^2, and rounding.
            assert!((force - Vec3::from_array(slope)).length() < 0.02, "{d}: {force} against {slope:?}");
            assert!((0.0..=1.0).contains(&share));
            if d.length() > none * LENGTH {
                assert_eq!((force, share), (Vec3::ZERO, 0.0), "{d}");
            }
        }
        assert_eq!(faded_support(SUPPORT, Vec3::ZERO, LENGTH), (SUPPORT, 1.0));
        // Control: without the slope of the ramp the force would do work on a closed path.
        let work = |force: &dyn Fn(Vec3) -> Vec3| {
            let at = |n: i32| {
                let a = n as f32 * core::f32::consts::TAU / 2000.0;
                Vec3::new(0.03 + 0.04 * a.cos(), 0.05 * a.sin(), 0.0)
            };
            (0..2000).map(|n| force(0.5 * (at(n) + at(n + 1))).dot(at(n + 1) - at(n))).sum::<f32>()
        };
        let all = work(&|d| faded_support(SUPPORT, d, LENGTH).0);
        let faded_alone = work(&|d| SUPPORT * faded_support(SUPPORT, d, LENGTH).1);
        assert!(all.abs() < 1e-5 && faded_alone.abs() > 1e-3, "{all} and {faded_alone}");
    }

    #[test]
    fn a_falling_column_of_hair_reaches_the_speed_at_which_the_air_carries_it() {
        let (h, gravity) = (1.0 / 240.0_f32, 9.81_f32);
        let fall = |rate: f32, sheltered: f32| {
            let mut v = 0.0_f32;
            for _ in 0..5000 {
                v = (v + gravity * h) * kept_in_air(rate * h, Vec3::new(0.0, v, 0.0), sheltered);
            }
            v
        };
        // rate v (1 + v / u) = g, u = FAST_AIR.
        let terminal = |rate: f32| {
            let (a, b) = (rate / FAST_AIR, rate);
            (-b + (b * b + 4.0 * a * gravity).sqrt()) / (2.0 * a)
        };
        for rate in [0.4, 1.2, 5.0] {
            // The drag of a substep is that of its first speed.
            assert!(
                (fall(rate, 0.0) / terminal(rate) - 1.0).abs() < 0.02,
                "{} {}",
                fall(rate, 0.0),
                terminal(rate)
            );
        }
        assert!((fall(1.2, 0.5) / terminal(0.6) - 1.0).abs() < 0.02, "half of the air is kept away");
        assert!(fall(0.0, 0.0) > 200.0, "control: nothing stops it without air");
    }
}
