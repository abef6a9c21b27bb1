//! Traces the path of one wisp: off the scalp at an angle, over the head as it is combed, and down.

use glam::Vec3;

use super::cells::Cell;
use super::comb::Comb;
use crate::{GroomSettings, Obstacle};
use lovelock_base::numbers::smoothstep;
use lovelock_base::random::SplitMix64;

/// Distance between the points of a path, metres.
const STEP: f32 = 0.004;
/// Distance over which hair bends from one direction to another, metres.
const BEND: f32 = 0.022;

/// The centre line of a wisp from the root, as points `step` metres apart.
pub(super) struct Path {
    /// Distance between points, metres.
    pub step: f32,
    /// Points, head space, metres.
    pub points: Vec<Vec3>,
    /// Direction at each point, unit.
    pub directions: Vec<Vec3>,
}

impl Path {
    /// Position and direction at `arc` metres from the root.
    pub(super) fn at(&self, arc: f32) -> (Vec3, Vec3) {
        let u = (arc / self.step).clamp(0.0, (self.points.len() - 1) as f32);
        let i = (u as usize).min(self.points.len() - 2);
        let t = u - i as f32;
        let direction = self.directions[i].lerp(self.directions[i + 1], t);
        (self.points[i].lerp(self.points[i + 1], t), direction.normalize_or(self.directions[i]))
    }
}

/// The distance from the skin, at `p` on the head, of hair that has come `arc` metres from its root.
///
/// Hair that has come far lies above hair that is rooted here, so the thickness grows with the distance from the root.
pub(super) fn height(settings: &GroomSettings, comb: &Comb, loft: f32, arc: f32, p: Vec3, n: Vec3) -> f32 {
    let arc = arc.max(0.0);
    let body = settings.volume * loft;
    // The first part rises at the root's angle, the second slowly, as more and more roots lie underneath.
    let lift = 0.2 * body + 0.003;
    let near = lift * (1.0 - (-arc * settings.root_lift.tan() / lift).exp());
    let q = (p - comb.centre) / comb.half;
    let on_top = smoothstep(0.1, 0.9, q.y) * smoothstep(0.0, 0.8, n.y);
    let gain = 0.042 / settings.root_lift.tan();
    let far = 0.8 * body * (1.0 - 0.75 * on_top) * (1.0 - (-arc / gain).exp());
    let behind = 0.35 + 0.65 * smoothstep(0.5, -0.3, q.z);
    let crown = settings.crown_volume * on_top * behind * (1.0 - (-arc / 0.02).exp());
    // On neck and shoulders hair lies flat.
    let on_head = smoothstep(-1.35, -0.6, q.y);
    near + (far + crown) * on_head + 0.002 * (1.0 - on_head)
}

/// Traces the path of the wisp of `cell`, as far as the longest hair may reach.
pub(super) fn trace(settings: &GroomSettings, comb: &Comb, obstacle: &dyn Obstacle, cell: &Cell) -> Path {
    let mut rng = SplitMix64::of_stream(settings.seed, 0xfa7_0000 + cell.stream);
    let rank = comb.rank(cell.centre.position);
    let loft = (0.45 + 0.55 * rank) * (1.0 + 0.12 * rng.bell().clamp(-2.0, 2.0));
    let veer = 0.10 * rng.bell();
    let steps = (settings.length * 1.1 / STEP).ceil().max(4.0) as usize;

    let root = cell.centre;
    let swept = settings.sweep * comb.frontness(root.position) * (1.0 - cell.fringe);
    let falls = if root.position.z + 0.015 * rng.bell() > comb.centre.z - 0.01 { 1.0 } else { -1.0 };
    let scatter = 0.45 * rng.signed();
    // Hair crosses where it turns, which covers the crown.
    let veer = veer * (1.0 + 5.0 * (-root.position.distance(comb.whorl) / 0.02).exp());
    let flow = comb.flow(root.position, root.normal, cell.side, cell.fringe);
    let flow = (flow + veer * root.normal.cross(flow)).normalize_or(flow);
    let mut direction = flow * settings.root_lift.cos() + root.normal * settings.root_lift.sin();
    let mut p = root.position;
    let mut path = Path { step: STEP, points: vec![p], directions: vec![direction] };
    let (mut distance, mut n) = obstacle.distance(p);
    for step in 1..=steps {
        let arc = step as f32 * STEP;
        let wanted = height(settings, comb, loft, arc, p, n);
        let above = distance - wanted;

        let combed = (-arc / settings.hold).exp();
        let flow = comb.flow(p, n, cell.side, cell.fringe);
        let flow = (flow + veer * n.cross(flow)).normalize_or(flow);
        // Near the hair below, gravity pulls along its surface; clear of it, straight down.
        let free = smoothstep(0.0, 0.025, above);
        let down = Vec3::NEG_Y;
        let pull = down - n * (down.dot(n) * (1.0 - free)).min(0.0);
        let mut wish = flow * (combed * (1.0 - free)) + pull * (1.05 - combed) + 0.35 * direction;
        // Swept front hair stays on its path past the temple.
        wish += Vec3::NEG_Z * (swept * (-arc / 0.16).exp() * smoothstep(0.02, 0.06, arc));
        // Loose hair is pressed to the head; on the body, it falls in front of the shoulder or behind it.
        let q = (p - comb.centre) / comb.half;
        wish -= n * (0.8 * free * smoothstep(-0.9, -0.3, q.y));
        if q.y < -0.8 {
            let (ahead, slope) = obstacle.distance(p + direction * 0.06);
            let lands =
                smoothstep(-0.8, -1.2, q.y) * smoothstep(0.05, 0.01, ahead) * smoothstep(0.1, 0.5, slope.y);
            let aside = Vec3::Z * falls + Vec3::X * scatter;
            wish += (aside - slope * aside.dot(slope)) * (0.9 * lands);
        }
        // Swept hair stays out of the face.
        let before_face = (q.z - 0.3).max(0.0) * smoothstep(0.6, 0.1, q.y) * smoothstep(-1.4, -0.9, q.y);
        wish += Vec3::NEG_Z * (2.5 * before_face * settings.sweep.max(0.0) * (1.0 - cell.fringe));
        let wish = wish.normalize_or(direction);
        direction = direction.lerp(wish, 1.0 - (-STEP / BEND).exp()).normalize_or(wish);
        // Keeps to the desired height: rises if too low, and never moves farther inward.
        if above < 0.004 {
            let inward = direction.dot(n).min(0.0) * (1.0 - smoothstep(0.0, 0.004, above));
            let rise = (-above / 0.012).clamp(0.0, 0.9);
            direction = (direction - n * inward + n * rise * 0.35).normalize_or(direction);
        }
        p += direction * STEP;
        (distance, n) = obstacle.distance(p);
        let least = 0.5 * height(settings, comb, loft, arc, p, n).min(arc * 0.6);
        if distance < least {
            p += n * (least - distance);
            (distance, n) = obstacle.distance(p);
        }
        path.points.push(p);
        path.directions.push(direction);
    }
    path
}
