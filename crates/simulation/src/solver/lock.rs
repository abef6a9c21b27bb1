//! The three guides of a wisp as one lock.
//!
//! Cohesion bounds the distance of each guide from the middle of its lock. A guide beyond the bound is pulled back
//! with a time constant, so that a lock splits on an obstacle and closes again behind it. Friction inside the lock
//! lets its guides take on each other's velocity. The bound is wider for a lock that moves fast. Contacts
//! come after cohesion and override it, so that an obstacle parts a lock for as long as it is in between.
//! Cohesion and friction keep the momentum of the lock: they add nothing to its mean.

use glam::Vec3;

use super::Plan;
use crate::block::Block;
use crate::lanes::{LANES, Lane, Lane3, ZERO, ZERO3, at, choose, direction_or, greater, lesser, put};
use crate::packing::{LOCK, mean_of_lock};

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

/// The constants of locks by name, for other devices.
pub(crate) const CONSTANTS: [(&str, f64); 5] = [
    ("LOCK_FREE", FREE as f64),
    ("LOCK_LEAST_RADIUS", LEAST_RADIUS as f64),
    ("LOCK_FAST", FAST as f64),
    ("LOCK_LOST", LOST as f64),
    ("LOCK_FASTEST", FASTEST as f64),
];

/// Pulls the guides of each lock to within its bound.
#[inline(always)]
pub(super) fn hold_together(block: &mut Block, plan: &Plan, s: usize) {
    if block.locks == 0 {
        return;
    }
    let (substep, opening) = (&plan.substeps[s], plan.settings.locks.opening);
    for i in plan.first_free.max(1)..block.points() {
        let (radius, p) = (&block.rest.lock_radius[i], &mut block.work.next[i]);
        let middle = mean_of_lock(p);
        let velocity = mean_of_lock(&block.velocity[i]);
        let mut bound = ZERO;
        for k in 0..LANES {
            let relative = at(&velocity, k) - substep.rigid_velocity(at(&middle, k));
            let fast = lesser(relative.length_squared() * (1.0 / (FAST * FAST)), 1.0);
            bound[k] = greater(FREE * radius[k], LEAST_RADIUS) * (1.0 + opening * fast);
        }
        *p = pulled(p, &middle, &bound, plan.rows[i].cohesion, block.locks);
    }
}

/// The guides `p` of the first `locks` locks, each moved by the fraction `share` of its distance beyond `bound` from
/// the `middle` of its lock, less the mean of these movements.
#[inline(always)]
fn pulled(p: &Lane3, middle: &Lane3, bound: &Lane, share: f32, locks: usize) -> Lane3 {
    let mut pull = ZERO3;
    let whole = all_within(p, middle, LOST);
    for k in 0..LANES {
        let (out, distance) = direction_or(at(p, k) - at(middle, k), Vec3::ZERO);
        let held = distance > bound[k] && whole[k] && k < LOCK * locks;
        put(&mut pull, k, choose(held, out * ((bound[k] - distance) * share), Vec3::ZERO));
    }
    let mean = mean_of_lock(&pull);
    let mut out = ZERO3;
    for axis in 0..3 {
        out[axis] = p[axis].plus(pull[axis].minus(mean[axis]));
    }
    out
}

/// For each lane whether all guides of its lock are nearer than `most` to `middle`; not if one of them is not a number.
#[inline(always)]
fn all_within(p: &Lane3, middle: &Lane3, most: f32) -> [bool; LANES] {
    let mut squares = ZERO3;
    for k in 0..LANES {
        squares[0][k] = (at(p, k) - at(middle, k)).length_squared();
    }
    // A mean within a third of the bound has no square beyond it, and NaN stays.
    let mean = mean_of_lock(&squares);
    let mut within = [false; LANES];
    for k in 0..LANES {
        within[k] = mean[0][k] < most * most * (1.0 / LOCK as f32);
    }
    within
}

