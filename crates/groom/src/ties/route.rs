//! Paths of a wisp's centre: over the head to the tie, and beyond it.

use glam::{Quat, Vec3};
use lovelock_base::settings::Settings;

use super::HairTie;
use crate::Obstacle;

/// Distance between the points of a path, metres.
pub(super) const STEP: f32 = 0.003;
/// Points of the path over the head while it is tightened.
const KNOTS: usize = 28;
/// Iterations of tightening.
const PULLS: usize = 90;
/// Half the thickness of a bun's rope, in radii of the bun.
const ROPE: f32 = 0.36;
/// Angle around the axis over which the rope climbs from the rim of a bun to its top, and the height of the top as a
/// latitude; radians.
const CLIMB: f32 = 9.0;
const STEEPEST: f32 = 0.9;
/// Length at the end of a bun's hair that is drawn toward its core, metres, and how far it is drawn, as a fraction.
const TUCK: f32 = 0.08;
const TUCKED: f32 = 0.55;
/// How much longer paths are than the longest of a wisp's guides, metres.
pub(super) const SPARE: f32 = 0.05;
/// Length over which a tail that leaves its tie bends toward gravity, metres.
const FALL: f32 = 0.04;

/// A prepared tie, with what all its hair has in common.
pub(super) struct Ring {
    pub(super) tie: HairTie,
    pub(super) centre: Vec3,
    pub(super) axis: Vec3,
    /// Two directions perpendicular to the axis.
    pub(super) across: [Vec3; 2],
    /// The centre of the tail from the ring on and its direction, every [`STEP`].
    tail: Vec<(Vec3, Vec3)>,
    /// The perpendicular directions at each of its points.
    tail_across: Vec<[Vec3; 2]>,
}

impl Ring {
    /// `longest` is the length of the tail, metres.
    pub(super) fn new(tie: &HairTie, obstacle: &dyn Obstacle, longest: f32) -> Self {
        let tie = tie.clamped();
        let axis = tie.axis.normalize_or(Vec3::NEG_Z);
        let mut centre = tie.at;
        for _ in 0..16 {
            let (distance, n) = obstacle.distance(centre);
            let lies = n.dot(axis).clamp(-1.0, 1.0);
            let clear = 0.006 + tie.radius * (1.0 - lies * lies).sqrt();
            if distance >= clear {
                break;
            }
            centre += n * (clear - distance);
        }
        let (a, b) = axis.any_orthonormal_pair();
        let mut ring = Self { tie, centre, axis, across: [a, b], tail: Vec::new(), tail_across: Vec::new() };
        ring.hang(obstacle, longest);
        ring
    }

    /// Traces the centre of the tail: out along the axis, then down, and around the body.
    fn hang(&mut self, obstacle: &dyn Obstacle, longest: f32) {
        let (mut p, mut direction, mut across) = (self.centre, self.axis, self.across);
        let steps = (longest / STEP).ceil().clamp(2.0, 2000.0) as usize;
        for step in 0..=steps {
            self.tail.push((p, direction));
            self.tail_across.push(across);
            let before = direction;
            let arc = step as f32 * STEP;
            // A tail is stiff where it is bound.
            let yields = (arc / 0.02).min(1.0) * (1.0 - (-STEP / FALL).exp());
            direction = direction.lerp(Vec3::NEG_Y, yields).normalize_or(direction);
            let next = p + direction * STEP;
            let (distance, n) = obstacle.distance(next);
            let clear = 0.003 + self.tie.radius * self.spread(arc);
            let pushed = next + n * ((clear - distance).max(0.0) * (arc / 0.03).min(1.0)).min(0.8 * STEP);
            direction = (pushed - p).normalize_or(direction);
            p += direction * STEP;
            let turn = Quat::from_rotation_arc(before, direction);
            across = across.map(|v| turn * v);
        }
    }

    /// The width of the tail, in radii of the ring, `arc` metres beyond it.
    pub(super) fn spread(&self, arc: f32) -> f32 {
        let t = (arc / 0.07).clamp(0.0, 1.0);
        let end = (self.tail.len().max(1) as f32 * STEP).max(0.05);
        let narrows = (arc / end).clamp(0.0, 1.0);
        (1.0 + 0.9 * t * t * (3.0 - 2.0 * t)) * (1.0 - 0.45 * narrows * narrows)
    }

    /// The point of the tail `arc` metres beyond the ring at the position `disc` in its cross-section, where the ring's
    /// opening is the unit disc.
    fn tail_at(&self, arc: f32, disc: [f32; 2]) -> Vec3 {
        let u = (arc / STEP).max(0.0);
        let i = (u as usize).min(self.tail.len() - 2);
        let t = u - i as f32;
        let ((p, _), (q, _)) = (self.tail[i], self.tail[i + 1]);
        let across = |k: usize| self.tail_across[i][k].lerp(self.tail_across[i + 1][k], t.min(1.0));
        let wide = self.tie.radius * self.spread(arc);
        p + (q - p) * t + (across(0) * disc[0] + across(1) * disc[1]) * wide
    }

