//! Gathered hair beyond a tie as one rope.
//!
//! A rope has a middle line: the mean position and velocity of its guides at each distance beyond the tie. Guides
//! further from it than at rest are pulled back, and all of them take on its velocity, the more so the tighter
//! the tie is. The line is computed once per step, always in the same order, and moves on with its velocity in the
//! substeps. Guides within their bound are not moved.

use glam::Vec3;
use lovelock_groom::Rope;

use crate::block::{Block, InRope, NO_ROPE};
use crate::lanes::{LANES, Lane, Lane3, ZERO, at, choose, direction_or, greater, put};

/// Distance between two points of a middle line, metres.
const SPACING: f32 = 0.02;

/// The longest rope, in spacings: 20 m. Points beyond it are loose.
const LONGEST: f32 = 1000.0;

/// A guide is free up to this multiple of its distance from the line at rest, which counts as at least
/// [`Rope::least_radius`].
const FREE: f32 = 1.25;

/// Rate at which guides of a tight rope return into it, 1/s.
const COHESION: f32 = 60.0;

/// Rate at which guides of a tight rope take on its velocity, 1/s.
const FRICTION: f32 = 6.0;

/// Guides are pulled back at most this fast, metres per second.
const FASTEST: f32 = 2.0;

/// A point of a middle line with less has received nothing but rounding errors.
const LEAST_WEIGHT: f32 = 1e-3;

/// The constants of ropes by name, for other devices.
pub(crate) const CONSTANTS: [(&str, f64); 2] = [("ROPE_FREE", FREE as f64), ("ROPE_FASTEST", FASTEST as f64)];

/// A point of a middle line.
#[derive(Clone, Copy, Debug, Default)]
struct LinePoint {
    position: Vec3,
    velocity: Vec3,
    weight: f32,
}

/// The middle line of a rope.
#[derive(Clone, Debug, Default)]
pub(crate) struct MiddleLine {
    points: Vec<LinePoint>,
    /// Fraction of the distance beyond the bound that vanishes in a substep.
    cohesion: f32,
    /// Fraction of the velocity relative to the line that vanishes in a step.
    friction: f32,
    /// [`Rope::least_radius`].
    least_radius: f32,
}

impl MiddleLine {
    /// Position and velocity at a distance beyond the tie in units of [`SPACING`].
    #[inline(always)]
    fn at(&self, place: f32) -> (Vec3, Vec3) {
        let Some(last) = self.points.len().checked_sub(1) else { return (Vec3::NAN, Vec3::NAN) };
        let i = (place as usize).min(last);
        let (a, b) = (self.points[i], self.points[(i + 1).min(last)]);
        let t = place - i as f32;
        (a.position + (b.position - a.position) * t, a.velocity + (b.velocity - a.velocity) * t)
    }

    /// The number of points, and cohesion, friction and least radius.
    pub(crate) fn numbers(&self) -> (usize, [f32; 3]) {
        (self.points.len(), [self.cohesion, self.friction, self.least_radius])
    }

    /// Appends position and velocity of each point.
    pub(crate) fn write_points(&self, out: &mut Vec<f32>) {
        for point in &self.points {
            out.extend(point.position.to_array());
            out.extend(point.velocity.to_array());
        }
    }
}

/// Finds the guides of `ropes` in the blocks.
pub(crate) fn assign(ropes: &[Rope], blocks: &mut [Block]) {
    let mut of_guide = std::collections::HashMap::new();
    for (r, rope) in ropes.iter().enumerate() {
        let ahead = |n: usize| rope.ahead.get(n).copied().filter(|v| *v > 0.0).unwrap_or(0.0);
        let places = rope.guides.iter().enumerate();
        of_guide.extend(places.map(|(n, &(guide, beyond))| (guide, (r as u32, beyond as usize, ahead(n)))));
    }
    for block in blocks.iter_mut() {
        let mut found = InRope {
            rope: [NO_ROPE; LANES],
            place: vec![Lane::splat(-1.0); block.points()],
            radius: vec![ZERO; block.points()],
        };
        for k in 0..block.used {
            let Some(&(rope, beyond, ahead)) = of_guide.get(&block.guides[k]) else { continue };
            found.rope[k] = rope;
            let mut place = ahead / SPACING;
            for i in beyond.max(1)..block.points() {
                // The end of a guide that was cut.
                if block.rest.inv_length[i][k] <= 0.0 {
                    break;
                }
                if place > LONGEST {
                    break;
                }
                found.place[i][k] = place;
                place += block.rest.length.get(i + 1).map_or(0.0, |length| length[k]) / SPACING;
            }
        }
        let any = found.rope.iter().any(|rope| *rope != NO_ROPE);
        block.in_rope = any.then(|| Box::new(found));
    }
    measure(ropes, blocks);
}

