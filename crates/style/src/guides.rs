//! Changing guides: their points, lengths and the body that they stay out of.

use std::f32::consts::{PI, TAU};

use glam::{Quat, Vec3};
use lovelock_base::numbers::smoothstep;
use lovelock_groom::polyline::{Reach, next_at, sample};
use lovelock_groom::{
    Bounded, Guides, Haircut, Hairstyle, Obstacle, Wisp, WispCurve, transport, trimmed, widest_radii,
};
use rayon::prelude::*;

use crate::Scope;

/// Clearance between the body and guides that had more of it before, metres.
const CLEAR: f32 = 0.003;
/// How far past its end a guide may be laid, in links, and the step of the search.
const REACH: Reach = Reach { beyond: 64.0, step: 0.25 };
/// Distance from the body within which combed hair follows its surface, metres.
const NEAR: f32 = 0.03;
/// How far directions near the body lean sideways on it before they are turned.
const ASIDE: f32 = 0.2;
/// Between these cosines of the angle to the opposite of its direction, a wisp turns more and more about the normal of the scalp.
const OVER: [f32; 2] = [0.2, 0.8];
/// Links shorter than this belong to the cut part of a guide, metres.
const NO_LINK: f32 = 1e-6;

/// What a change of a guide does to its length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lengths {
    /// It stays.
    Keep,
    /// It is that of the changed points.
    Change,
}

/// A guide that an operation changes.
pub struct GuideShape {
    /// Its index.
    pub index: usize,
    /// The wisp that it belongs to; none where no wisp follows it.
    pub wisp: Option<usize>,
    /// [`Scope::at`] its root.
    pub strength: f32,
    /// Its points from the root, without the cut part: two or more.
    pub points: Vec<Vec3>,
    /// Length of each link, metres.
    pub link: f32,
}

impl GuideShape {
    /// The length of the guide, metres.
    pub fn length(&self) -> f32 {
        self.link * (self.points.len() - 1) as f32
    }

    /// The place of a point along the guide: 0 is the root, 1 the tip.
    pub fn place(&self, point: usize) -> f32 {
        point as f32 / (self.points.len() - 1) as f32
    }

    /// Unit direction of the guide at a point.
    pub fn direction(&self, point: usize) -> Vec3 {
        let last = self.points.len() - 1;
        let (a, b) = (self.points[point.saturating_sub(1)], self.points[(point + 1).min(last)]);
        (b - a).normalize_or(Vec3::NEG_Y)
    }
}

/// Turns a direction toward another by an angle and beyond it only if `past`.
pub fn turned(direction: Vec3, toward: Vec3, angle: f32, past: bool) -> Vec3 {
    let Some(axis) = direction.cross(toward).try_normalize() else { return direction };
    let angle = if past { angle } else { angle.min(direction.angle_between(toward)) };
    Quat::from_axis_angle(axis, angle) * direction
}

/// Lays a guide again from its root with other directions of its links: `turn` gets a link's index, the new place of its start and its
/// direction, and returns the new direction.
pub fn turn_links(shape: &mut GuideShape, mut turn: impl FnMut(usize, Vec3, Vec3) -> Vec3) {
    let before = shape.points.clone();
    for i in 0..before.len() - 1 {
        let step = before[i + 1] - before[i];
        let direction = step.normalize_or(Vec3::NEG_Y);
        let at = shape.points[i];
        shape.points[i + 1] = at + turn(i, at, direction).normalize_or(direction) * step.length();
    }
}

/// Combs a guide over the body: its links turn toward `toward`, along the surface where they are near it, by the part `amount` of the
/// way. That fades to nothing at a distance of `metres` from the root. `means` are [`wisp_means`]: the guides of a wisp turn to the same
/// side.
pub fn comb(
    shape: &mut GuideShape,
    scope: &Scope<'_>,
    means: &[Vec<Vec3>],
    toward: Vec3,
    amount: f32,
    metres: f32,
) {
    let obstacle = Bounded(scope.obstacle);
    let (link, strength, last) = (shape.link, shape.strength, (shape.points.len() - 1) as f32);
    let mut moved = false;
    let mean = shape.wisp.map(|wisp| &means[wisp]);
    turn_links(shape, |i, at, direction| {
        let (distance, normal) = obstacle.distance(at);
        let near = 1.0 - (distance / NEAR).clamp(0.0, 1.0);
        let over = |direction: Vec3| direction - normal * (direction.dot(normal).min(0.0) * near);
        let fade = 1.0 - smoothstep(0.5 * metres, metres, i as f32 * link);
        let amount = (amount * fade * strength * scope.along(i as f32 / last)).clamp(0.0, 1.0);
        moved |= amount > 0.0;
        match over(toward).try_normalize() {
            // Hair that is combed the other way turns around on the surface: it neither stands up nor dives into the body.
            Some(along) if amount > 0.0 => {
                let side = normal.cross(along).normalize_or_zero();
                let common = mean.map_or(direction, |mean| mean[i + 1] - mean[i]);
                let side = if common.dot(side) < 0.0 { -side } else { side };
                let from = (direction + side * (ASIDE * near)).normalize_or(direction);
                turned(from, along, amount * from.angle_between(along), false)
            }
            // Further down it goes on as before, but over the body from its new place.
            _ if moved => over(direction),
            _ => direction,
        }
    });
}