    /// The point of a bun `angle` radians along the rope that is wound around the axis, up over a dome and down again.
    fn coil_at(&self, angle: f32, disc: [f32; 2]) -> Vec3 {
        let thick = ROPE * self.tie.bun_radius;
        let wide = self.tie.bun_radius - thick;
        // It leaves the ring and reaches its circle within a third of a turn.
        let t = (angle / 2.1).clamp(0.0, 1.0);
        let out = t * t * (3.0 - 2.0 * t);
        let [a, b] = self.across;
        let (around, ahead) = (a * angle.cos() + b * angle.sin(), angle / self.tie.bun_coils);
        let radius = self.tie.radius + (thick - self.tie.radius) * out;
        // The rope twists as it goes around.
        let (sin, cos) = ahead.sin_cos();
        let turned = [disc[0] * cos - disc[1] * sin, disc[0] * sin + disc[1] * cos];
        // Back and forth between the rim of the dome and its top.
        let way = (angle / CLIMB).rem_euclid(2.0);
        let (up, level) = (STEEPEST * way.min(2.0 - way)).sin_cos();
        let out_of_axis = around * (wide * level * out);
        let middle = self.centre + out_of_axis + self.axis * ((0.5 * thick + wide * up) * out);
        let at_ring = self.across[0] * disc[0] + self.across[1] * disc[1];
        let in_rope = around * turned[0] + self.axis * turned[1];
        middle + at_ring.lerp(in_rope, out) * radius
    }

    /// The path beyond the ring of hair at the position `disc`, `length` metres long, in steps of about [`STEP`].
    pub(super) fn beyond(&self, disc: [f32; 2], length: f32) -> Vec<Vec3> {
        let steps = (length / STEP).ceil().clamp(1.0, 2000.0) as usize;
        match self.tie.kind {
            super::TieKind::Ponytail => (1..=steps).map(|i| self.tail_at(i as f32 * STEP, disc)).collect(),
            super::TieKind::Bun => {
                let mut angle = 0.0_f32;
                let mut out = Vec::with_capacity(steps);
                let mut p = self.coil_at(0.0, disc);
                // Ends are tucked in, where pins would hold them.
                let core = self.centre + self.axis * (ROPE * self.tie.bun_radius);
                for step in 0..steps {
                    // The angle that gives one step, from the speed of the point at this angle.
                    let speed = (self.coil_at(angle + 0.02, disc) - p).length() / 0.02;
                    angle += (STEP / speed.max(1e-3)).min(0.3);
                    p = self.coil_at(angle, disc);
                    let left = (steps - step) as f32 * STEP - SPARE;
                    let tucked = (1.0 - left / TUCK).clamp(0.0, 1.0);
                    out.push(p.lerp(core, TUCKED * tucked * tucked));
                }
                out
            }
        }
    }

    /// The tightened path from `root` over the head to `end`: points about [`STEP`] apart, including both ends.
    ///
    /// `middle` is a point deep in the head; `height(arc)` is the height above the skin of hair that has come `arc`
    /// metres.
    pub(super) fn over_head(
        obstacle: &dyn Obstacle,
        middle: Vec3,
        root: Vec3,
        end: Vec3,
        height: &dyn Fn(f32) -> f32,
    ) -> Vec<Vec3> {
        // Starts around the head by way of the top; tightening then finds the shortest path from there.
        let (from, to) = ((root - middle).normalize_or(Vec3::Y), (end - middle).normalize_or(Vec3::NEG_Z));
        let via = (from + to + Vec3::Y * 0.5).normalize_or(Vec3::Y);
        let reach = [(root - middle).length(), (end - middle).length()];
        let mut knots: Vec<Vec3> = (0..KNOTS)
            .map(|i| {
                let t = i as f32 / (KNOTS - 1) as f32;
                let d = if t < 0.5 { arc(from, via, 2.0 * t) } else { arc(via, to, 2.0 * t - 1.0) };
                middle + d * (reach[0] + (reach[1] - reach[0]) * t)
            })
            .collect();
        (knots[0], knots[KNOTS - 1]) = (root, end);
        for _ in 0..PULLS {
            let mut come = 0.0;
            for i in 1..KNOTS - 1 {
                let pulled = 0.5 * (knots[i - 1] + knots[i + 1]);
                come += knots[i].distance(knots[i - 1]);
                let mut p = pulled;
                for _ in 0..2 {
                    let (distance, n) = obstacle.distance(p);
                    let short = height(come) - distance;
                    if short <= 0.0 {
                        break;
                    }
                    p += n * short;
                }
                knots[i] = p;
            }
        }
        spaced(&knots)
    }
}

/// The point a fraction `t` of the way from the unit vector `a` to the unit vector `b` along the sphere.
fn arc(a: Vec3, b: Vec3, t: f32) -> Vec3 {
    Quat::IDENTITY.slerp(Quat::from_rotation_arc(a, b), t) * a
}

/// A polyline resampled into segments of about [`STEP`].
fn spaced(knots: &[Vec3]) -> Vec<Vec3> {
    let mut out = vec![knots[0]];
    for pair in knots.windows(2) {
        let pieces = (pair[0].distance(pair[1]) / STEP).ceil().clamp(1.0, 200.0) as usize;
        out.extend((1..=pieces).map(|k| pair[0].lerp(pair[1], k as f32 / pieces as f32)));
    }
    out
}
