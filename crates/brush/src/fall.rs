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

/// How far each point is from the body, metres.
pub(crate) fn clearances(points: &[Vec3], obstacle: &dyn Obstacle) -> Vec<f32> {
    points.iter().map(|p| Bounded(obstacle).distance(*p).0).collect()
}

/// A guide after the links that a stroke has lifted off the body have turned toward `down`, a unit vector, until they lie on it again or hang.
/// `before` is how far its points were from the body before the stroke, metres; `amount` is 1 for hair that nothing holds, and 0 for hair
/// that stays. `None` if nothing falls.
pub(crate) fn fallen(
    points: &[Vec3],
    before: &[f32],
    down: Vec3,
    amount: f32,
    obstacle: &dyn Obstacle,
) -> Option<Vec<Vec3>> {
    let links = lengths(points);
    let mut now = points.to_vec();
    let mut falls = false;
    for _ in 0..STEPS {
        let lifted = |(i, p): (usize, &Vec3)| {
            let free = before.get(i).or(before.last()).map_or(LIES, |before| before.max(LIES));
            smoothstep(LIFTED[0], LIFTED[1], Bounded(obstacle).distance(*p).0 - free)
        };
        let lifted: Vec<f32> = now.iter().enumerate().map(lifted).collect();
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
