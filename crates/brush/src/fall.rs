//! Hair that a comb has left in the air and that falls.

use glam::Vec3;
use lovelock_groom::{Bounded, Obstacle};
use lovelock_style::hand::turned_toward;

use crate::chain::{along, directions, lay, lengths};
use lovelock_base::numbers::smoothstep;

/// Steps in which hair falls.
const STEPS: usize = 12;
/// The part of the way to plumb that a link turns at a step.
const PART: f32 = 0.3;
/// Hair that a stroke has lifted by more than the first distance falls, and wholly from the second on, metres.
const LIFTED: [f32; 2] = [0.01, 0.04];
/// Hair may lie on other hair up to this far from the body, metres.
const LIES: f32 = 0.025;

/// How much farther from the body each point is after a change than before it, metres.
pub(crate) fn lifts([before, after]: [&[Vec3]; 2], obstacle: &dyn Obstacle) -> Vec<f32> {
    let distance = |p: &Vec3| Bounded(obstacle).distance(*p).0;
    before.iter().zip(after).map(|(before, after)| distance(after) - distance(before)).collect()
}

/// A guide after the links that a stroke has lifted off the body have turned toward `down`, a unit vector, until they lie on it again or hang.
/// `lifts` is how far the stroke has lifted its points, metres, without what their own motion did; `amount` is 1 for hair that nothing
/// holds, and 0 for hair that stays. `None` if nothing falls.
pub(crate) fn fallen(
    points: &[Vec3],
    lifts: &[f32],
    down: Vec3,
    amount: f32,
    obstacle: &dyn Obstacle,
) -> Option<Vec<Vec3>> {
    let links = lengths(points);
    let distance = |p: &Vec3| Bounded(obstacle).distance(*p).0;
    let lift = |i: usize| lifts.get(i).or(lifts.last()).copied().unwrap_or(0.0);
    let free: Vec<f32> = points.iter().enumerate().map(|(i, p)| (distance(p) - lift(i)).max(LIES)).collect();
    let mut now = points.to_vec();
    let mut falls = false;
    for _ in 0..STEPS {
        let lifted = |(p, free): (&Vec3, &f32)| smoothstep(LIFTED[0], LIFTED[1], distance(p) - free);
        let lifted: Vec<f32> = now.iter().zip(&free).map(lifted).collect();
        let mut turns = false;
        let turned = |(i, way): (usize, Vec3)| {
            let angle = way.angle_between(down) * PART * amount * lifted[i + 1];
            turns |= angle > 1e-3;
            turned_toward(way, down, angle)
        };
        let ways: Vec<Vec3> = directions(&now).into_iter().enumerate().map(turned).collect();
        if !turns {
            break;
        }
        falls = true;
        now = lay(&now, &along(now[0], &ways, &links), &links, obstacle);
    }
    falls.then_some(now)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lovelock_groom::NoObstacle;

    #[test]
    fn only_what_a_comb_has_lifted_falls() {
        let points: Vec<Vec3> = (0..10_u8).map(|i| Vec3::X * (0.01 * f32::from(i))).collect();
        let fall = |lift: f32| fallen(&points, &[lift; 10], Vec3::NEG_Y, 1.0, &NoObstacle);
        assert!(fall(0.0).is_none(), "hair that its own motion has lifted");
        let hanging = fall(0.1).expect("it falls");
        assert!((hanging[9] - hanging[0]).normalize_or_zero().y < -0.9, "{hanging:?}");
    }
}
