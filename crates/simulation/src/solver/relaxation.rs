//! Relaxation of one link after the other: the integrator of the published hair.
//!
//! Points move freely. Each link that is too long or too short then displaces both ends along its direction
//! by halves, which conserves the momentum of the pair, and sweeps along the chain repeat this (van Overveld
//! 1991, known from its use in Bertails, Ménier and Cani 2005; today called a Gauss-Seidel projection of
//! positions). A sweep carries an error only one link against its direction, so sweeps alternate between root
//! to tip and tip to root.

use super::Plan;
use crate::lanes::{LANES, Lane, Lane3, at, put};

/// Relaxes the links of `position` toward the lengths `length`.
#[inline(always)]
pub(crate) fn relax(plan: &Plan, length: &[Lane], position: &mut [Lane3]) {
    sweep(plan.first_free, plan.settings.relaxation_sweeps, length, position);
}

#[inline(always)]
fn sweep(first_free: usize, sweeps: u32, length: &[Lane], position: &mut [Lane3]) {
    let (first, count) = (first_free.max(1), position.len());
    for n in 0..sweeps {
        if n % 2 == 0 {
            for i in first..count {
                restore_link(i > first_free, i, &length[i], position);
            }
        } else {
            for i in (first..count).rev() {
                restore_link(i > first_free, i, &length[i], position);
            }
        }
    }
}

/// Displaces the ends of the link that ends at point `i`; the first end only if it is `free`.
#[inline(always)]
fn restore_link(free: bool, i: usize, length: &Lane, position: &mut [Lane3]) {
    let (mut a, mut b) = (position[i - 1], position[i]);
    let (move_a, move_b) = if free { (0.5, 0.5) } else { (0.0, 1.0) };
    for k in 0..LANES {
        let link = at(&b, k) - at(&a, k);
        let now = link.length_squared().sqrt();
        let by = link * ((length[k] - now) / (now + 1e-20));
        let (pa, pb) = (at(&a, k) - by * move_a, at(&b, k) + by * move_b);
        put(&mut a, k, pa);
        put(&mut b, k, pb);
    }
    position[i - 1] = a;
    position[i] = b;
}

#[cfg(test)]
mod tests {
    use glam::Vec3;

    use super::*;
    use crate::lanes::{ZERO, ZERO3};

    /// A straight chain of 12 points along X, 1 cm apart, with its last point 3 cm further out.
    fn pulled() -> (Vec<Lane>, Vec<Lane3>) {
        let mut rows = vec![ZERO3; 12];
        for (i, row) in rows.iter_mut().enumerate() {
            for k in 0..LANES {
                let far = if i == 11 { 0.03 } else { 0.0 };
                put(row, k, Vec3::new(0.01 * i as f32 + far, 0.001 * (i % 2) as f32, 0.0));
            }
        }
        let mut length = vec![Lane::splat(0.01); 12];
        length[0] = ZERO;
        (length, rows)
    }

    fn worst(length: &[Lane], x: &[Lane3]) -> f32 {
        (1..x.len())
            .map(|i| ((at(&x[i], 5) - at(&x[i - 1], 5)).length() / length[i][5] - 1.0).abs())
            .fold(0.0, f32::max)
    }

    #[test]
    fn more_sweeps_leave_less_stretch() {
        let after = |sweeps: u32| {
            let (length, mut x) = pulled();
            sweep(1, sweeps, &length, &mut x);
            worst(&length, &x)
        };
        let (none, four, twenty, all) = (after(0), after(4), after(20), after(200));
        assert!(none > 2.0 && four < none && twenty < four && all < twenty, "{none} {four} {twenty} {all}");
        assert!(twenty > 0.01, "a chain of eleven links is not restored by twenty sweeps: {twenty}");
    }

    #[test]
    fn a_free_chain_keeps_its_centre_and_a_held_one_its_root() {
        let centre = |x: &[Lane3]| x.iter().fold(Vec3::ZERO, |s, row| s + at(row, 2)) / 12.0;
        let (length, mut x) = pulled();
        let before = centre(&x);
        sweep(0, 20, &length, &mut x);
        // Twenty sweeps of eleven links, each rounding positions of 0.1 m to 7e-9.
        assert!((centre(&x) - before).length() < 1e-6, "{before} became {}", centre(&x));
        let (length, mut held) = pulled();
        let root = held[0];
        sweep(1, 20, &length, &mut held);
        assert_eq!(held[0], root);
        assert!((centre(&held) - before).length() > 1e-4, "a chain that is held is pulled back");
    }
}
