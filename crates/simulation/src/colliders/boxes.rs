//! Bounding boxes of colliders in lanes, so that a row of points is tested against several at once.

use glam::Vec3;

use super::MovingShape;
use crate::lanes::{LANES, Lane, Lane3, at, fold, greater, lesser, splat3};

/// The boxes of some colliders, in order.
#[derive(Clone, Debug, Default)]
pub(crate) struct Boxes {
    count: usize,
    /// Lowest and highest corners of as many boxes as there are lanes; unused lanes are infinitely far away.
    groups: Vec<(Lane3, Lane3)>,
}

impl Boxes {
    #[cfg(test)]
    pub(crate) fn of(movers: &[MovingShape]) -> Self {
        let mut boxes = Self::default();
        for mover in movers {
            boxes.push(mover);
        }
        boxes
    }

    pub(crate) fn clear(&mut self) {
        self.count = 0;
        self.groups.clear();
    }

    /// Adds the box of `mover`.
    #[inline(always)]
    pub(crate) fn push(&mut self, mover: &MovingShape) {
        let k = self.count % LANES;
        if k == 0 {
            self.groups.push((splat3(Vec3::splat(f32::MAX)), splat3(Vec3::splat(f32::MIN))));
        }
        if let Some((low, high)) = self.groups.last_mut() {
            crate::lanes::put(low, k, mover.min);
            crate::lanes::put(high, k, mover.max);
        }
        self.count += 1;
    }

    /// The indices of the boxes within `reach` of the box from `min` to `max`, in order.
    #[inline(always)]
    pub(crate) fn near(&self, min: Vec3, max: Vec3, reach: f32) -> NearBoxes<'_> {
        NearBoxes { groups: &self.groups, next: 0, bits: 0, min, max, reach }
    }
}

/// See [`Boxes::near`].
pub(crate) struct NearBoxes<'a> {
    groups: &'a [(Lane3, Lane3)],
    /// The next group, and the remaining hits of the previous one, one bit each.
    next: usize,
    bits: u32,
    min: Vec3,
    max: Vec3,
    reach: f32,
}

impl NearBoxes<'_> {
    #[inline(always)]
    fn bits_of(&self, (low, high): &(Lane3, Lane3)) -> u32 {
        let mut far = Lane::splat(0.0);
        for k in 0..LANES {
            let (a, b) = (at(low, k), at(high, k));
            let beyond = greater(greater(a.x - self.max.x, a.y - self.max.y), a.z - self.max.z);
            let before = greater(greater(self.min.x - b.x, self.min.y - b.y), self.min.z - b.z);
            far[k] = greater(beyond, before);
        }
        let mut bits = 0;
        for k in 0..LANES {
            bits |= u32::from(far[k] <= self.reach) << k;
        }
        bits
    }
}

impl Iterator for NearBoxes<'_> {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        while self.bits == 0 {
            self.bits = self.bits_of(self.groups.get(self.next)?);
            self.next += 1;
        }
        let k = self.bits.trailing_zeros() as usize;
        self.bits &= self.bits - 1;
        Some((self.next - 1) * LANES + k)
    }
}

/// The bounding box of a row of points.
#[inline(always)]
pub(crate) fn bounds(row: &Lane3) -> (Vec3, Vec3) {
    let (mut min, mut max) = (Vec3::ZERO, Vec3::ZERO);
    for axis in 0..3 {
        (min[axis], max[axis]) = (fold(row[axis], lesser), fold(row[axis], greater));
    }
    (min, max)
}

/// Whether a box is further than `reach` from a collider's box.
#[inline(always)]
pub(crate) fn apart(min: Vec3, max: Vec3, mover: &MovingShape, reach: f32) -> bool {
    let (a, b) = (mover.min, mover.max);
    min.x > b.x + reach
        || min.y > b.y + reach
        || min.z > b.z + reach
        || max.x < a.x - reach
        || max.y < a.y - reach
        || max.z < a.z - reach
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::Map;

    #[test]
    fn boxes_in_lanes_are_found_as_one_by_one() {
        let mover = |n: u32| {
            let min = Vec3::new((n * 7 % 11) as f32, (n * 5 % 13) as f32, (n * 3 % 7) as f32);
            MovingShape {
                shape: None,
                min,
                max: min + 0.6,
                velocity_at: Map { turn: glam::Mat3::ZERO, shift: Vec3::ZERO },
                on_head: false,
            }
        };
        let movers: Vec<_> = (0..37).map(mover).collect();
        let boxes = Boxes::of(&movers);
        let (mut found, mut missed) = (0, 0);
        for n in 0..60_u32 {
            let min = Vec3::new((n % 12) as f32 + 0.3, (n * 3 % 14) as f32, (n * 7 % 8) as f32 + 0.1);
            let max = min + 0.5;
            let all: Vec<usize> = boxes.near(min, max, 0.9).collect();
            let want: Vec<usize> = (0..movers.len()).filter(|&i| !apart(min, max, &movers[i], 0.9)).collect();
            assert_eq!(all, want);
            (found, missed) = (found + want.len(), missed + movers.len() - want.len());
        }
        assert!(found > 20 && missed > 20, "{found} found and {missed} not: the case is too easy");
        // NaN is near nothing.
        assert_eq!(boxes.near(Vec3::NAN, Vec3::NAN, 1.0).count(), 0);
    }
}
