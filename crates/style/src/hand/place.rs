//! Places on the scalp, and the frames along a guide in which edits are stored.

use std::collections::{BTreeMap, HashMap};

use glam::{Quat, Vec2, Vec3};
use lovelock_groom::Hairstyle;

use crate::HeadBox;

/// The direction that a frame carries to that of its link. It points to the upper back of the head: the frames of roots have their only
/// jump at the opposite direction, below the chin.
const BASE: Vec3 = Vec3::new(0.0, 0.8, -0.6);
/// Two axes square to [`BASE`]. The first is the mirrored one.
const ACROSS: [Vec3; 2] = [Vec3::X, Vec3::new(0.0, -0.6, -0.8)];
/// Steps of a stored direction.
const STEPS: f32 = 32_000.0;
/// Two places nearer than this are the same.
const SAME: f32 = 1.5e-4;
/// Roots whose neighbours are searched to find the distance between roots.
const MAX_PROBES: usize = 256;
/// The range of distances between roots.
const REACH: [f32; 2] = [0.01, 0.5];

/// A place of the scalp: the direction from the middle of the head's box, and which of the guides there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct HandPlace {
    /// The direction in steps of 1/32000.
    pub(super) steps: [i16; 3],
    /// The number of guides with the same root before this one.
    pub(super) twin: u8,
}

impl HandPlace {
    /// The direction; a unit vector up to rounding.
    pub fn direction(self) -> Vec3 {
        Vec3::from_array(self.steps.map(|step| f32::from(step) / STEPS))
    }

    /// The place on the other side of the head.
    #[must_use]
    pub fn mirrored(self) -> Self {
        let [x, y, z] = self.steps;
        Self { steps: [x.saturating_neg(), y, z], ..self }
    }

    /// Whether both are the same place up to rounding.
    pub(super) fn is_at(self, other: Self) -> bool {
        self.twin == other.twin && self.direction().distance_squared(other.direction()) < SAME * SAME
    }
}

/// The places of the roots of all guides of a hairstyle.
#[derive(Clone, Debug, Default)]
pub struct HandRoots {
    /// The direction of each root from the middle of the head's box, a unit vector.
    pub directions: Vec<Vec3>,
    /// The same as places.
    pub places: Vec<HandPlace>,
    /// Mean distance between neighbouring roots, as a difference of directions.
    pub spacing: f32,
}

impl HandRoots {
    /// The roots of a hairstyle.
    pub fn of(style: &Hairstyle) -> Self {
        let head = HeadBox::of(&style.scalp);
        let direction = |guide| head.relative(style.guides.point(guide, 0)).normalize_or(Vec3::Y);
        let directions: Vec<Vec3> = (0..style.guides.count()).map(direction).collect();
        let mut twins = BTreeMap::<[i16; 3], u8>::new();
        let mut place = |direction: &Vec3| {
            let steps = direction.to_array().map(|v| (v * STEPS).round() as i16);
            let next = twins.entry(steps).or_default();
            let twin = *next;
            *next = next.saturating_add(1);
            HandPlace { steps, twin }
        };
        let places = directions.iter().map(&mut place).collect();
        Self { spacing: spacing(&directions), directions, places }
    }
}

/// The mean distance to the third nearest other place.
fn spacing(directions: &[Vec3]) -> f32 {
    let step = directions.len().div_ceil(MAX_PROBES).max(1);
    let (mut sum, mut count) = (0.0, 0.0);
    for probe in directions.iter().step_by(step) {
        let mut nearest = [f32::INFINITY; 3];
        for other in directions {
            let distance = probe.distance(*other);
            if distance > SAME && distance < nearest[2] {
                nearest[2] = distance;
                nearest.sort_unstable_by(f32::total_cmp);
            }
        }
        if nearest[2].is_finite() {
            sum += nearest[2];
            count += 1.0;
        }
    }
    if count > 0.0 { (sum / count).clamp(REACH[0], REACH[1]) } else { 0.5 * REACH[1] }
}

/// Finds places near a direction.
pub(super) struct PlaceIndex {
    cell: f32,
    cells: HashMap<[i32; 3], Vec<u32>>,
}

impl PlaceIndex {
    /// An index of directions for searches up to `reach`.
    pub fn new(directions: impl Iterator<Item = Vec3>, reach: f32) -> Self {
        let cell = reach.clamp(REACH[0], 2.0 * REACH[1]);
        let mut cells = HashMap::<[i32; 3], Vec<u32>>::new();
        for (i, direction) in directions.enumerate() {
            cells.entry(cell_of(direction, cell)).or_default().push(i as u32);
        }
        Self { cell, cells }
    }

