//! The middle of a cord.

use glam::Vec3;
use lovelock_groom::Bounded;
use lovelock_groom::Obstacle;
use lovelock_groom::polyline::sample;

use super::Member;
use crate::Scope;
use crate::guides::frames;

/// Distance between points of a line, metres.
const STEP: f32 = 0.005;
/// The longest line, points.
const MAX: usize = 2000;
/// Length over which a line moves away from the body, metres.
const LEAVES: f32 = 0.03;
/// Rounds of smoothing.
const SMOOTHINGS: usize = 8;

/// A line with a frame that turns as little as possible along it.
pub struct Line {
    points: Vec<Vec3>,
    /// To the side, and toward the head, at each point.
    frames: Vec<(Vec3, Vec3)>,
}

impl Line {
    /// The mean of wisps from their starts, away from the body by `clear` metres.
    pub fn of(members: &[Member], means: &[Vec<Vec3>], scope: &Scope<'_>, clear: f32) -> Self {
        let point = |m: &Member, metres: f32| sample(&means[m.wisp], m.start + metres / m.link);
        let beyond = |m: &Member| (m.links - m.start) * m.link;
        let longest = members.iter().map(beyond).fold(0.0, f32::max);
        let start = members.iter().map(|m| point(m, 0.0)).sum::<Vec3>() / members.len() as f32;
        let mut points = vec![start];
        let mut direction = Vec3::NEG_Y;
        let steps = ((longest / STEP).ceil() as usize).clamp(2, MAX);
        for i in 0..steps {
            let from = i as f32 * STEP;
            let there = members.iter().filter(|m| beyond(m) >= from + STEP);
            let sum: Vec3 = there.map(|m| point(m, from + STEP) - point(m, from)).sum();
            direction = sum.normalize_or(direction);
            points.push(points[i] + direction * STEP);
        }
        let obstacle = Bounded(scope.obstacle);
        let push = |i: usize, p: Vec3| {
            let (distance, normal) = obstacle.distance(p);
            let wanted = clear * (i as f32 * STEP / LEAVES).min(1.0);
            p + normal * (wanted - distance).max(0.0)
        };
        for (i, p) in points.iter_mut().enumerate().skip(1) {
            *p = push(i, *p);
        }
        for _ in 0..SMOOTHINGS {
            let before = points.clone();
            for i in 1..points.len() - 1 {
                points[i] = 0.5 * before[i] + 0.25 * (before[i - 1] + before[i + 1]);
            }
        }
        for (i, p) in points.iter_mut().enumerate().skip(1) {
            *p = push(i, *p);
        }
        let points = spaced(&points);
        let frames = frames(&points, start - scope.head.middle);
        Self { points, frames }
    }

    /// The point at a distance from the start, metres; the ends are extended.
    pub fn at(&self, metres: f32) -> Vec3 {
        if metres < 0.0 {
            return self.points[0] + (self.points[1] - self.points[0]) * (metres / STEP);
        }
        sample(&self.points, metres / STEP)
    }

    /// Directions to the side and toward the head at a distance from the start.
    pub fn frame(&self, metres: f32) -> (Vec3, Vec3) {
        let at = (metres / STEP).clamp(0.0, (self.points.len() - 1) as f32);
        let i = (at as usize).min(self.points.len() - 2);
        let (a, b, t) = (self.frames[i], self.frames[i + 1], at - i as f32);
        (a.0.lerp(b.0, t).normalize_or(a.0), a.1.lerp(b.1, t).normalize_or(a.1))
    }

    /// The distance from the start of the point of the line nearest to `p`, searched from `low` to `high` metres.
    pub fn nearest(&self, p: Vec3, low: f32, high: f32) -> f32 {
        const SAMPLES: usize = 16;
        let (mut low, mut high) = (low, high.max(low));
        for _ in 0..2 {
            let step = (high - low) / SAMPLES as f32;
            let away = |k: usize| self.at(low + k as f32 * step).distance_squared(p);
            let best = (0..=SAMPLES).min_by(|&a, &b| away(a).total_cmp(&away(b))).unwrap_or(0);
            (low, high) = (low + (best as f32 - 1.0) * step, low + (best as f32 + 1.0) * step);
        }
        0.5 * (low + high)
    }
}

/// A polyline with points [`STEP`] apart.
fn spaced(points: &[Vec3]) -> Vec<Vec3> {
    let mut out = vec![points[0]];
    let mut left = STEP;
    for pair in points.windows(2) {
        let length = pair[0].distance(pair[1]);
        let mut at = left;
        while at <= length && out.len() < 2 * MAX {
            out.push(pair[0].lerp(pair[1], at / length));
            at += STEP;
        }
        left = at - length;
    }
    let last = points[points.len() - 1];
    let direction = (last - points[points.len() - 2]).normalize_or(Vec3::NEG_Y);
    while out.len() < 3 {
        out.push(out[out.len() - 1] + direction * STEP);
    }
    out
}