/// Measures how far the guides are from the middle lines at rest.
pub(crate) fn measure(ropes: &[Rope], blocks: &mut [Block]) {
    let lines = lines(ropes, blocks, |block| (&block.rest.position, None));
    for block in blocks {
        let Some(mut found) = block.in_rope.take() else { continue };
        let InRope { rope, place, radius } = &mut *found;
        for (i, (place, radius)) in place.iter().zip(radius).enumerate() {
            for k in 0..LANES {
                if let Some(line) = lines.get(rope[k] as usize).filter(|_| place[k] >= 0.0) {
                    radius[k] = at(&block.rest.position[i], k).distance(line.at(place[k]).0);
                }
            }
        }
        block.in_rope = Some(found);
    }
}

/// The middle lines of the current hair, moved by `shift`, for `substeps` of `h` seconds. New ties have reached the share
/// `grown` of their strength.
pub(crate) fn current(
    ropes: &[Rope],
    blocks: &[Block],
    shift: Vec3,
    substeps: u32,
    h: f32,
    grown: f32,
) -> Vec<MiddleLine> {
    let mut lines = lines(ropes, blocks, |block| (&block.position, Some(&block.velocity)));
    for point in lines.iter_mut().flat_map(|line| &mut line.points) {
        point.position += shift;
    }
    for (line, rope) in lines.iter_mut().zip(ropes) {
        let taken = |rate: f32| 1.0 - (-rate * rope.tightness.clamp(0.0, 1.0) * grown * h).exp();
        (line.cohesion, line.friction) = (taken(COHESION), taken(FRICTION * substeps as f32));
        line.least_radius = rope.least_radius;
    }
    lines
}

/// The middle lines of positions and velocities. A point counts for the two points of the line next to it.
fn lines<'a>(
    ropes: &[Rope],
    blocks: &'a [Block],
    state: impl Fn(&'a Block) -> (&'a [Lane3], Option<&'a [Lane3]>),
) -> Vec<MiddleLine> {
    let mut lines: Vec<MiddleLine> = ropes.iter().map(|_| MiddleLine::default()).collect();
    for (block, found) in blocks.iter().filter_map(|block| Some((block, block.in_rope.as_deref()?))) {
        let (position, velocity) = state(block);
        for (i, place) in found.place.iter().enumerate() {
            for k in 0..block.used {
                let Some(line) = lines.get_mut(found.rope[k] as usize).filter(|_| place[k] >= 0.0) else {
                    continue;
                };
                let p = at(&position[i], k);
                let v = velocity.map_or(Vec3::ZERO, |rows| at(&rows[i], k));
                if !(p.is_finite() && v.is_finite()) {
                    continue;
                }
                let first = place[k] as usize;
                let t = place[k] - first as f32;
                if line.points.len() < first + 2 {
                    line.points.resize(first + 2, LinePoint::default());
                }
                for (point, weight) in line.points[first..].iter_mut().zip([1.0 - t, t]) {
                    point.position += p * weight;
                    point.velocity += v * weight;
                    point.weight += weight;
                }
            }
        }
    }
    for line in &mut lines {
        // The last point may have received nothing, and between the points of long links there may be gaps.
        while line.points.pop_if(|point| point.weight < LEAST_WEIGHT).is_some() {}
        let mut last: Option<usize> = None;
        for n in 0..line.points.len() {
            let LinePoint { position, velocity, weight } = line.points[n];
            if weight < LEAST_WEIGHT {
                continue;
            }
            let here = LinePoint { position: position / weight, velocity: velocity / weight, weight };
            line.points[n] = here;
            let before = last.map_or((n, here), |m| (n - m, line.points[m]));
            for gap in last.map_or(0, |m| m + 1)..n {
                let t = (n - gap) as f32 / before.0 as f32;
                line.points[gap] = LinePoint {
                    position: here.position.lerp(before.1.position, t),
                    velocity: here.velocity.lerp(before.1.velocity, t),
                    weight: LEAST_WEIGHT,
                };
            }
            last = Some(n);
        }
    }
    lines
}

/// Pulls the points `next` of a block into their ropes; `passed` seconds have passed since the lines were
/// computed, and a substep has `h`.
#[inline(always)]
pub(crate) fn hold(
    found: &InRope,
    lines: &[MiddleLine],
    first_free: usize,
    passed: f32,
    h: f32,
    next: &mut [Lane3],
) {
    for (i, row) in next.iter_mut().enumerate().skip(first_free) {
        for k in 0..LANES {
            let place = found.place[i][k];
            let Some(line) = lines.get(found.rope[k] as usize).filter(|_| place >= 0.0) else { continue };
            let (middle, velocity) = line.at(place);
            let p = at(row, k);
            let (out, distance) = direction_or(p - (middle + velocity * passed), Vec3::ZERO);
            let bound = FREE * greater(found.radius[i][k], line.least_radius);
            let back = greater((bound - distance) * line.cohesion, -FASTEST * h);
            // False for NaN.
            put(row, k, choose(distance > bound, p + out * back, p));
        }
    }
}

