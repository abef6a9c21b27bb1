//! Rows of points against the skin that goes with the head, where a point is at rest wherever it is now: most of the points
//! of a hairstyle that touch anything touch this, so that they are measured side by side.

use glam::Vec3;
use lovelock_motion::FieldLattice;

use super::MovingField;
use super::planes::NONE;
use crate::lanes::{LANES, Lane, Lane3, ZERO, ZERO3, at, greater, inv_sqrt, lesser, put};
use crate::trilinear::{gradient, weights};

/// What a row of points learns of the skin that goes with the head.
pub(super) struct Heads {
    /// Whether the head alone moves the skin there; where it does not, the rest says nothing.
    pub(super) alone: [bool; LANES],
    /// Distance, metres; [`NONE`] where it is too far to be of interest.
    pub(super) distance: Lane,
    pub(super) normal: Lane3,
    /// How far the skin is at least, metres; [`NONE`] where the field ends.
    pub(super) nearest: Lane,
}

impl MovingField {
    /// Measures the lanes of a row in head space that `asked` names; nothing further than `reach` is of interest.
    #[inline(always)]
    pub(super) fn heads(&self, row: &Lane3, asked: &[bool; LANES], reach: f32) -> Heads {
        let mut out =
            Heads { alone: [false; LANES], distance: ZERO, normal: ZERO3, nearest: Lane::splat(NONE) };
        let nodes = Places::new(self.field.node_lattice(), self.inv_node, row);
        for k in 0..LANES {
            // A place that is not inside has no node.
            out.alone[k] = asked[k] && self.head_alone.get(nodes.first[k] as usize).is_some_and(|&own| own);
        }
        let lattice = self.field.distance_lattice();
        let places = Places::new(lattice, self.inv_spacing, row);
        let (all, mut corners) = (self.field.distances(), [ZERO; 8]);
        let (up, behind) = (lattice.size.x as usize, (lattice.size.x * lattice.size.y) as usize);
        let mut there = [false; LANES];
        for k in 0..LANES {
            let first = places.first[k] as usize;
            if !out.alone[k] || first >= all.len() {
                continue;
            }
            there[k] = true;
            for (n, offset) in [0, up, behind, behind + up].into_iter().enumerate() {
                let pair = &all[first + offset..first + offset + 2];
                (corners[2 * n][k], corners[2 * n + 1][k]) = (pair[0], pair[1]);
            }
        }
        for k in 0..LANES {
            let (d, f) = (std::array::from_fn(|n| corners[n][k]), at(&places.fraction, k));
            let mut value = 0.0;
            for (d, weight) in d.iter().zip(weights(f)) {
                value += d * weight;
            }
            let slope = gradient(&d, f) * self.inv_spacing;
            let squared = slope.length_squared();
            let inv = inv_sqrt(squared);
            let steepness = squared * inv;
            let distance = value / lesser(greater(steepness, 0.5), 2.0) - self.lift;
            let flat = steepness <= 1e-6;
            let pick = |a: f32, b: f32| if flat { a } else { b * inv };
            put(&mut out.normal, k, Vec3::new(pick(0.0, slope.x), pick(1.0, slope.y), pick(0.0, slope.z)));
            let far = value - self.lift > 2.0 * reach;
            let at_least = if far { 0.5 * value - self.lift } else { distance };
            out.distance[k] = if far | !there[k] { NONE } else { distance };
            out.nearest[k] = if there[k] { at_least } else { NONE };
        }
        out
    }
}

/// Where the points of a row are between the points of a lattice.
struct Places {
    /// The first of the eight around each; [`u32::MAX`] where the lattice ends.
    first: [u32; LANES],
    fraction: Lane3,
}

impl Places {
    #[inline(always)]
    fn new(lattice: &FieldLattice, inv_spacing: f32, row: &Lane3) -> Self {
        let mut out = Self { first: [u32::MAX; LANES], fraction: ZERO3 };
        let (size, last) = (lattice.size, (lattice.size - 1).as_vec3());
        for k in 0..LANES {
            let q = (at(row, k) - lattice.low) * inv_spacing;
            // Written so that what is not a number is outside.
            let within = |q: f32, last: f32| (q >= 0.0) & (q < last);
            let inside = within(q.x, last.x) & within(q.y, last.y) & within(q.z, last.z);
            let whole = |q: f32| if inside { q } else { 0.0 } as u32;
            let (x, y, z) = (whole(q.x), whole(q.y), whole(q.z));
            let first = (z * size.y + y) * size.x + x;
            out.first[k] = if inside { first } else { u32::MAX };
            put(&mut out.fraction, k, q - Vec3::new(x as f32, y as f32, z as f32));
        }
        out
    }
}