/// The mean of the guides of each wisp, point by point.
pub fn wisp_means(style: &Hairstyle) -> Vec<Vec<Vec3>> {
    let point = |guides: [u32; 3], p| guides.map(|g| style.guides.point(g as usize, p)).iter().sum::<Vec3>();
    let mean = |guides| (0..style.guides.points_per_guide).map(|p| point(guides, p) / 3.0).collect();
    style.wisps.iter().map(|wisp| mean(wisp.guides)).collect()
}

/// Two unit directions square to a path at each of its points, carried along it: the first is square to `outward` at its start.
pub fn frames(path: &[Vec3], outward: Vec3) -> Vec<(Vec3, Vec3)> {
    let last = path.len() - 1;
    let mut before = Vec3::ZERO;
    let mut across = Vec3::X;
    let mut out = Vec::with_capacity(path.len());
    for i in 0..=last {
        let (a, b) = (path[i.saturating_sub(1)], path[(i + 1).min(last)]);
        let along = (b - a).normalize_or(if i > 0 { before } else { Vec3::NEG_Y });
        across = if i == 0 {
            along.cross(outward).normalize_or(along.any_orthonormal_vector())
        } else {
            transport(across.into(), before.into(), along.into()).into()
        };
        out.push((across, along.cross(across)));
        before = along;
    }
    out
}

/// Changes every guide on which the layer acts. Roots stay where they are, links become equal again, and hair stays out of the body.
pub fn reshape(
    style: &mut Hairstyle,
    scope: &Scope<'_>,
    lengths: Lengths,
    change: impl Fn(&mut GuideShape) + Sync,
) {
    let strengths = scope.guides(style);
    reshape_where(style, scope, &strengths, lengths, change);
}

/// As [`reshape`], of the guides whose strength is not 0.
pub fn reshape_where(
    style: &mut Hairstyle,
    scope: &Scope<'_>,
    strengths: &[f32],
    lengths: Lengths,
    change: impl Fn(&mut GuideShape) + Sync,
) {
    let wisps = wisp_of_guide(style);
    let guides = &style.guides;
    let obstacle = Bounded(scope.obstacle);
    let changed: Vec<(usize, Vec<Vec3>)> = (0..guides.count())
        .into_par_iter()
        .filter(|&index| strengths[index] != 0.0)
        .filter_map(|index| {
            let mut shape = shape_of(guides, index, strengths[index], wisps[index])?;
            let before = shape.points.clone();
            change(&mut shape);
            shape.points[0] = before[0];
            let finite = shape.points.len() > 1 && shape.points.iter().all(|p| p.is_finite());
            if !finite || shape.points == before {
                return None;
            }
            let link = match lengths {
                Lengths::Keep => shape.link,
                Lengths::Change => length(&shape.points) / (before.len() - 1) as f32,
            };
            Some((index, laid(&shape.points, &before, link, &obstacle)))
        })
        .collect();
    let frames = |guides: &Guides| -> Vec<[Vec3; 3]> {
        style.wisps.iter().map(|wisp| WispCurve::root_frame(guides, wisp)).collect()
    };
    let before = frames(&style.guides);
    let mut guides = std::mem::take(&mut style.guides);
    for (index, points) in changed {
        put(&mut guides, index, &points);
    }
    let after = frames(&guides);
    style.guides = guides;
    let outward = |wisp: &Wisp| {
        let root = wisp.guides.iter().map(|&g| style.guides.point(g as usize, 0)).sum::<Vec3>() / 3.0;
        obstacle.distance(root).1.try_normalize()
    };
    let turns: Vec<f32> = style
        .wisps
        .iter()
        .zip(before.iter().zip(&after))
        .map(|(wisp, (from, to))| if from == to { 0.0 } else { turn_between(from, to, outward(wisp)) })
        .collect();
    turn_offsets(style, &turns);
    widen(style);
}