/// Damps the velocities `v` of the guides of each lock relative to each other, by the fraction `share`.
#[inline(always)]
pub(super) fn rub(locks: usize, share: f32, v: &mut Lane3) {
    let mean = mean_of_lock(v);
    let whole = all_within(v, &mean, FASTEST);
    for k in 0..LANES {
        let relative = at(&mean, k) - at(v, k);
        let rubs = whole[k] && k < LOCK * locks;
        let slower = at(v, k) + choose(rubs, relative * share, Vec3::ZERO);
        put(v, k, slower);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two guides 20 mm from the middle of the first lock, and one 40 mm from it.
    fn split() -> Lane3 {
        let mut p = ZERO3;
        for (k, x) in [(0, -0.02), (1, -0.02), (2, 0.04)] {
            put(&mut p, k, Vec3::new(x, 0.1, 0.0));
        }
        p
    }

    #[test]
    fn a_split_lock_closes_at_its_rate_and_does_not_move_as_a_whole() {
        let (rate, h, bound) = (60.0_f32, 1.0 / 240.0, Lane::splat(0.01));
        let share = 1.0 - (-rate * h).exp();
        let mut p = split();
        for _ in 0..12 {
            p = pulled(&p, &mean_of_lock(&p), &bound, share, 1);
        }
        // All guides lie on a line, 10 and 30 mm beyond the bound, and the mean of the three pulls is taken from each.
        assert!((at(&mean_of_lock(&p), 0) - Vec3::new(0.0, 0.1, 0.0)).length() < 1e-7, "the middle stays");
        let excess = at(&p, 2).x - 0.01;
        let (mut near, mut far) = (0.02_f32, 0.04_f32);
        for _ in 0..12 {
            let pull = [-(near - 0.01).max(0.0) * share, (far - 0.01).max(0.0) * share];
            // Near guides are pulled by +x, the far one by -x.
            let mean = (-2.0 * pull[0] - pull[1]) / 3.0;
            (near, far) = (near + pull[0] + mean, far - pull[1] - mean);
        }
        assert!((excess - (far - 0.01)).abs() < 1e-6, "{excess} against {}", far - 0.01);
        assert!(excess < 0.012, "30 mm before, three time constants of a sixtieth of a second ago: {excess}");
        // Controls: without cohesion, and in lanes that hold no lock.
        assert_eq!(pulled(&split(), &mean_of_lock(&split()), &bound, 0.0, 1), split());
        assert_eq!(pulled(&split(), &mean_of_lock(&split()), &bound, share, 0), split());
    }

    #[test]
    fn an_impulse_on_one_guide_becomes_common_and_is_not_lost() {
        let mut v = ZERO3;
        put(&mut v, 1, Vec3::new(3.0, 0.0, 0.0));
        let (rate, h) = (15.0_f32, 1.0 / 240.0);
        let share = 1.0 - (-rate * h).exp();
        for _ in 0..48 {
            rub(1, share, &mut v);
        }
        // After 0.2 s the difference to the mean of 1 m/s has decayed to e^-3.
        let left = (-rate * 0.2).exp();
        for (k, v0) in [(0, 0.0), (1, 3.0), (2, 0.0)] {
            let want = 1.0 + (v0 - 1.0) * left;
            assert!((at(&v, k).x - want).abs() < 1e-4, "guide {k}: {} against {want}", at(&v, k).x);
        }
        let sum: f32 = (0..3).map(|k| at(&v, k).x).sum();
        assert!((sum - 3.0).abs() < 1e-5, "the momentum stays: {sum}");
        assert_eq!(at(&v, 4), Vec3::ZERO, "the next lock is unchanged");
    }

    #[test]
    fn a_guide_that_is_not_finite_leaves_the_others_alone() {
        let mut p = split();
        put(&mut p, 1, Vec3::NAN);
        let (bound, middle) = (Lane::splat(0.001), mean_of_lock(&p));
        let now = pulled(&p, &middle, &bound, 0.5, 1);
        assert_eq!((at(&now, 0), at(&now, 2)), (at(&p, 0), at(&p, 2)));
        let mut v = p;
        rub(1, 0.5, &mut v);
        assert_eq!((at(&v, 0), at(&v, 2)), (at(&p, 0), at(&p, 2)));
    }
}