    /// The places in the cells around a direction: all that are within the reach, and some others.
    pub fn around(&self, direction: Vec3) -> impl Iterator<Item = usize> {
        let [x, y, z] = cell_of(direction, self.cell);
        let cells = (0..27).map(move |i| [x + i % 3 - 1, y + i / 3 % 3 - 1, z + i / 9 - 1]);
        cells.filter_map(|cell| self.cells.get(&cell)).flatten().map(|i| *i as usize)
    }
}

fn cell_of(direction: Vec3, cell: f32) -> [i32; 3] {
    (direction / cell).to_array().map(|v| v.floor() as i32)
}

/// The frame of each link of a guide: a rotation that carries a constant direction to that of the link. The frame of the first link is
/// carried from that of the place `outward` by the smallest rotation, and the others from link to link.
pub fn link_frames(points: &[Vec3], outward: Vec3) -> Vec<Quat> {
    let mut frame = smallest_turn(BASE, outward);
    let mut before = outward;
    let mut out = Vec::with_capacity(points.len().saturating_sub(1));
    for pair in points.windows(2) {
        let along = (pair[1] - pair[0]).normalize_or(before);
        frame = (smallest_turn(before, along) * frame).normalize();
        before = along;
        out.push(frame);
    }
    out
}

/// The smallest rotation from one unit vector to another, exact also for small angles.
pub fn smallest_turn(from: Vec3, to: Vec3) -> Quat {
    let real = 1.0 + from.dot(to);
    if real < 1e-6 {
        return Quat::from_axis_angle(from.any_orthonormal_vector(), std::f32::consts::PI);
    }
    let axis = from.cross(to);
    Quat::from_xyzw(axis.x, axis.y, axis.z, real).normalize()
}

/// How a link is turned: the direction `turned` seen in the frame of the link. The length is the angle; 0 is not turned.
pub fn turn_to(frame: Quat, turned: Vec3) -> Vec2 {
    turn_of(frame.inverse() * turned)
}

/// The direction of a link that is turned in its frame.
pub fn turned_by(frame: Quat, turn: Vec2) -> Vec3 {
    frame * direction_of(turn)
}

/// The turn from the constant direction to another.
pub(super) fn turn_of(direction: Vec3) -> Vec2 {
    let cos = direction.dot(BASE);
    let across = direction - BASE * cos;
    let sin = across.length();
    let angle = sin.atan2(cos);
    if sin < 1e-9 {
        return Vec2::new(angle, 0.0);
    }
    Vec2::new(across.dot(ACROSS[0]), across.dot(ACROSS[1])) * (angle / sin)
}

/// The direction to which a turn brings the constant direction.
pub(super) fn direction_of(turn: Vec2) -> Vec3 {
    let angle = turn.length();
    if angle < 1e-9 {
        return BASE;
    }
    BASE * angle.cos() + (ACROSS[0] * turn.x + ACROSS[1] * turn.y) * (angle.sin() / angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOME: [Vec3; 5] =
        [Vec3::X, Vec3::Y, Vec3::NEG_Z, Vec3::new(0.48, -0.6, 0.64), Vec3::new(-0.6, 0.0, 0.8)];

    #[test]
    fn a_turn_brings_a_link_to_its_direction() {
        for outward in SOME {
            for along in SOME {
                let frames = link_frames(&[Vec3::ZERO, outward, outward + 0.3 * along], outward);
                assert!((frames[1] * BASE).distance(along) < 1e-6);
                for turned in SOME {
                    let turn = turn_to(frames[1], turned);
                    assert!(turned_by(frames[1], turn).distance(turned) < 2e-6, "{outward} {along} {turned}");
                }
            }
        }
    }

    #[test]
    fn the_turn_of_a_mirrored_link_is_mirrored() {
        let mirror = |v: Vec3| Vec3::new(-v.x, v.y, v.z);
        let points = [Vec3::ZERO, SOME[3], SOME[3] + SOME[4], SOME[4] + SOME[1]];
        let [own, other] = [link_frames(&points, SOME[3]), link_frames(&points.map(mirror), mirror(SOME[3]))];
        for (own, other) in own.into_iter().zip(other) {
            let (own, other) = (turn_to(own, SOME[0]), turn_to(other, mirror(SOME[0])));
            assert!((own * Vec2::new(-1.0, 1.0)).distance(other) < 1e-5, "{own} {other}");
        }
    }
}