/// The angle about the root from the frame `to` to the frame `from` of a wisp, carried by the smallest rotation between their directions.
/// That rotation has no definite axis where the directions are opposite, so a wisp that is combed over to the other side turns about
/// `outward`, the normal of the scalp at its root, where that is known.
pub fn turn_between(from: &[Vec3; 3], to: &[Vec3; 3], outward: Option<Vec3>) -> f32 {
    let carried = |normal: Vec3, direction: Vec3| {
        let normal = Vec3::from(transport(normal.into(), direction.into(), to[2].into()));
        normal.dot(to[1]).atan2(normal.dot(to[0]))
    };
    let smallest = carried(from[0], from[2]);
    let part = smoothstep(OVER[0], OVER[1], -from[2].dot(to[2]));
    let about = outward.filter(|_| part > 0.0).and_then(|outward| {
        let flat = |direction: Vec3| direction.reject_from_normalized(outward).try_normalize();
        let (a, b) = (flat(from[2])?, flat(to[2])?);
        let turn = Quat::from_axis_angle(outward, a.cross(b).dot(outward).atan2(a.dot(b)));
        Some(carried(turn * from[0], turn * from[2]))
    });
    let rest = about.map_or(0.0, |about| (about - smallest + PI).rem_euclid(TAU) - PI);
    smallest + rest * part
}

/// Turns the offsets of strands about the roots of their wisps. The axis that a frame is made from changes abruptly with the direction of
/// the root, and strands would jump with it.
fn turn_offsets(style: &mut Hairstyle, turns: &[f32]) {
    let set = &mut style.strands;
    for (wisp, turn) in style.wisps.iter().zip(turns).filter(|(_, turn)| **turn != 0.0) {
        let (sin, cos) = turn.sin_cos();
        let first = set.first_point[wisp.first_strand as usize] as usize;
        let end = set.first_point[(wisp.first_strand + wisp.strand_count) as usize] as usize;
        let normals = set.offset_normal[first..end].iter_mut();
        for (x, y) in normals.zip(&mut set.offset_binormal[first..end]) {
            (*x, *y) = (*x * cos - *y * sin, *x * sin + *y * cos);
        }
    }
}

/// Shortens every guide on which the layer acts to a part of its length, 0 to 1; parts of 1 and more change nothing. What remains keeps
/// its control points, as with scissors.
pub fn shorten(style: &mut Hairstyle, scope: &Scope<'_>, part: impl Fn(&GuideShape) -> f32) {
    let links = (style.guides.points_per_guide - 1) as f32;
    let kept = |(guide, strength): (usize, f32)| {
        let shape = (strength != 0.0).then(|| shape_of(&style.guides, guide, strength, None)).flatten();
        let kept = shape.map(|shape| (part(&shape), shape)).filter(|(part, _)| *part < 1.0);
        kept.map_or(1.0, |(part, shape)| part.max(0.0) * (shape.points.len() - 1) as f32 / links)
    };
    let kept: Vec<f32> = scope.guides(style).into_iter().enumerate().map(kept).collect();
    if kept.iter().any(|kept| *kept < 1.0) {
        *style = trimmed(style, &Haircut { first_root: style.guides.point(0, 0), kept });
    }
}

/// Lets wisps open as far as their new guides need.
pub fn widen(style: &mut Hairstyle) {
    if !style.widest.is_empty() {
        for (widest, now) in style.widest.iter_mut().zip(widest_radii(&style.guides, &style.wisps)) {
            *widest = widest.max(now);
        }
    }
}

/// The wisp of each guide.
pub fn wisp_of_guide(style: &Hairstyle) -> Vec<Option<usize>> {
    let mut out = vec![None; style.guides.count()];
    for (w, wisp) in style.wisps.iter().enumerate() {
        for guide in wisp.guides {
            out[guide as usize] = Some(w);
        }
    }
    out
}

/// One guide without its cut part; `None` if that leaves fewer than two points.
pub fn shape_of(guides: &Guides, index: usize, strength: f32, wisp: Option<usize>) -> Option<GuideShape> {
    let mut points: Vec<Vec3> = (0..guides.points_per_guide).map(|i| guides.point(index, i)).collect();
    let end = points.windows(2).rposition(|pair| pair[0].distance(pair[1]) > NO_LINK)? + 2;
    points.truncate(end);
    let link = length(&points) / (end - 1) as f32;
    (link.is_finite() && link > NO_LINK).then_some(GuideShape { index, wisp, strength, points, link })
}