/// Adds to `push`, the change of velocity per substep, what lets the points of row `i` with the velocities `v` take on
/// those of their ropes over a step of `substeps`.
#[inline(always)]
pub(crate) fn rub(
    found: &InRope,
    lines: &[MiddleLine],
    i: usize,
    substeps: f32,
    v: &Lane3,
    push: &mut Lane3,
) {
    for k in 0..LANES {
        let place = found.place[i][k];
        let Some(line) = lines.get(found.rope[k] as usize).filter(|_| place >= 0.0) else { continue };
        let relative = line.at(place).1 - at(v, k);
        let pushed = at(push, k) + relative * (line.friction / substeps);
        // False for NaN.
        put(push, k, choose(relative.length_squared() < 1e6, pushed, at(push, k)));
    }
}

#[cfg(test)]
mod tests {
    use lovelock_groom::Guides;

    use super::*;
    use crate::packing::pack;

    /// Two guides of `links` links of `link` metres along X, 2 cm apart, tied at their roots.
    fn block(links: usize, link: f32) -> (Vec<Rope>, Vec<Block>) {
        let mut guides = Guides { points_per_guide: links + 1, ..Guides::default() };
        for z in [-0.01, 0.01] {
            let points: Vec<Vec3> = (0..=links).map(|i| Vec3::new(link * i as f32, 0.0, z)).collect();
            guides.push(&points);
        }
        let ropes = vec![Rope { guides: vec![(0, 1), (1, 1)], tightness: 1.0, ..Rope::default() }];
        let mut blocks: Vec<Block> =
            pack(&guides, &[]).iter().map(|lanes| Block::new(&guides, lanes, 1)).collect();
        for block in &mut blocks {
            block.place_at_rest(&crate::lanes::Map::IDENTITY);
        }
        assign(&ropes, &mut blocks);
        (ropes, blocks)
    }

    #[test]
    fn the_middle_line_lies_between_the_guides_also_where_links_are_long() {
        // Links shorter and longer than the spacing of the line; the last ones leave gaps in it.
        for link in [0.007, 0.02, 0.05, 0.13] {
            let (ropes, blocks) = block(8, link);
            let lines = current(&ropes, &blocks, Vec3::Y, 4, 1.0 / 240.0, 1.0);
            let found = blocks[0].in_rope.as_deref().expect("a rope");
            for i in 1..=8 {
                let (p, v) = lines[0].at(found.place[i][0]);
                let off = p - Vec3::new(link * i as f32, 1.0, 0.0);
                // Means over two spacings lie up to half a spacing further inward along the line at its ends.
                let aside = off.y.abs() + off.z.abs();
                assert!(
                    aside < 1e-5 && off.x.abs() < 0.6 * SPACING && v == Vec3::ZERO,
                    "{link}, point {i}: {off}"
                );
                let radius = found.radius[i][1];
                assert!(
                    (radius.powi(2) - 0.01_f32.powi(2) - off.x.powi(2)).abs() < 1e-6,
                    "{link}, point {i}: {radius}"
                );
            }
            assert!(found.place[0][0] < 0.0, "the root is before the tie");
        }
    }

    #[test]
    fn a_guide_that_left_its_rope_returns_and_the_middle_stays() {
        let (ropes, mut blocks) = block(8, 0.02);
        for i in 1..9 {
            put(&mut blocks[0].position[i], 0, Vec3::new(0.02 * i as f32, 0.0, -0.05));
            put(&mut blocks[0].position[i], 1, Vec3::new(0.02 * i as f32, 0.0, 0.05));
        }
        let h = 1.0 / 240.0;
        let lines = current(&ropes, &blocks, Vec3::ZERO, 4, h, 1.0);
        let found = blocks[0].in_rope.clone().expect("a rope");
        let mut next = blocks[0].position.clone();
        hold(&found, &lines, 1, 0.0, h, &mut next);
        let [a, b] = [at(&next[5], 0), at(&next[5], 1)];
        assert!((a + b).z.abs() < 1e-6, "the middle stays");
        // 37.5 mm beyond the bound, by e^(-60 h) but at most 2 m/s.
        let want = (0.05 - 0.0125) * (1.0 - (-60.0 * h).exp());
        assert!((0.05 - b.z - want.min(2.0 * h)).abs() < 1e-5, "{}", 0.05 - b.z);
        let loose = current(&[Rope { tightness: 0.0, ..ropes[0].clone() }], &blocks, Vec3::ZERO, 4, h, 1.0);
        let mut next = blocks[0].position.clone();
        hold(&found, &loose, 1, 0.0, h, &mut next);
        assert_eq!(next, blocks[0].position, "control: a loose tie pulls nothing");
    }
}
