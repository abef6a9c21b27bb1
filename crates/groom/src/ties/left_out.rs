//! Hair that a tie is to gather but that is too short to reach it.
//!
//! What it lay on is gathered, so it would stand in the air in the shape of the fuller style. It lies on the head instead, as high as
//! gathered hair does, and hangs down from where it leaves the head.

use glam::Vec3;
use lovelock_base::numbers::smoothstep;
use rayon::prelude::*;

use super::route::Ring;
use super::{HairTie, lay, root_of};
use crate::{Hairstyle, Obstacle, Wisp};

/// Hair with roots up to this far away carries a wisp, metres.
const CARRIES: f32 = 0.06;
/// The share of that hair that is gathered from which on a wisp is moved, and from which on it lies on the head wholly.
const GATHERED: [f32; 2] = [0.02, 0.2];
/// Hair that is nowhere further above the gathered hair than this stays as it is, metres.
const LIES: f32 = 0.002;
/// Distance over which hair bends from one direction to another, metres.
const BEND: f32 = 0.016;
/// Distance from the root over which hair keeps the direction in which it is combed, metres.
const COMBED: f32 = 0.06;
/// Hair that is further above the head than the first distance is drawn to it less, and from the second on not at all, metres.
const NEAR: [f32; 2] = [0.02, 0.035];

/// A wisp that a tie includes and cannot gather.
pub(super) struct LeftOut {
    pub(super) wisp: usize,
    /// The ring of that tie.
    pub(super) ring: usize,
}

/// The guides of the wisps `left`, as they lie when those in `is_tied` are gathered: each wisp that moves with the points of its
/// guides, head space.
pub(super) fn lain(
    style: &Hairstyle,
    left: &[LeftOut],
    is_tied: &[bool],
    rings: &[Ring],
    obstacle: &dyn Obstacle,
) -> Vec<(usize, [Vec<Vec3>; 3])> {
    let roots: Vec<Vec3> = style.wisps.iter().map(|wisp| root_of(style, wisp)).collect();
    let share_moved = |of: usize| {
        let near = (0..roots.len()).filter(|w| *w != of && roots[*w].distance(roots[of]) < CARRIES);
        let count = |(all, tied): (u32, u32), w: usize| (all + 1, tied + u32::from(is_tied[w]));
        let (all, tied) = near.fold((0, 0), count);
        smoothstep(GATHERED[0], GATHERED[1], tied as f32 / all.max(1) as f32)
    };
    let lie = |of: &LeftOut| {
        let amount = share_moved(of.wisp);
        if amount <= 0.0 {
            return None;
        }
        let guides = guides(style, &style.wisps[of.wisp], amount, &rings[of.ring].tie, obstacle)?;
        guides.iter().flatten().all(|p| p.is_finite()).then_some((of.wisp, guides))
    };
    left.par_iter().filter_map(lie).collect()
}

/// The guides of a wisp with unchanged links, beside its new path as they were beside its old one; `None` if they lie already.
fn guides(
    style: &Hairstyle,
    wisp: &Wisp,
    amount: f32,
    tie: &HairTie,
    obstacle: &dyn Obstacle,
) -> Option<[Vec<Vec3>; 3]> {
    let guides = wisp.guides.map(|g| g as usize);
    let points = style.guides.points_per_guide;
    let link =
        |guide: usize, i: usize| style.guides.point(guide, i).distance(style.guides.point(guide, i - 1));
    let mean = |i: usize| guides.iter().map(|&g| style.guides.point(g, i)).sum::<Vec3>() / 3.0;
    let middle: Vec<Vec3> = (0..points).map(mean).collect();
    let links: Vec<f32> =
        (1..points).map(|i| guides.iter().map(|&g| link(g, i)).sum::<f32>() / 3.0).collect();
    let way = path(&middle, &links, amount, tie, obstacle)?;
    let lay_guide = |guide: usize| {
        let mut out = vec![style.guides.point(guide, 0)];
        let (mut along, mut come) = (Vec3::NEG_Y, 0.0_f32);
        for i in 1..points {
            let (from, own) = (out[i - 1], link(guide, i));
            come += own;
            let target = way[i] + (style.guides.point(guide, i) - middle[i]);
            along = (target - from).normalize_or(along);
            let (p, turned) = lay::outside(from, along, own, 0.0015_f32.min(0.3 * come), obstacle);
            along = turned;
            out.push(p);
        }
        out
    };
    Some(guides.map(lay_guide))
}

/// The path of the middle of a wisp, which was `middle` with the links `links`; `None` if it lies on the head already. It is `middle`
/// for an `amount` of 0.
fn path(
    middle: &[Vec3],
    links: &[f32],
    amount: f32,
    tie: &HairTie,
    obstacle: &dyn Obstacle,
) -> Option<Vec<Vec3>> {
    let mut p = middle[0];
    let mut way = vec![p];
    let mut direction = (middle[1] - middle[0]).normalize_or(Vec3::NEG_Y);
    let (mut distance, mut n) = obstacle.distance(p);
    let (mut arc, mut wanted, mut lifted) = (0.0_f32, 0.0_f32, 0.0_f32);
    for (i, &link) in links.iter().enumerate() {
        let above = distance - wanted;
        let own = (middle[i + 1] - middle[i]).normalize_or(direction);
        let flat = own - n * own.dot(n).max(0.0);
        let combed = (-arc / COMBED).exp();
        // Near the hair below, gravity pulls along its surface; clear of it, straight down.
        let free = smoothstep(0.0, 0.02, above);
        let down = Vec3::NEG_Y;
        let pull = down - n * (down.dot(n) * (1.0 - free)).min(0.0);
        // Below jaw and chin there is nothing to lie on.
        let lies =
            smoothstep(0.0, 0.01, above) * smoothstep(NEAR[1], NEAR[0], above) * smoothstep(-0.9, -0.5, n.y);
        let wish = flat * combed + pull * (1.05 - combed) + direction * 0.35 - n * (0.8 * lies);
        let wish = wish.normalize_or(direction);
        direction = direction.lerp(wish, 1.0 - (-link / BEND).exp()).normalize_or(wish);
        // Hair that has come down far enough goes no further inward, and rises if it is too low.
        let inward = direction.dot(n).min(0.0) * (1.0 - smoothstep(0.0, 0.004, above));
        let rise = 0.35 * (-above / 0.012).clamp(0.0, 0.9);
        direction = (direction + n * (rise - inward)).normalize_or(direction);
        p += own.lerp(direction, amount).normalize_or(direction) * link;
        arc += link;

        let before = obstacle.distance(middle[i + 1]).0;
        let lying = lay::height(tie, 1.0, arc);
        lifted = lifted.max(before - lying);
        wanted = lying.min(before.max(0.0));
        (distance, n) = obstacle.distance(p);
        if distance < 0.5 * wanted {
            p += n * (0.5 * wanted - distance);
            (distance, n) = obstacle.distance(p);
        }
        way.push(p);
    }
    (lifted > LIES).then_some(way)
}