/// Writes the points of a guide; the rest of its points lie on the last of them.
fn put(guides: &mut Guides, index: usize, points: &[Vec3]) {
    let first = index * guides.points_per_guide;
    for i in 0..guides.points_per_guide {
        let p = points[i.min(points.len() - 1)];
        (guides.x[first + i], guides.y[first + i], guides.z[first + i]) = (p.x, p.y, p.z);
    }
}

/// The length of a polyline.
pub fn length(points: &[Vec3]) -> f32 {
    points.windows(2).map(|pair| pair[0].distance(pair[1])).sum()
}

/// Lengthens a guide by a factor: new hair continues at its end and bends down. A factor below 1 removes hair there.
pub fn lengthen(points: &mut [Vec3], factor: f32) {
    let links = points.len() - 1;
    let link = length(points) / links as f32;
    let mut way = points.to_vec();
    let mut direction = (points[links] - points[links - 1]).normalize_or(Vec3::NEG_Y);
    for _ in 0..((factor - 1.0) * links as f32).ceil() as usize {
        direction = (direction + Vec3::NEG_Y * (link / 0.05).min(1.0)).normalize_or(Vec3::NEG_Y);
        way.push(way[way.len() - 1] + direction * link);
    }
    // As many points as before, at even places of the longer way.
    for (i, point) in points.iter_mut().enumerate() {
        *point = sample(&way, i as f32 * factor);
    }
}

/// Equal links along `target`, as many as `before` has, outside the body as far as those of `before` were.
pub fn laid(target: &[Vec3], before: &[Vec3], link: f32, obstacle: &dyn Obstacle) -> Vec<Vec3> {
    let mut out = Vec::with_capacity(before.len());
    out.push(target[0]);
    let mut at = 0.0;
    for old in &before[1..] {
        let from = out[out.len() - 1];
        at = next_at(target, at, from, link, REACH);
        let mut p = sample(target, at);
        let clear = obstacle.distance(*old).0.clamp(0.0, CLEAR);
        for _ in 0..3 {
            let (distance, normal) = obstacle.distance(p);
            if distance < clear {
                p += normal * (clear - distance);
            }
            p = from + (p - from).normalize_or(*old - from) * link;
        }
        out.push(p);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A frame with the direction `along`.
    fn frame(along: Vec3) -> [Vec3; 3] {
        let (normal, binormal) = along.any_orthonormal_pair();
        [normal, binormal, along]
    }

    /// Where an offset that points along `offset` in the frame `from` points in the frame `to`, as [`turn_offsets`] turns it.
    fn carried(offset: Vec3, from: &[Vec3; 3], to: &[Vec3; 3], outward: Option<Vec3>) -> Vec3 {
        let (sin, cos) = turn_between(from, to, outward).sin_cos();
        let (x, y) = (offset.dot(from[0]), offset.dot(from[1]));
        to[0] * (x * cos - y * sin) + to[1] * (x * sin + y * cos)
    }

    #[test]
    fn hair_that_is_combed_to_the_other_side_keeps_its_outside_out() {
        let outward = Vec3::Y;
        let mut fallen = 0;
        for k in 0..24 {
            // Nearly opposite directions that leave the scalp by some degrees.
            let aside = (k as f32 - 11.5) * 0.02;
            let from = frame(Vec3::new(1.0, 0.15, 0.0).normalize_or_zero());
            let to = frame(Vec3::new(-1.0, 0.05, aside).normalize_or_zero());
            let offset = outward.reject_from_normalized(from[2]).normalize_or_zero();
            assert!(carried(offset, &from, &to, Some(outward)).y > 0.95, "{aside}");
            fallen += usize::from(carried(offset, &from, &to, None).y < 0.5);
            // There and back is where it was.
            let there = carried(offset, &from, &to, Some(outward));
            assert!(carried(there, &to, &from, Some(outward)).distance(offset) < 1e-5);
        }
        assert!(fallen > 6, "the smallest rotation turns it over: {fallen} of 24");
    }

    #[test]
    fn a_turn_of_less_than_a_right_angle_is_the_smallest_rotation() {
        let (from, to) = (frame(Vec3::X), frame(Vec3::new(0.3, 0.5, 0.7).normalize_or_zero()));
        assert_eq!(turn_between(&from, &to, Some(Vec3::Y)), turn_between(&from, &to, None));
    }
}
